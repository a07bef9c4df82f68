//! A recording back: whole, cut at any byte, or damaged in places.

use std::collections::BTreeMap;
use std::io;
use std::ops::ControlFlow;

use mcap::records::Record;
use shisei_record::mcap_records::{self, Loss};

/// The bytes of the line in a recording, in their order, each with when it came, ns since 1970; and what of the file
/// could not be read and is left out. A file that is no MCAP of ours is an error.
pub fn raw(file: &[u8], mut each: impl FnMut(&str, u64, &[u8])) -> io::Result<Loss> {
    let (mut topics, mut any) = (BTreeMap::new(), false);
    let loss = mcap_records::records(file, |record| {
        any = true;
        match record {
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
        }
        ControlFlow::Continue(())
    });
    match loss {
        Ok(loss) if any => Ok(loss),
        Ok(_) => Err(io::Error::from(io::ErrorKind::UnexpectedEof)),
        Err(error) => Err(io::Error::new(io::ErrorKind::InvalidData, error)),
    }
}
