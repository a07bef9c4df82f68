//! What a node keeps over restarts, as it lies in its board's memory.
//!
//! | bytes | field |
//! |--:|---|
//! | 0 | length of the name |
//! | 1–20 | the name, UTF-8, then 0xFF |
//! | 21–22 | checksum of the bytes before, as that of a frame |
//! | 32–130 | the calibration ([`shisei_wire::calibration`]), or 0xFF |
//! | 132 | version of the layout of the settings, 1 |
//! | 133–136 | the settings ([`Settings`]) |
//! | 137–138 | checksum of the bytes from 132 on |
//!
//! What is not named is 0xFF, as erased flash is. Each part stands for itself: one that is absent or spoilt counts as
//! never stored. Earlier firmware stored no settings, and its records are read as such.

use shisei_wire::Calibration;
use shisei_wire::calibration::CALIBRATION_BYTES;
use shisei_wire::frame::checksum;
use shisei_wire::gatt::NAME_MAX;
use shisei_wire::message::{SETTINGS_BYTES, Settings};

/// Bytes of a record: a multiple of four, as flash is written.
pub const RECORD_BYTES: usize = 140;
const CALIBRATION_AT: usize = 32;
const SETTINGS_AT: usize = 132;
/// Version of the layout of the settings.
const LAYOUT: u8 = 1;
/// Length and name.
const NAME_CONTENT: usize = 1 + NAME_MAX;
/// Version and settings.
const SETTINGS_CONTENT: usize = 1 + SETTINGS_BYTES;

/// A node's name: at most [`NAME_MAX`] bytes of UTF-8.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Name {
    bytes: [u8; NAME_MAX],
    length: usize,
}

impl Name {
    /// A text that is too long is cut at a character's end.
    pub fn cut(text: &str) -> Self {
        let mut length = text.len().min(NAME_MAX);
        while !text.is_char_boundary(length) {
            length -= 1;
        }
        let mut bytes = [0; NAME_MAX];
        bytes.iter_mut().zip(text.bytes().take(length)).for_each(|(place, byte)| *place = byte);
        Name { bytes, length }
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        self.bytes.get(..self.length).and_then(|bytes| core::str::from_utf8(bytes).ok()).unwrap_or("")
    }
}

/// What is kept; none where it never was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Record {
    /// The name.
    pub name: Option<Name>,
    /// The calibration.
    pub calibration: Option<Calibration>,
    /// Filter, samples a packet, ranges.
    pub settings: Option<Settings>,
}

impl Record {
    /// As it is to lie in the memory.
    pub fn encode(&self) -> [u8; RECORD_BYTES] {
        let mut record = [0xFF; RECORD_BYTES];
        if let Some(name) = &self.name {
            let mut content = [0xFF; NAME_CONTENT];
            let all = core::iter::once(name.length as u8).chain(name.as_str().bytes());
            content.iter_mut().zip(all).for_each(|(place, byte)| *place = byte);
            put(&mut record, 0, &content);
            put(&mut record, NAME_CONTENT, &checksum(&content).to_le_bytes());
        }
        if let Some(Ok(calibration)) = self.calibration.map(|kept| kept.encode()) {
            put(&mut record, CALIBRATION_AT, &calibration);
        }
        if let Some(Ok([filter, batch, gyro, acc])) = self.settings.map(|settings| settings.encode()) {
            let content = [LAYOUT, filter, batch, gyro, acc];
            put(&mut record, SETTINGS_AT, &content);
            put(&mut record, SETTINGS_AT + SETTINGS_CONTENT, &checksum(&content).to_le_bytes());
        }
        record
    }

    /// What lies in the memory.
    pub fn decode(record: &[u8; RECORD_BYTES]) -> Self {
        Record {
            name: checked::<NAME_CONTENT>(record, 0).and_then(|content| name(&content)),
            calibration: record
                .get(CALIBRATION_AT..CALIBRATION_AT + CALIBRATION_BYTES)
                .and_then(|bytes| Calibration::decode(bytes).ok()),
            settings: checked::<SETTINGS_CONTENT>(record, SETTINGS_AT).and_then(settings),
        }
    }
}

