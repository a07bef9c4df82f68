//! bumble's own central finds our node, reads it, subscribes, sets it.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use virtual_firmware::{DeviceClock, VirtualNode, free_ports, monotonic_us, open, python, script};

#[test]
fn a_central_that_is_not_ours_uses_our_node() {
    let clock = DeviceClock { base_us: monotonic_us(), offset_us: 1e6, ppm: 40.0 };
    let port = free_ports(1)[0];
    let mut central = Command::new(python())
        .arg(script("central.py"))
        .args([
            clock.base_us.to_string(),
            port.to_string(),
            clock.offset_us.to_string(),
            clock.ppm.to_string(),
        ])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(central.stdout.take().unwrap()).lines();
    assert_eq!(lines.next().unwrap().unwrap(), "ready");
    let told = std::thread::spawn(move || lines.next().map(|line| line.unwrap()));
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    let local = tokio::task::LocalSet::new();
    let node = VirtualNode { address: [1, 0, 0, 0, 0xee, 0xff], boot: 4711, name: "node-1".into(), clock };
    local.block_on(&runtime, async {
        tokio::task::spawn_local(async move { node.run(open(port).await).await });
        while !told.is_finished() {
            tokio::time::sleep(std::time::Duration::from_millis(50)).await;
        }
    });
    assert!(central.wait().unwrap().success());
    let told: serde_json::Value = serde_json::from_str(&told.join().unwrap().expect("it tells")).unwrap();
    // Others write identifiers with dashes or without.
    let plain = |text: &str| text.to_uppercase().replace('-', "");
    let advertised = plain(&told["advertised"].to_string());
    assert!(advertised.contains("1F5233109E1C4E4DB12A5CCB61700001"), "{advertised}");
    assert_eq!(told["mtu"], 247);
    for (number, properties) in [(2, 0x10), (3, 0x08), (4, 0x02), (5, 0x02)] {
        let characteristics = told["characteristics"].as_object().unwrap();
        let name = format!("1F5233109E1C4E4DB12A5CCB6170{number:04X}");
        let found = characteristics.iter().find(|(uuid, _)| plain(uuid).contains(&name));
        assert_eq!(found.map(|(_, value)| value.as_i64()), Some(Some(properties)), "{characteristics:?}");
    }
    // 3987 mV, 25.12 °C, the version, boot 4711, the name.
    let version: String = shisei_device::FIRMWARE.iter().map(|part| format!("{part:02x}")).collect();
    let hex = |text: &str| text.bytes().map(|byte| format!("{byte:02x}")).collect::<String>();
    assert_eq!(told["status"], format!("930fd009{version}6712{}", hex("node-1")));
    assert_eq!(told["renamed"], format!("930fd009{version}6712{}", hex("left-hand")));
    check(&told["before"], 4, 0);
    check(&told["after"], 8, 1);
    // A calibration is kept as it was written; a damaged one is refused (value not allowed) and changes nothing.
    let calibration = told["calibration"].as_str().unwrap();
    assert_eq!(told["kept"], serde_json::json!(["", calibration, calibration, ""]));
    assert_eq!(told["refused"], 0x13);
    let calibrated = told["calibrated"].as_array().unwrap();
    assert!(calibrated.len() > 3 && calibrated.iter().all(|flag| flag == 1), "{calibrated:?}");
}

/// Packets of `count` samples but for those that a new start cuts short; all with this filter, nothing missing, 120 Hz,
/// the sensor's counts.
fn check(packets: &serde_json::Value, count: u64, filter: u64) {
    let packets = packets.as_array().unwrap();
    let number = |packet: &serde_json::Value, key: &str| packet[key].as_u64().unwrap();
    let full = packets.iter().filter(|packet| number(packet, "count") == count).count() as u64;
    let counts: Vec<u64> = packets.iter().map(|packet| number(packet, "count")).collect();
    assert!(full * count >= 120, "{full} packets: {counts:?}");
    for two in packets.windows(2) {
        let own = number(&two[0], "count");
        assert_eq!((number(&two[0], "sequence") + own) & 0xffff, number(&two[1], "sequence"));
        let step_us = (number(&two[1], "time_us") - number(&two[0], "time_us")) as f64 / own as f64;
        assert!((step_us - 8333.3).abs() < 1.0, "{step_us}");
    }
    for packet in packets {
        assert_eq!((number(packet, "boot"), number(packet, "flags") >> 8 & 3), (4711, filter));
        for sample in packet["samples"].as_array().unwrap() {
            let values: Vec<i64> =
                sample.as_array().unwrap().iter().map(|value| value.as_i64().unwrap()).collect();
            assert_eq!(values[1..7], [3, -2, 1, 0, 0, 4098]);
        }
    }
}
