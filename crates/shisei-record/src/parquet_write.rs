//! Writing our columns as Parquet: doubles, zstd, one row group a million rows.

use crate::parquet_thrift::{Value, Walker};
use crate::write::Column;
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType};
use parquet::errors::{ParquetError, Result};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::sync::Arc;

/// Rows of a row group.
const GROUP: usize = 1 << 20;
/// What the footer says of who made the file, before the version.
const MAKER: &str = "shisei ";
/// Longest footer that is looked at, bytes; ours have some hundred bytes a column and a million rows.
const LONGEST_FOOTER: u32 = 1 << 24;

/// True where the footer says that we made the file. Reads no more than the footer, and none longer than 16 MiB.
pub fn is_ours<R: Read + Seek>(file: &mut R) -> bool {
    let mut maker = || {
        let end = file.seek(SeekFrom::End(-8)).ok()?;
        let mut last = [0; 8];
        file.read_exact(&mut last).ok()?;
        let length = u32::from_le_bytes(*last.first_chunk()?);
        if !last.ends_with(b"PAR1") || length > LONGEST_FOOTER {
            return None;
        }
        file.seek(SeekFrom::Start(end.checked_sub(u64::from(length))?)).ok()?;
        let mut footer = vec![0; length as usize];
        file.read_exact(&mut footer).ok()?;
        let mut ours = false;
        Walker::new(&footer).structure(|field, value| {
            // created_by
            ours |= field == 6 && matches!(value, Value::Bytes(text) if text.starts_with(MAKER.as_bytes()));
        })?;
        Some(ours)
    };
    maker() == Some(true)
}

/// Writes a table as Parquet.
pub fn parquet<W: Write + Send>(sink: W, names: &[&str], columns: &[Column<'_>]) -> io::Result<()> {
    write(sink, names, columns).map_err(|e| match e {
        ParquetError::External(inner) => match inner.downcast::<io::Error>() {
            Ok(io) => *io,
            Err(other) => io::Error::other(other),
        },
        other => io::Error::other(other),
    })
}

/// Writes a recording's canonical columns (INTERFACES), then the kept ones.
pub fn recording_parquet<W: Write + Send>(sink: W, recording: &crate::Recording) -> io::Result<()> {
    crate::write::with_columns(recording, |(names, kept), columns| {
        let names: Vec<&str> = names.iter().copied().chain(kept.iter().map(String::as_str)).collect();
        parquet(sink, &names, columns)
    })
}

fn write<W: Write + Send>(sink: W, names: &[&str], columns: &[Column<'_>]) -> Result<()> {
    let mut fields = Vec::new();
    for (name, column) in names.iter().zip(columns) {
        let (physical, logical) = match column {
            Column::Numbers(_) | Column::Strided { .. } | Column::Computed { .. } => (Physical::DOUBLE, None),
            Column::Flags(_) => (Physical::BOOLEAN, None),
            Column::Texts(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let field = Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::REQUIRED)
            .with_logical_type(logical)
            .build()?;
        fields.push(Arc::new(field));
    }
    let schema = Arc::new(Type::group_type_builder("schema").with_fields(fields).build()?);
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(1)?))
        .set_dictionary_enabled(false)
        .set_created_by(format!("{MAKER}{}", env!("CARGO_PKG_VERSION")))
        .build();
    let mut writer = SerializedFileWriter::new(sink, schema, Arc::new(properties))?;
    let rows = columns.iter().map(Column::len).max().unwrap_or(0);
    let mut start = 0;
    while start < rows {
        let end = rows.min(start + GROUP);
        let mut group = writer.next_row_group()?;
        for column in columns {
            write_column(&mut group, column, start, end)?;
        }
        group.close()?;
        start = end;
    }
    writer.close()?;
    Ok(())
}

fn write_column<W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    column: &Column<'_>,
    start: usize,
    end: usize,
) -> Result<()> {
    let Some(mut writer) = group.next_column()? else { return Ok(()) };
    match column {
        Column::Numbers(_) | Column::Strided { .. } | Column::Computed { .. } => {
            let mut values = vec![f64::NAN; end - start];
            if column.fill(start, &mut values).is_some() {
                writer.typed::<DoubleType>().write_batch(&values, None, None)?;
            }
        }
        Column::Flags(values) => {
            writer.typed::<BoolType>().write_batch(values.get(start..end).unwrap_or_default(), None, None)?;
        }
        Column::Texts(values) => {
            let texts: Vec<ByteArray> =
                values.get(start..end).unwrap_or_default().iter().map(|t| ByteArray::from(&**t)).collect();
            writer.typed::<ByteArrayType>().write_batch(&texts, None, None)?;
        }
    }
    writer.close()
}
