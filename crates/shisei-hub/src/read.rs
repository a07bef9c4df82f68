//! A recording back: whole, or cut at any byte.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};

use mcap::McapError;
use mcap::records::Record;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

/// How a recording ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// As it was ended.
    Whole,
    /// It was cut, or is damaged there: what follows is left out.
    Torn,
}

/// The bytes of the line in a recording, in their order, each with when it came, ns since 1970. A torn end is left
/// out, and told; anything else that is no MCAP of ours is an error.
pub fn raw(file: &[u8], mut each: impl FnMut(&str, u64, &[u8])) -> io::Result<Ending> {
    let mut topics = std::collections::BTreeMap::new();
    let walk = AssertUnwindSafe(|| {
        records(file, |record| match record {
            Record::Channel(channel) => {
                if let Some(port) = channel.topic.strip_prefix("/raw/") {
                    topics.insert(channel.id, port.to_owned());
                }
            }
            Record::Message { header, data } => {
                if let Some(port) = topics.get(&header.channel_id) {
                    each(port, header.log_time, &data);
                }
            }
            _ => {}
        })
    });
    // the decoder is not ours: where it panics, the file is damaged
    catch_unwind(walk).unwrap_or(Ok(Ending::Torn))
}

fn records(file: &[u8], mut each: impl FnMut(Record<'_>)) -> io::Result<Ending> {
    let options = LinearReaderOptions::default()
        .with_skip_end_magic(true)
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(file.len().max(64));
    let mut reader = LinearReader::new_with_options(options);
    let mut rest = file;
    let (mut any, mut ended) = (false, false);
    let invalid = |error: McapError| Err(io::Error::new(io::ErrorKind::InvalidData, error));
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(wanted)) => {
                let count = wanted.min(rest.len());
                let (now, later) = rest.split_at(count);
                reader.insert(count).get_mut(..count).unwrap_or_default().copy_from_slice(now);
                reader.notify_read(count);
                rest = later;
            }
            Ok(LinearReadEvent::Record { opcode, data }) => {
                any = true;
                match mcap::parse_record(opcode, data) {
                    Ok(record) => {
                        ended |= matches!(record, Record::DataEnd(_) | Record::Footer(_));
                        each(record);
                    }
                    Err(_) => return Ok(Ending::Torn),
                }
            }
            Err(error @ (McapError::UnsupportedCompression(_) | McapError::BadMagic)) => {
                return invalid(error);
            }
            Err(_) if any => return Ok(Ending::Torn),
            Err(error) => return invalid(error),
        }
    }
    match (any, ended) {
        (true, true) => Ok(Ending::Whole),
        (true, false) => Ok(Ending::Torn),
        (false, _) => Err(io::Error::from(io::ErrorKind::UnexpectedEof)),
    }
}