fn put(record: &mut [u8], at: usize, bytes: &[u8]) {
    record.iter_mut().skip(at).zip(bytes).for_each(|(place, byte)| *place = *byte);
}

/// The bytes from `at` on, if the checksum behind them is theirs.
fn checked<const N: usize>(record: &[u8], at: usize) -> Option<[u8; N]> {
    let (content, rest) = record.get(at..)?.split_first_chunk::<N>()?;
    let sum = u16::from_le_bytes(*rest.first_chunk()?);
    (checksum(content) == sum).then_some(*content)
}

fn name(content: &[u8; NAME_CONTENT]) -> Option<Name> {
    let (length, bytes) = content.split_first()?;
    let text = core::str::from_utf8(bytes.get(..usize::from(*length))?).ok()?;
    (!text.is_empty()).then(|| Name::cut(text))
}

fn settings([layout, fields @ ..]: [u8; SETTINGS_CONTENT]) -> Option<Settings> {
    if layout == LAYOUT { Settings::decode(fields).ok() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shisei_wire::calibration::Correction;
    use shisei_wire::packet::FilterKind;
    use shisei_wire::{AccRange, GyroRange};

    fn all() -> Record {
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let half = Correction { bias: [0.01, -0.02, 0.03], matrix: identity };
        Record {
            name: Some(Name::cut("左手")),
            calibration: Some(Calibration { accelerometer: half, gyroscope: half }),
            settings: Some(Settings {
                filter: FilterKind::Estimator,
                batch: 7,
                gyro_range: GyroRange::Dps500,
                acc_range: AccRange::G16,
            }),
        }
    }

    #[test]
    fn what_is_stored_is_read_in_any_combination() {
        let all = all();
        for k in 0..8 {
            let record = Record {
                name: all.name.filter(|_| k & 1 > 0),
                calibration: all.calibration.filter(|_| k & 2 > 0),
                settings: all.settings.filter(|_| k & 4 > 0),
            };
            assert_eq!(Record::decode(&record.encode()), record, "{k}");
        }
        assert_eq!(Record::decode(&[0xFF; RECORD_BYTES]), Record::default());
        assert_eq!(Record::decode(&[0; RECORD_BYTES]), Record::default());
    }

    /// The layout of 0.1.0, byte by byte: name and calibration, erased flash behind.
    #[test]
    fn a_record_without_settings_is_still_read() {
        let mut old = [0xFF; RECORD_BYTES];
        old[..4].copy_from_slice(b"\x03abc");
        // by Python's binascii.crc_hqx(b"\x03abc" + b"\xff" * 17, 0xffff)
        old[21..23].copy_from_slice(&0x5b89_u16.to_le_bytes());
        assert_eq!(Record::decode(&old).name.map(|name| name.as_str().to_owned()), Some("abc".to_owned()));
        assert_eq!((Record::decode(&old).settings, Record::decode(&old).calibration), (None, None));
    }

    #[test]
    fn a_spoilt_part_costs_itself_alone() {
        let whole = all();
        for at in (0..22).chain(132..138) {
            let mut spoilt = whole.encode();
            spoilt[at] ^= 0x10;
            let found = Record::decode(&spoilt);
            assert_eq!(found.calibration, whole.calibration, "{at}");
            assert_eq!((found.name.is_none(), found.settings.is_none()), (at < 22, at >= 132), "{at}");
        }
        // another layout is none of ours
        let mut later = whole.encode();
        later[132] = 2;
        let sum = checksum(&later[132..137]).to_le_bytes();
        later[137..139].copy_from_slice(&sum);
        assert_eq!(Record::decode(&later), Record { settings: None, ..whole });
    }

    #[test]
    fn a_name_is_cut_at_a_characters_end() {
        assert_eq!(Name::cut("左手の親指の先端").as_str(), "左手の親指の");
        assert_eq!(Name::cut("").as_str(), "");
    }
}
