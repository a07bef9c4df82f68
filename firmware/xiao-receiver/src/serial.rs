//! The USB port: frames out, commands in.

use core::cell::RefCell;
use core::future::Future;

use embassy_futures::join::join;
use embassy_nrf::Peri;
use embassy_nrf::interrupt::typelevel::{Binding, CLOCK_POWER, USBD as Interrupt};
use embassy_nrf::peripherals::USBD;
use embassy_nrf::usb::vbus_detect::{self, HardwareVbusDetect};
use embassy_nrf::usb::{Driver, InterruptHandler};
use embassy_time::Timer;
use embassy_usb::Builder;
use embassy_usb::class::cdc_acm::{CdcAcmClass, State};
use shisei_board::Clock;
use shisei_board::receiver::Radio;
use shisei_device::receiver::Receiver;
use shisei_xiao::BoardClock;
use static_cell::StaticCell;

/// Bytes of a USB packet.
const PACKET: usize = 64;
/// From one look at what waits to the next, ms.
const LOOK_MS: u64 = 2;
/// pid.codes' identifiers for tests; a product of its own needs its own.
const VENDOR_PRODUCT: (u16, u16) = (0x1209, 0x0001);

/// The serial line.
pub type Line = CdcAcmClass<'static, Driver<'static, HardwareVbusDetect>>;

/// Opens the port: what keeps it going, and its line. To be called once.
pub fn open(
    usbd: Peri<'static, USBD>,
    interrupts: impl Binding<Interrupt, InterruptHandler<USBD>>
    + Binding<CLOCK_POWER, vbus_detect::InterruptHandler>
    + Copy
    + 'static,
) -> (impl Future<Output = ()>, Line) {
    let driver = Driver::new(usbd, interrupts, HardwareVbusDetect::new(interrupts));
    let mut config = embassy_usb::Config::new(VENDOR_PRODUCT.0, VENDOR_PRODUCT.1);
    config.manufacturer = Some("shisei");
    config.product = Some("shisei receiver");
    config.max_packet_size_0 = PACKET as u8;
    static CONFIGURATION: StaticCell<[u8; 256]> = StaticCell::new();
    static BOS: StaticCell<[u8; 256]> = StaticCell::new();
    static CONTROL: StaticCell<[u8; 64]> = StaticCell::new();
    static STATE: StaticCell<State> = StaticCell::new();
    let (configuration, bos) = (CONFIGURATION.init([0; 256]), BOS.init([0; 256]));
    let mut builder = Builder::new(driver, config, configuration, bos, &mut [], CONTROL.init([0; 64]));
    let line = CdcAcmClass::new(&mut builder, STATE.init(State::new()), PACKET as u16);
    let mut device = builder.build();
    let keep = async move {
        device.run().await;
    };
    (keep, line)
}

/// Passes frames to the PC and commands from it. Never ends.
pub async fn run<const OUT: usize>(
    line: Line,
    clock: &BoardClock,
    receiver: &RefCell<Receiver<OUT>>,
    radio: &Radio<'_, &BoardClock, OUT>,
) {
    let (mut sender, mut reader) = line.split();
    let tick = async {
        loop {
            receiver.borrow_mut().tick(clock.now_us());
            Timer::after_millis(LOOK_MS).await;
        }
    };
    let send = async {
        loop {
            sender.wait_connection().await;
            // What waited is of before; frames leave whole or not at all.
            while receiver.borrow_mut().outbox.take(&mut [0; PACKET]) > 0 {}
            loop {
                let mut packet = [0; PACKET];
                let count = receiver.borrow_mut().outbox.take(&mut packet);
                let waiting = packet.get(..count).unwrap_or_default();
                let sent = if waiting.is_empty() {
                    Timer::after_millis(LOOK_MS).await;
                    Ok(())
                } else {
                    sender.write_packet(waiting).await
                };
                // A full packet with nothing after it: an empty one ends the transfer.
                let full = count == PACKET && receiver.borrow().outbox.is_empty();
                if sent.is_err() || (full && sender.write_packet(&[]).await.is_err()) {
                    break;
                }
            }
        }
    };
    let read = async {
        loop {
            reader.wait_connection().await;
            let mut packet = [0; PACKET];
            while let Ok(count) = reader.read_packet(&mut packet).await {
                for byte in packet.iter().take(count) {
                    let command = receiver.borrow_mut().byte(*byte, clock.now_us());
                    if let Some(command) = command {
                        radio.send(&command);
                    }
                }
            }
        }
    };
    join(tick, join(send, read)).await;
}
