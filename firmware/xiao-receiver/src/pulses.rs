//! Sync pulses and the recording gate.

use core::cell::RefCell;

use embassy_futures::select::{Either, select};
use embassy_nrf::gpiote::InputChannel;
use embassy_nrf::pac;
use embassy_nrf::timer::Timer as HardwareTimer;
use embedded_hal::digital::InputPin;
use shisei_board::Clock;
use shisei_device::receiver::Receiver;
use shisei_xiao::{BoardClock, CC_EDGE};

/// TIMER4's register that its count is captured into.
const CC_COUNT: usize = 0;

/// Pulses so far, by hardware.
fn counted(_: &HardwareTimer<'static>) -> u32 {
    pac::TIMER4.tasks_capture(CC_COUNT).write_value(1);
    pac::TIMER4.cc(CC_COUNT).read()
}

fn is_up(gate: &mut InputChannel<'static>) -> bool {
    let Ok(up) = gate.is_high();
    up
}

/// Tells the receiver every pulse and every edge of the gate. Never ends.
pub async fn watch<const OUT: usize>(
    mut sync: InputChannel<'static>,
    mut gate: InputChannel<'static>,
    counter: &HardwareTimer<'static>,
    clock: &BoardClock,
    receiver: &RefCell<Receiver<OUT>>,
) {
    let mut told = counted(counter);
    if is_up(&mut gate) {
        receiver.borrow_mut().gate(true, clock.now_us(), told);
    }
    loop {
        match select(sync.wait(), gate.wait()).await {
            Either::First(()) => {
                // Count and time belong together where no pulse came between.
                let (count, time_us) = loop {
                    let count = counted(counter);
                    let time_us = clock.unwrap_us(pac::TIMER3.cc(CC_EDGE).read());
                    if counted(counter) == count {
                        break (count, time_us);
                    }
                };
                // A second edge that was told with the first.
                if count != told {
                    told = count;
                    receiver.borrow_mut().pulse(time_us, count);
                }
            }
            Either::Second(()) => {
                let (up, count) = (is_up(&mut gate), counted(counter));
                receiver.borrow_mut().gate(up, clock.now_us(), count);
            }
        }
    }
}
