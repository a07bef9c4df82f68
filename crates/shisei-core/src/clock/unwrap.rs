//! Counters that wrap.

/// The value nearest to `expected` whose lowest `bits` bits are those of `raw`; `bits` is 1 … 32.
///
/// For a 32-bit clock in µs and a 16-bit sequence number alike: expect the value before plus what has passed since
/// by another clock. Right as long as the expectation is off by less than half the counter's span.
pub fn unwrap_near(raw: u32, bits: u32, expected: i64) -> i64 {
    let span = 1_i64 << bits.clamp(1, 32);
    let raw = i64::from(raw) % span;
    // Towards minus infinity, so that values below zero work as well.
    let difference = raw.wrapping_sub(expected).rem_euclid(span);
    let shift = if difference >= span / 2 { difference - span } else { difference };
    expected.wrapping_add(shift)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_value_is_found() {
        assert_eq!(unwrap_near(3, 16, 65_530), 65_539);
        assert_eq!(unwrap_near(65_530, 16, 65_539), 65_530);
        assert_eq!(unwrap_near(65_535, 16, 0), -1);
        assert_eq!(unwrap_near(5, 32, 4_294_967_290), 4_294_967_301);
        assert_eq!(unwrap_near(u32::MAX, 32, 4_294_967_301), 4_294_967_295);
        assert_eq!(unwrap_near(7, 32, 7), 7);
    }

    /// A counter that is followed with steps shorter than half its span never goes astray.
    #[test]
    fn a_long_run_is_followed() {
        let mut value = 0_i64;
        for k in 0..10_000_i64 {
            let truth = k * 20_011;
            value = unwrap_near((truth % 65_536) as u32, 16, value);
            assert_eq!(value, truth);
        }
    }
}
