//! The receiver with camera pulses, and a PC that reads its port.

use std::cell::RefCell;
use std::time::Duration;

use shisei_board::Clock;
use shisei_board::receiver::Radio;
use shisei_device::receiver::Receiver;
use shisei_hub::{Item, Session};

use crate::controllers::{Controller, ReportAnchors};
use crate::{CAMERA_HZ, DeviceClock, arbitrary};

/// What a PC read.
#[derive(Debug, Default)]
pub struct Recorded {
    /// What it means.
    pub items: Vec<Item>,
    /// The bytes.
    pub bytes: Vec<u8>,
    /// Frames that could not be read.
    pub garbage: u64,
}

/// Runs a receiver and reads its port until a true time, s. `say` is asked for bytes to the receiver, with what was
/// read so far.
pub async fn listen(
    controller: Controller,
    clock: DeviceClock,
    until_s: f64,
    mut say: impl FnMut(f64, &[Item]) -> Vec<u8>,
) -> Recorded {
    let receiver = RefCell::new(Receiver::<8192>::new(arbitrary() as u16, clock.now_us()));
    let radio = Radio::new(&receiver, clock);
    let (mut session, mut recorded) = (Session::default(), Recorded::default());
    let pc = async {
        let mut pulse = (clock.now_s() * CAMERA_HZ) as u32 + 1;
        while clock.now_s() < until_s {
            while f64::from(pulse) / CAMERA_HZ <= clock.now_s() {
                let time_us = clock.at_us(f64::from(pulse) / CAMERA_HZ) as u64;
                // Hardware has counted it: one more than its number.
                receiver.borrow_mut().pulse(time_us, pulse + 1);
                pulse += 1;
            }
            receiver.borrow_mut().tick(clock.now_us());
            for byte in say(clock.now_s(), &recorded.items) {
                let command = receiver.borrow_mut().byte(byte, clock.now_us());
                if let Some(command) = command {
                    assert!(radio.send(&command), "a command finds no room");
                }
            }
            let mut bytes = vec![0; receiver.borrow().outbox.len()];
            receiver.borrow_mut().outbox.take(&mut bytes);
            session.push(&bytes, &mut recorded.items);
            recorded.bytes.extend_from_slice(&bytes);
            tokio::time::sleep(Duration::from_millis(2)).await;
        }
    };
    let address = [0x99, 0, 0, 0, 0xee, 0xff];
    let talking = shisei_board::receiver::run(controller, address, ReportAnchors::new(true), &radio);
    tokio::select! {
        () = pc => {}
        ended = talking => panic!("the receiver's radio stopped: {ended:?}"),
    }
    session.finish(&mut recorded.items);
    recorded.garbage = session.counts().garbage;
    recorded
}
