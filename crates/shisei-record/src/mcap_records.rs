//! The records of an MCAP file that is whole, was cut, or is damaged in places.

use std::io::Read;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};

use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{MAGIC, McapError};

/// What of a file could not be read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Loss {
    /// Damaged parts that were left out: chunks whose sum is wrong, other records that make no sense.
    pub parts: usize,
    /// The file was cut; what is whole before that was read.
    pub cut: bool,
}

impl Loss {
    /// Whether all was read.
    pub fn is_none(self) -> bool {
        self == Loss::default()
    }
}

/// Gives a file's header, schemas, channels and messages in their order, those in chunks as if they stood alone, and the
/// end of the data, until `each` breaks. A damaged part is left out as a whole. Errors: no MCAP, or one whose chunks are compressed.
pub fn records<'a>(
    file: &'a [u8],
    mut each: impl FnMut(Record<'a>) -> ControlFlow<()>,
) -> Result<Loss, McapError> {
    let mut rest = file.strip_prefix(MAGIC).ok_or(McapError::BadMagic)?;
    let mut loss = Loss { parts: 0, cut: true };
    while let Some((kind, content, after)) = split(rest) {
        rest = after;
        let found = match kind {
            op::CHUNK => chunk(content),
            kind if is_read(kind) => mcap::parse_record(kind, content).map(|record| vec![record]),
            _ => continue,
        };
        match found {
            Ok(records) => {
                for record in records {
                    // What follows repeats what was said.
                    loss.cut &= !matches!(record, Record::DataEnd(_));
                    if each(record).is_break() {
                        return Ok(loss);
                    }
                }
            }
            Err(error @ McapError::UnsupportedCompression(_)) => return Err(error),
            Err(_) => loss.parts += 1,
        }
    }
    Ok(loss)
}

/// Whether records of this kind are of interest. The decoder panics at attachments that are cut.
fn is_read(kind: u8) -> bool {
    matches!(kind, op::HEADER | op::SCHEMA | op::CHANNEL | op::MESSAGE | op::DATA_END)
}

/// Kind and content of the first record, and what follows; nothing where it is not whole.
fn split(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (kind, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk()?;
    let (content, rest) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
    Some((*kind, content, rest))
}

/// The records of a chunk, if all of it is right. The decoder's own reader of chunks bounds no record's length.
fn chunk(content: &[u8]) -> Result<Vec<Record<'static>>, McapError> {
    // The decoder is not ours: where it panics, the chunk is damaged.
    let read = AssertUnwindSafe(|| {
        let head = [&[op::CHUNK], (content.len() as u64).to_le_bytes().as_slice()].concat();
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(content.len());
        let (mut reader, mut rest) = (LinearReader::new_with_options(options), head.chain(content));
        let mut records = Vec::new();
        while let Some(event) = reader.next_event() {
            match event? {
                LinearReadEvent::ReadRequest(wanted) => {
                    let count = rest.read(reader.insert(wanted))?;
                    reader.notify_read(count);
                }
                LinearReadEvent::Record { opcode, data } if is_read(opcode) => {
                    records.push(mcap::parse_record(opcode, data)?.into_owned());
                }
                LinearReadEvent::Record { .. } => {}
            }
        }
        Ok(records)
    });
    catch_unwind(read).unwrap_or(Err(McapError::UnexpectedEof))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Found by the fuzz target `record_mcap`: no room for an attachment's sum.
    #[test]
    fn an_attachment_that_is_cut() {
        let mut file = MAGIC.to_vec();
        for (kind, content) in [(op::ATTACHMENT, [0; 33].as_slice()), (op::DATA_END, &[0; 4])] {
            file.push(kind);
            file.extend((content.len() as u64).to_le_bytes());
            file.extend(content);
        }
        let mut ends = 0;
        let loss = records(&file, |record| {
            ends += usize::from(matches!(record, Record::DataEnd(_)));
            ControlFlow::Continue(())
        });
        assert_eq!((loss.unwrap(), ends), (Loss::default(), 1));
    }
}
