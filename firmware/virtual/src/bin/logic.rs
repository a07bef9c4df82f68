//! The node's work of `firmware/logic` on this machine: what its packets' bits must be.

#[path = "../../../logic/src/work.rs"]
mod work;

use shisei_wire::packet::FilterKind;

fn main() {
    let mut readings = 0;
    for (name, filter, calibrated) in work::CASES {
        let (hash, samples) = work::run(filter, calibrated, |_, before| readings += u64::from(before));
        println!("{name} {hash:016x} {samples} samples");
    }
    assert!(
        work::filter(FilterKind::Complementary, |_, _| {}).to_array().iter().all(|part| part.is_finite())
    );
    assert!(readings > work::STARTED && readings == work::CASES.len() as u64 * work::READINGS);
}
