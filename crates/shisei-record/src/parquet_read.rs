//! Parquet: flat columns of numbers, booleans, time stamps and text, without a data-frame engine.

use crate::body::{self, Body, SLOTS, TimeForm, Wanted};
use crate::encoding::Encoding;
use crate::error::{Error, Place, Problem, Result, shorten};
use crate::open::UNPACKED_LIMIT;
use crate::parquet_pages::{Checked, check_headers};
use crate::parquet_thrift::Walker;
use crate::sheet::{Delimiter, Sheet};
use bytes::Bytes;
use parquet::basic::{LogicalType, TimeUnit, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use std::borrow::Cow;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Rows read at once.
const BATCH: usize = 16_384;

/// True for a Parquet file.
pub(crate) fn recognises(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PAR1")
}

/// An opened file.
pub(crate) struct File {
    bytes: Bytes,
    reader: SerializedFileReader<Bytes>,
    rows: usize,
}

fn damaged(name: &str, detail: &str) -> Error {
    Error::of_file(name, Problem::Damaged { format: "Parquet", detail: shorten(detail) })
}

/// The decoder is not ours: what it cannot take is an error, also where it panics.
fn guarded<T>(name: &str, work: impl FnOnce() -> parquet::errors::Result<T>) -> Result<T> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(value)) => Ok(value),
        // A codec that is not built in: the file is whole.
        Ok(Err(ParquetError::General(why))) if why.contains("Disabled feature") => {
            let codec =
                ["brotli", "lzo", "lz4", "gzip", "zstd", "snappy"].into_iter().find(|c| why.contains(c));
            let format = codec.unwrap_or("another codec").to_owned();
            Err(Error::of_file(name, Problem::Compression { codec: format }))
        }
        Ok(Err(error)) => Err(damaged(name, &error.to_string())),
        Err(_) => Err(damaged(name, "its decoder stopped")),
    }
}

/// Opens a file: its metadata only.
pub(crate) fn open(name: &str, bytes: &[u8]) -> Result<File> {
    let bytes = Bytes::copy_from_slice(bytes);
    if footer(&bytes).is_some_and(|footer| Walker::new(footer).structure(|_, _| {}).is_none()) {
        return Err(damaged(name, "a damaged footer"));
    }
    let reader = guarded(name, || SerializedFileReader::new(bytes.clone()))?;
    let rows = reader.metadata().file_metadata().num_rows();
    let rows = usize::try_from(rows).map_err(|_| damaged(name, "a negative number of rows"))?;
    let columns = reader.metadata().file_metadata().schema_descr().num_columns();
    // Of every row at least the seven columns of a sensor are read, as doubles.
    if (rows as u64).saturating_mul(80) > UNPACKED_LIMIT {
        return Err(Error::of_file(name, Problem::TooLarge { limit: UNPACKED_LIMIT }));
    }
    if columns > 10_000 {
        return Err(damaged(name, "more than 10000 columns"));
    }
    Ok(File { bytes, reader, rows })
}

/// The footer, in front of its length and the format's name; nothing where the decoder will say that there is none.
fn footer(bytes: &[u8]) -> Option<&[u8]> {
    let (rest, length) = bytes.strip_suffix(b"PAR1")?.split_last_chunk()?;
    let start = rest.len().checked_sub(u32::from_le_bytes(*length) as usize)?;
    rest.get(start..)
}

/// Values of a column, nulls as NaN or empty text.
enum Values {
    Numbers(Vec<f64>),
    Integers(Vec<Option<i64>>),
    Texts(Vec<Box<str>>),
}

impl Values {
    fn text(&self, row: usize) -> String {
        match self {
            Values::Numbers(v) => {
                v.get(row).filter(|v| !v.is_nan()).map_or_else(String::new, |v| format!("{v}"))
            }
            Values::Integers(v) => v.get(row).copied().flatten().map_or_else(String::new, |v| format!("{v}")),
            Values::Texts(v) => v.get(row).map(ToString::to_string).unwrap_or_default(),
        }
    }

