//! A recording back: whole, or cut at any byte.

use std::io;

use mcap::records::Record;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

/// The bytes of the line in a recording, in their order, each with when it came, ns since 1970. A torn end is left
/// out; anything else that is no MCAP is an error.
pub fn raw(file: &[u8], mut each: impl FnMut(&str, u64, &[u8])) -> io::Result<()> {
    let mut topics = std::collections::BTreeMap::new();
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
}

fn records(file: &[u8], mut each: impl FnMut(Record<'_>)) -> io::Result<()> {
    let options = LinearReaderOptions::default()
        .with_skip_end_magic(true)
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(file.len().max(64));
    let mut reader = LinearReader::new_with_options(options);
    let mut rest = file;
    let mut any = false;
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
                    Ok(record) => each(record),
                    Err(_) => return Ok(()),
                }
            }
            // The torn end of a recording that was cut.
            Err(_) if any => return Ok(()),
            Err(error) => return Err(io::Error::new(io::ErrorKind::InvalidData, error)),
        }
    }
    if any { Ok(()) } else { Err(io::Error::from(io::ErrorKind::UnexpectedEof)) }
}
