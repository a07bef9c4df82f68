//! Stands in for Excel: loads the XLL, registers, calls every function from several threads with Excel's own
//! values, frees the results, unloads. `xll_host.exe shisei.xll [rows]`; exits with 1 when something is wrong.
//!
//! Build it with `-C link-arg=…/xll_host.def`, so that it exports Excel's entry.
#![allow(unsafe_code)] // Excel's interface is C

#[cfg(windows)]
#[path = "xll_host/host.rs"]
mod host;
#[cfg(windows)]
#[path = "xll_host/tests.rs"]
mod tests;
#[cfg(windows)]
#[path = "../src/xl.rs"]
mod xl;

fn main() {
    #[cfg(windows)]
    std::process::exit(tests::run());
    #[cfg(not(windows))]
    eprintln!("this program stands in for Excel and runs on Windows only");
}