    fn number(&self, row: usize, origin: i64) -> f64 {
        match self {
            Values::Numbers(v) => v.get(row).map_or(f64::NAN, |v| v - origin as f64),
            Values::Integers(v) => {
                v.get(row).copied().flatten().map_or(f64::NAN, |v| v.saturating_sub(origin) as f64)
            }
            Values::Texts(v) => v.get(row).and_then(|text| text.trim().parse().ok()).unwrap_or(f64::NAN),
        }
    }
}

impl File {
    /// The columns as a sheet: names, units of time stamps, the first rows.
    pub(crate) fn sheet<'n>(&self, name: &'n str) -> Result<Sheet<'n>> {
        let schema = self.reader.metadata().file_metadata().schema_descr_ptr();
        let mut header = Vec::new();
        let mut units = Vec::new();
        for column in schema.columns() {
            header.push(shorten(&column.path().string()));
            let unit = match column.logical_type_ref() {
                Some(LogicalType::Timestamp(stamp)) => Some(stamp.unit),
                Some(LogicalType::Time(time)) => Some(time.unit),
                _ => None,
            };
            units.push(match unit {
                Some(TimeUnit::MILLIS) => "ms".to_owned(),
                Some(TimeUnit::MICROS) => "us".to_owned(),
                Some(TimeUnit::NANOS) => "ns".to_owned(),
                None => String::new(),
            });
        }
        if self.rows == 0 {
            return Err(Error::of_file(name, Problem::HeaderOnly));
        }
        let shown = self.rows.min(64);
        let columns: Vec<Values> =
            (0..header.len()).map(|i| self.column(name, i, shown)).collect::<Result<_>>()?;
        let sample = (0..shown).map(|row| columns.iter().map(|c| c.text(row)).collect()).collect();
        Ok(Sheet {
            name,
            encoding: Encoding::Utf8,
            delimiter: Delimiter::Byte(b','),
            decimal: b'.',
            preamble: Vec::new(),
            header,
            groups: Vec::new(),
            units,
            sample,
            text: Cow::Borrowed(&[]),
            data_offset: 0,
            data_line: 1,
        })
    }

    /// The wanted columns' rows.
    pub(crate) fn read(&self, name: &str, wanted: &Wanted) -> Result<Body> {
        let mut columns = Vec::new();
        for slot in wanted.slot {
            columns.push(match slot {
                Some(index) => Some((index, self.column(name, index, self.rows)?)),
                None => None,
            });
        }
        let keep: Vec<Values> =
            wanted.keep.iter().map(|i| self.column(name, *i, self.rows)).collect::<Result<_>>()?;
        let mut out = Body { whole_numbers: true, keep: vec![Vec::new(); keep.len()], ..Body::default() };
        let mut row_values = [0.0; SLOTS];
        for row in 0..self.rows {
            let mut bad = None;
            for (slot, column) in columns.iter().enumerate() {
                let Some((index, values)) = column else { continue };
                let origin = match (slot, wanted.time_form) {
                    (body::TIME, TimeForm::Large(origin)) => origin,
                    _ => 0,
                };
                let value = match (slot, wanted.time_form, values) {
                    (body::TIME, TimeForm::Text(origin), Values::Texts(v)) => v
                        .get(row)
                        .and_then(|t| crate::stamp::parse(t.trim().as_bytes()))
                        .map_or(f64::NAN, |s| s.ns.saturating_sub(origin) as f64 / 1e9),
                    _ => values.number(row, origin),
                };
                if !value.is_finite() && slot != body::TEMP && bad.is_none() {
                    let text = matches!(values, Values::Texts(_)).then(|| values.text(row));
                    bad = Some((*index, value, text.filter(|text| !text.trim().is_empty())));
                }
                if let Some(place) = row_values.get_mut(slot) {
                    *place = value;
                }
            }
            match bad {
                None => {
                    body::push(&mut out, &row_values, wanted);
                    for (kept, values) in out.keep.iter_mut().zip(&keep) {
                        kept.push(values.text(row).into());
                    }
                }
                Some(_) if wanted.skip_bad => out.skipped += 1,
                Some((index, value, text)) => {
                    let problem = match text {
                        Some(text) => Problem::NotANumber { text: shorten(&text) },
                        None if value.is_nan() => Problem::Blank,
                        None => Problem::NotFinite { text: value.to_string() },
                    };
                    let schema = self.reader.metadata().file_metadata().schema_descr();
                    let title = schema.columns().get(index).map(|c| c.path().string()).unwrap_or_default();
                    let place = Place {
                        file: name.to_owned(),
                        line: Some(row + 1),
                        column: Some((index + 1, title)),
                    };
                    return Err(Error::at(problem, place));
                }
            }
        }
        if out.rows < 2 {
            return Err(Error::of_file(name, Problem::TooFewRows { rows: out.rows }));
        }
        Ok(out)
    }

    /// The first `limit` values of a column.
    fn column(&self, name: &str, index: usize, limit: usize) -> Result<Values> {
        let schema = self.reader.metadata().file_metadata().schema_descr_ptr();
        let column =
            schema.columns().get(index).cloned().ok_or_else(|| damaged(name, "a column is missing"))?;
        let flat = column.max_rep_level() == 0;
        let mut out = match column.physical_type() {
            Type::DOUBLE | Type::FLOAT => Values::Numbers(Vec::new()),
            Type::INT32 | Type::INT64 | Type::BOOLEAN => Values::Integers(Vec::new()),
            _ => Values::Texts(Vec::new()),
        };
        if !flat {
            return Ok(Values::Texts(Vec::new()));
        }
        let top = column.max_def_level();
        guarded(name, || {
            let mut left = limit;
            for group in 0..self.reader.num_row_groups() {
                if left == 0 {
                    break;
                }
                let group = self.reader.get_row_group(group)?;
                check_headers(&self.bytes, group.metadata().column(index).byte_range())?;
                let pages = group.get_column_page_reader(index)?;
                let pages = Checked { pages, kind: column.physical_type(), top, rows: self.rows };
                let reader = get_column_reader(column.clone(), Box::new(pages));
                left -= match (reader, &mut out) {
                    (ColumnReader::DoubleColumnReader(r), Values::Numbers(v)) => {
                        pull(r, top, left, |x| v.push(x.copied().unwrap_or(f64::NAN)))?
                    }
                    (ColumnReader::FloatColumnReader(r), Values::Numbers(v)) => {
                        pull(r, top, left, |x| v.push(x.map_or(f64::NAN, |x| f64::from(*x))))?
                    }
                    (ColumnReader::Int32ColumnReader(r), Values::Integers(v)) => {
                        pull(r, top, left, |x| v.push(x.map(|x| i64::from(*x))))?
                    }
                    (ColumnReader::Int64ColumnReader(r), Values::Integers(v)) => {
                        pull(r, top, left, |x| v.push(x.copied()))?
                    }
                    (ColumnReader::BoolColumnReader(r), Values::Integers(v)) => {
                        pull(r, top, left, |x| v.push(x.map(|x| i64::from(*x))))?
                    }
                    (ColumnReader::ByteArrayColumnReader(r), Values::Texts(v)) => {
                        pull(r, top, left, |x: Option<&ByteArray>| {
                            v.push(x.map_or_else(Box::default, |x| String::from_utf8_lossy(x.data()).into()));
                        })?
                    }
                    _ => left,
                };
            }
            Ok(())
        })?;
        Ok(out)
    }
}

/// Reads up to `limit` records, giving each value or nothing for a null; returns how many.
fn pull<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    top: i16,
    limit: usize,
    mut push: impl FnMut(Option<&T::T>),
) -> parquet::errors::Result<usize> {
    let mut values: Vec<T::T> = Vec::new();
    let mut levels: Vec<i16> = Vec::new();
    let mut done = 0;
    while done < limit {
        values.clear();
        levels.clear();
        let (records, _, _) = reader.read_records(
            BATCH.min(limit - done),
            (top > 0).then_some(&mut levels),
            None,
            &mut values,
        )?;
        if records == 0 {
            break;
        }
        if top > 0 {
            let mut present = values.iter();
            for level in &levels {
                push(if *level == top { present.next() } else { None });
            }
        } else {
            for value in &values {
                push(Some(value));
            }
        }
        done += records;
    }
    Ok(done)
}
