//! What `devices`, `record` and `simulate` share: ports, an orderly stop.

use std::fs::File;
use std::io::{self, Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use shisei_core::Lang;

use crate::fail::{Failure, say};

/// How long a read waits, ms: what has come is handled at least this often.
const READ_MS: u64 = 20;
/// USB serial ports have no rate; real ones do.
const BAUD: u32 = 1_000_000;

/// Where a receiver's bytes come from.
pub enum Feed {
    /// A serial port.
    Port(Box<dyn serialport::SerialPort>),
    /// A file of bytes.
    File(File),
}

/// What a read gave.
pub enum Got {
    /// So many bytes.
    Bytes(usize),
    /// Nothing now.
    Nothing,
    /// The end of a file.
    End,
}

impl Feed {
    /// Opens a port, or a file of bytes.
    pub fn open(name: &str) -> io::Result<Self> {
        if std::fs::metadata(name).is_ok_and(|meta| meta.is_file()) {
            return File::open(name).map(Feed::File);
        }
        let port = serialport::new(name, BAUD).timeout(Duration::from_millis(READ_MS)).open()?;
        Ok(Feed::Port(port))
    }

    /// Reads what is there, waiting a little. An error means that the port is gone.
    pub fn read(&mut self, bytes: &mut [u8]) -> io::Result<Got> {
        let read = match self {
            Feed::File(file) => {
                let count = file.read(bytes)?;
                return Ok(if count == 0 { Got::End } else { Got::Bytes(count) });
            }
            Feed::Port(port) => port.read(bytes),
        };
        match read {
            // A terminal whose other side is closed reads as empty, without waiting.
            Ok(0) => Err(io::ErrorKind::BrokenPipe.into()),
            Ok(count) => Ok(Got::Bytes(count)),
            Err(error) if matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::Interrupted) => {
                Ok(Got::Nothing)
            }
            Err(error) => Err(error),
        }
    }

    /// Writes to a port; a file takes nothing.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Feed::File(_) => Ok(()),
            Feed::Port(port) => port.write_all(bytes),
        }
    }
}

/// The sentence for a port that does not open.
pub fn no_port(name: &str, error: &io::Error, lang: Lang) -> Failure {
    Failure::input(say(
        lang,
        format!(
            "{name}: {error}; is the receiver plugged in, and no other program using the port? `shisei devices` lists ports"
        ),
        format!(
            "{name}：{error}。レシーバの接続と、他のプログラムがポートを使用していないことを確認してください。ポートの一覧は shisei devices で表示できます"
        ),
    ))
}

/// Set when the user wants to stop: Ctrl-C, or the system ends the program.
pub fn stop_flag() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    let set = Arc::clone(&stop);
    // Where there is no such thing as Ctrl-C the program simply ends; recordings survive that.
    let _ = ctrlc::set_handler(move || set.store(true, Ordering::Relaxed));
    stop
}
