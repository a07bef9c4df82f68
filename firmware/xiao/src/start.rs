//! The start that node and receiver share: the radio's layer, random numbers, what happens on a fault.

use embassy_executor::Spawner;
use embassy_nrf::mode::Async;
use embassy_nrf::rng::Rng;
use nrf_mpsl::MultiprotocolServiceLayer;
use static_cell::StaticCell;

/// A fault starts the board anew; its new boot id tells.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    cortex_m::peripheral::SCB::sys_reset()
}

#[embassy_executor::task]
async fn run_mpsl(mpsl: &'static MultiprotocolServiceLayer<'static>) -> ! {
    mpsl.run().await
}

/// Runs Nordic's layer for good, and holds the crystal for good. To be called once.
pub async fn radio_layer(
    spawner: Spawner,
    layer: Result<MultiprotocolServiceLayer<'static>, nrf_mpsl::Error>,
) -> &'static MultiprotocolServiceLayer<'static> {
    static LAYER: StaticCell<MultiprotocolServiceLayer<'static>> = StaticCell::new();
    let layer: &'static _ = LAYER.init(layer.expect("MPSL starts with these fixed settings"));
    spawner.spawn(run_mpsl(layer).expect("it is spawned once"));
    core::mem::forget(layer.request_hfclk().await.expect("the board has its crystal"));
    layer
}

/// The generator for good, and a first number of it: the boot id. To be called once.
pub async fn boot_id(generator: Rng<'static, Async>) -> (&'static mut Rng<'static, Async>, u16) {
    static GENERATOR: StaticCell<Rng<'static, Async>> = StaticCell::new();
    let generator = GENERATOR.init(generator);
    let mut boot = [0; 2];
    generator.fill_bytes(&mut boot).await;
    (generator, u16::from_le_bytes(boot))
}

/// What Nordic's layer takes of the chip: moves it out of the peripherals.
#[macro_export]
macro_rules! layer_parts {
    ($p:ident) => {
        ::nrf_mpsl::Peripherals::new($p.RTC0, $p.TIMER0, $p.TEMP, $p.PPI_CH19, $p.PPI_CH30, $p.PPI_CH31)
    };
}

/// What Nordic's controller takes of the chip: moves it out of the peripherals.
#[macro_export]
macro_rules! controller_parts {
    ($p:ident) => {
        ::nrf_sdc::Peripherals::new(
            $p.PPI_CH17,
            $p.PPI_CH18,
            $p.PPI_CH20,
            $p.PPI_CH21,
            $p.PPI_CH22,
            $p.PPI_CH23,
            $p.PPI_CH24,
            $p.PPI_CH25,
            $p.PPI_CH26,
            $p.PPI_CH27,
            $p.PPI_CH28,
            $p.PPI_CH29,
        )
    };
}
