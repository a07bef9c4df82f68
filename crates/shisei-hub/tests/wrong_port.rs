//! Serial ports on which something else than a receiver talks.

use std::sync::Arc;
use std::time::{Duration, Instant};

use shisei_hub::live::input::{Arrival, ToHub};
use shisei_hub::live::{Board, Hub, Kind, Settings, What};

/// Bytes of a port, one lot a second; what is told of them.
fn told(lot: impl Fn(usize) -> Vec<u8>) -> Vec<shisei_hub::live::Note> {
    let board = Arc::new(Board::new("{}"));
    let mut hub =
        Hub::new(Settings::default(), vec![("/dev/ttyUSB0".into(), Kind::Serial)], Vec::new(), board);
    let begun = Instant::now();
    for second in 0..10 {
        let at = begun + Duration::from_secs(second as u64);
        let what = What::Serial(lot(second));
        hub.push(ToHub::Arrival(Arrival { input: 0, port: "ttyUSB0".into(), at, unix_ns: 0, what }));
    }
    std::iter::from_fn(|| hub.told()).collect()
}

#[test]
fn what_is_no_receiver_is_said_once() {
    for lot in [b"$GPGGA,123519,4807.038,N\r\n".to_vec(), vec![0xA5, 0, 7, 0, 0, 9, 0]] {
        let told = told(|_| lot.clone());
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(told[0].en.contains("ttyUSB0: nothing readable") && told[0].ja.contains("ttyUSB0"));
    }
}

#[test]
fn a_receiver_that_is_heard_is_not_doubted() {
    let mut lab = shisei_twin::lab::Lab::new(shisei_twin::lab::Settings::default());
    let mut seconds: Vec<Vec<u8>> = Vec::new();
    for second in 1..=10 {
        lab.run_to(f64::from(second));
        let mut bytes = Vec::new();
        lab.serial(&mut bytes);
        seconds.push(bytes);
    }
    let told = told(|second| seconds[second].clone());
    assert!(told.iter().all(|note| !note.en.contains("readable")), "{told:?}");
}
