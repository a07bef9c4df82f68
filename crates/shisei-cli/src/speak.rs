//! `print!`, `println!`, `eprint!` and `eprintln!` of this crate. The standard ones panic where nobody reads any more
//! (`shisei info … | head -1`) or where a disk is full; these go on, so that no result is lost, and [`unsaid`] tells
//! the end of the run why standard output is not whole.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::sync::OnceLock;

macro_rules! print {
    ($($text:tt)*) => { $crate::speak::out(format_args!($($text)*)) };
}
macro_rules! println {
    ($($text:tt)*) => { $crate::speak::out(format_args!("{}\n", format_args!($($text)*))) };
}
macro_rules! eprint {
    ($($text:tt)*) => { $crate::speak::err(format_args!($($text)*)) };
}
macro_rules! eprintln {
    ($($text:tt)*) => { $crate::speak::err(format_args!("{}\n", format_args!($($text)*))) };
}

static UNSAID: OnceLock<io::Error> = OnceLock::new();

/// To standard output. A reader that went away has read what it wanted.
pub fn out(text: Arguments<'_>) {
    let mut out = io::stdout().lock();
    match out.write_fmt(text).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            UNSAID.get_or_init(|| error);
        }
        _ => {}
    }
}

/// To standard error; where that cannot be written there is nobody to tell.
pub fn err(text: Arguments<'_>) {
    let _ = io::stderr().lock().write_fmt(text);
}

/// Why standard output is not whole.
pub fn unsaid() -> Option<&'static io::Error> {
    UNSAID.get()
}
