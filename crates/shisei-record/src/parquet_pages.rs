//! Pages of a Parquet file that hold as many values as they say: the decoders take memory for what is said.

use parquet::basic::{Encoding, Type};
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::errors::{ParquetError, Result};

use crate::parquet_thrift::{Value, Walker, number};

/// An error where the headers of the pages in a part of a file, from a byte on and so many bytes long, say more values
/// than they have bytes: the decoder would count them.
pub(crate) fn check_headers(file: &[u8], (start, length): (u64, u64)) -> Result<()> {
    let walk = || {
        let mut walker = Walker::new(file.get(usize::try_from(start).ok()?..)?);
        let end = walker.rest.len().checked_sub(usize::try_from(length).ok()?)?;
        while walker.rest.len() > end {
            let mut size = None;
            walker.structure(|field, value| {
                if let (3, Value::Whole(value)) = (field, value) {
                    size = Some(value); // as stored
                }
            })?;
            walker.pass(u64::try_from(size?).ok()?)?;
        }
        Some(())
    };
    walk().ok_or_else(|| damaged("a damaged page header"))
}

/// Looks at each page before it is decoded.
pub(crate) struct Checked {
    pub pages: Box<dyn PageReader>,
    pub kind: Type,
    /// Greatest definition level of the column; above 0 where values may be missing.
    pub top: i16,
    /// Rows of the file.
    pub rows: usize,
}

fn damaged(detail: &str) -> ParquetError {
    ParquetError::General(detail.into())
}

impl Checked {
    fn check(&self, page: &Page) -> Result<()> {
        let (values, count, encoding) = match page {
            Page::DictionaryPage { buf, num_values, .. } => {
                let room = buf.len() / least_bytes(self.kind);
                let fits = *num_values as usize <= room;
                return if fits { Ok(()) } else { Err(damaged("a dictionary is cut short")) };
            }
            Page::DataPage { buf, num_values, encoding, def_level_encoding, .. } => {
                let levels =
                    if self.top > 0 { levels(buf, *num_values, *def_level_encoding, self.top) } else { 0 };
                (buf.get(levels..), *num_values, *encoding)
            }
            Page::DataPageV2 {
                buf, num_values, encoding, def_levels_byte_len, rep_levels_byte_len, ..
            } => {
                let levels = *def_levels_byte_len as usize + *rep_levels_byte_len as usize;
                (buf.get(levels..), *num_values, *encoding)
            }
        };
        if count as usize > self.rows {
            return Err(damaged("a page has more values than the file has rows"));
        }
        let lists = match encoding {
            Encoding::DELTA_LENGTH_BYTE_ARRAY => 1, // lengths
            Encoding::DELTA_BYTE_ARRAY => 2,        // lengths of prefixes and of suffixes
            _ => 0,
        };
        let mut rest = values.unwrap_or_default();
        for _ in 0..lists {
            rest = after_deltas(rest, u64::from(count))
                .ok_or_else(|| damaged("a page has fewer values than it says, or is cut short"))?;
        }
        Ok(())
    }
}

impl PageReader for Checked {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        let page = self.pages.get_next_page()?;
        if let Some(page) = &page {
            self.check(page)?;
        }
        Ok(page)
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        self.pages.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<()> {
        self.pages.skip_next_page()
    }

    fn at_record_boundary(&mut self) -> Result<bool> {
        self.pages.at_record_boundary()
    }
}

