//! FNV-1a, 64 bits, over the little-endian bytes of what is pushed.
//!
//! Source: G. Fowler, L. C. Noll, K.-P. Vo, D. Eastlake, "The FNV Non-Cryptographic Hash Algorithm".

use shisei_core::{Error, Quaternion, Vec3, Ypr};

/// A running digest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest {
    hash: u64,
    accepted: u32,
    refused: u32,
}

impl Default for Digest {
    fn default() -> Self {
        Digest::new()
    }
}

impl Digest {
    /// Of nothing.
    pub const fn new() -> Self {
        Digest { hash: 0xcbf2_9ce4_8422_2325, accepted: 0, refused: 0 }
    }

    /// The 64 bits so far.
    pub const fn value(self) -> u64 {
        self.hash
    }

    /// How many results were values, and how many errors.
    pub const fn results(self) -> (u32, u32) {
        (self.accepted, self.refused)
    }

    /// Adds bytes.
    pub fn push_bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.hash = (self.hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// Adds an integer.
    pub fn push_u64(&mut self, value: u64) {
        self.push_bytes(&value.to_le_bytes());
    }

    /// Adds the bits of a number. All NaN count as one: their sign and payload are not specified.
    pub fn push(&mut self, value: f64) {
        self.push_u64(if value.is_nan() { 0x7ff8_0000_0000_0000 } else { value.to_bits() });
    }

    /// Adds numbers in their order.
    pub fn push_all(&mut self, values: &[f64]) {
        for value in values {
            self.push(*value);
        }
    }

    /// Adds a vector.
    pub fn push_vec3(&mut self, vector: Vec3) {
        self.push_all(&vector);
    }

    /// Adds a quaternion.
    pub fn push_quaternion(&mut self, q: Quaternion) {
        self.push_all(&q.to_array());
    }

    /// Adds yaw, pitch, roll.
    pub fn push_ypr(&mut self, ypr: Ypr) {
        self.push_all(&ypr.to_array());
    }

    /// Adds what `push` makes of a result, or the kind of its error.
    pub fn push_result<T>(&mut self, result: Result<T, Error>, push: impl FnOnce(&mut Self, T)) {
        match result {
            Ok(value) => {
                self.accepted += 1;
                self.push_bytes(b"ok");
                push(self, value);
            }
            Err(error) => {
                self.refused += 1;
                self.push_bytes(b"error");
                self.push_u64(error.kind() as u64);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(bytes: &[u8]) -> u64 {
        let mut digest = Digest::new();
        digest.push_bytes(bytes);
        digest.value()
    }

    /// Test vectors of draft-eastlake-fnv, appendix C.
    #[test]
    fn published_vectors() {
        assert_eq!(of(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(of(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(of(b"foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn one_bit_changes_it_and_nan_is_one_value() {
        let of = |value: f64| {
            let mut digest = Digest::new();
            digest.push(value);
            digest.value()
        };
        assert_ne!(of(1.0), of(f64::from_bits(1.0_f64.to_bits() + 1)));
        assert_ne!(of(0.0), of(-0.0));
        assert_eq!(of(f64::NAN), of(-f64::NAN));
    }
}