impl Iterator for Checked {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

/// Bytes that a value of a dictionary takes at least.
fn least_bytes(kind: Type) -> usize {
    match kind {
        Type::DOUBLE | Type::INT64 => 8,
        Type::INT96 => 12,
        Type::FLOAT | Type::INT32 | Type::BYTE_ARRAY => 4,
        Type::BOOLEAN | Type::FIXED_LEN_BYTE_ARRAY => 1,
    }
}

/// Bytes of the definition levels at the start of a page of the first format.
fn levels(page: &[u8], count: u32, encoding: Encoding, top: i16) -> usize {
    if encoding == Encoding::RLE {
        let length = page.first_chunk::<4>().map_or(0, |bytes| u32::from_le_bytes(*bytes));
        4 + length as usize
    } else {
        let bits = 16 - top.leading_zeros() as usize;
        (count as usize * bits).div_ceil(8)
    }
}

/// What follows a list of at most `most` delta-packed numbers; nothing where there are more, or the list is cut short.
fn after_deltas(bytes: &[u8], most: u64) -> Option<&[u8]> {
    let mut rest = bytes;
    let block = number(&mut rest)?;
    let parts = usize::try_from(number(&mut rest)?).ok()?;
    let count = number(&mut rest)?;
    let _first = number(&mut rest)?;
    if count > most {
        return None;
    }
    let part = block.checked_div(parts as u64).filter(|part| *part > 0)?;
    let mut left = count.saturating_sub(1);
    while left > 0 {
        let _least = number(&mut rest)?;
        let (widths, values) = rest.split_at_checked(parts)?;
        rest = values;
        for bits in widths {
            if left > 0 {
                let length = u64::from(*bits).checked_mul(part)? / 8;
                rest = rest.get(usize::try_from(length).ok()?..)?;
                left = left.saturating_sub(part);
            }
        }
    }
    Some(rest)
}

#[cfg(test)]
mod tests {
    use crate::{Input, Options, Problem, Recording, open};
    use parquet::basic::Encoding;
    use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
    use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterVersion};
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::{parser::parse_message_type, types::ColumnPath};
    use std::sync::Arc;

    const ROWS: usize = 300;

    fn note(row: usize) -> String {
        format!("a note of some length, number {row}")
    }

    /// A recording with a column of text, by the writer that the format's own makers keep.
    fn file(encoding: Encoding, version: WriterVersion, kind: &str) -> Vec<u8> {
        let names = ["time_s", "acc_x", "acc_y", "acc_z", "gyr_x", "gyr_y", "gyr_z"];
        let mut schema = "message table {\n".to_owned();
        for name in names {
            schema += &format!("required double {name};\n");
        }
        schema += &format!("{kind} binary note (UTF8);\n}}");
        let properties = WriterProperties::builder()
            .set_dictionary_enabled(false)
            .set_statistics_enabled(EnabledStatistics::None)
            .set_writer_version(version);
        let texts = ColumnPath::from("note");
        let properties = match encoding {
            Encoding::RLE_DICTIONARY => properties.set_column_dictionary_enabled(texts, true),
            _ => properties.set_column_encoding(texts, encoding),
        };
        let properties = properties.build();
        let schema = Arc::new(parse_message_type(&schema).unwrap());
        let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties)).unwrap();
        let mut group = writer.next_row_group().unwrap();
        for column in 0..names.len() {
            let values: Vec<f64> = (0..ROWS)
                .map(|k| match column {
                    0 => k as f64 * 0.01,
                    3 => 9.8,
                    _ => (k * column % 7) as f64 * 0.01,
                })
                .collect();
            let mut column = group.next_column().unwrap().unwrap();
            column.typed::<DoubleType>().write_batch(&values, None, None).unwrap();
            column.close().unwrap();
        }
        let missing = |k: usize| kind == "optional" && k % 3 == 1;
        let texts: Vec<ByteArray> =
            (0..ROWS).filter(|k| !missing(*k)).map(|k| ByteArray::from(note(k).into_bytes())).collect();
        let levels: Vec<i16> = (0..ROWS).map(|k| i16::from(!missing(k))).collect();
        let levels = (kind == "optional").then_some(levels.as_slice());
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<ByteArrayType>().write_batch(&texts, levels, None).unwrap();
        column.close().unwrap();
        group.close().unwrap();
        writer.into_inner().unwrap()
    }

    fn read(bytes: &[u8]) -> crate::Result<Recording> {
        let options = Options { keep: vec!["note".into()], ..Options::default() };
        open(&[Input { name: "a.parquet", bytes }], &options)
    }

    #[test]
    fn texts_in_every_delta_encoding() {
        for encoding in [Encoding::DELTA_LENGTH_BYTE_ARRAY, Encoding::DELTA_BYTE_ARRAY] {
            for version in [WriterVersion::PARQUET_1_0, WriterVersion::PARQUET_2_0] {
                for kind in ["required", "optional"] {
                    let recording = read(&file(encoding, version, kind)).unwrap();
                    assert_eq!(recording.len(), ROWS);
                    for (k, cell) in recording.extra[0].cells.iter().enumerate() {
                        let there = kind == "required" || k % 3 != 1;
                        assert_eq!(&**cell, if there { note(k) } else { String::new() });
                    }
                }
            }
        }
    }

    /// Pages that say that they hold 2^31 - 1 values: the decoder took 8 GB for their lengths.
    #[test]
    fn a_page_that_says_too_much_is_refused_before_it_is_decoded() {
        for encoding in [Encoding::DELTA_LENGTH_BYTE_ARRAY, Encoding::DELTA_BYTE_ARRAY] {
            let bytes = file(encoding, WriterVersion::PARQUET_1_0, "required");
            // Every list of lengths begins with blocks of 128 in 4 parts, then the number of values.
            let starts: Vec<usize> = (0..bytes.len())
                .filter(|k| {
                    bytes[*k..].starts_with(&[
                        0x80,
                        0x01,
                        0x04,
                        (ROWS % 128) as u8 | 0x80,
                        (ROWS / 128) as u8,
                    ])
                })
                .collect();
            assert_eq!(starts.len(), if encoding == Encoding::DELTA_BYTE_ARRAY { 2 } else { 1 });
            for start in starts {
                let mut bad = bytes.clone();
                bad[start + 3..start + 8].copy_from_slice(&[0xFF, 0xFF, 0xFF, 0xFF, 0x07]);
                let Problem::Damaged { detail, .. } = read(&bad).unwrap_err().problem else { panic!() };
                assert!(detail.starts_with("Parquet error: a page has fewer values"), "{detail}");
            }
        }
    }
    #[test]
    fn a_dictionary_said_to_be_longer_than_its_page() {
        let bytes = file(Encoding::RLE_DICTIONARY, WriterVersion::PARQUET_1_0, "required");
        // The header of a dictionary in plain encoding (field 7): its number of values, then 0, and the ends.
        let head = [0x4C, 0x15, (ROWS * 2 % 128) as u8 | 0x80, (ROWS * 2 / 128) as u8, 0x15, 0x00];
        let place = bytes.windows(head.len()).position(|window| window == head).unwrap();
        let mut bad = bytes.clone();
        bad[place + 2..place + 4].copy_from_slice(&[0xFE, 0x7F]); // 8191
        let Problem::Damaged { detail, .. } = read(&bad).unwrap_err().problem else { panic!() };
        assert_eq!(detail, "Parquet error: a dictionary is cut short");
    }

    /// Found by the fuzz target `record_parquet`: a list of 2^31 - 1 yeses and noes took the decoder two seconds, and
    /// there is room for hundreds.
    #[test]
    fn a_list_of_more_values_than_bytes_is_not_counted() {
        let long = [0xF9, 0xF1, 0xFF, 0xFF, 0xFF, 0xFF, 0x07]; // field 15
        let bytes = file(Encoding::PLAIN, WriterVersion::PARQUET_1_0, "required");
        let footer = u32::from_le_bytes(*bytes[..bytes.len() - 4].last_chunk().unwrap()) as usize;
        for (place, expected) in [
            (4, "Parquet error: a damaged page header"), // the first page's, behind "PAR1"
            (bytes.len() - 8 - footer, "a damaged footer"),
        ] {
            let mut bad = bytes.clone();
            bad[place..place + long.len()].copy_from_slice(&long);
            let Problem::Damaged { detail, .. } = read(&bad).unwrap_err().problem else { panic!() };
            assert_eq!(detail, expected);
        }
    }
}
