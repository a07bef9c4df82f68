//! `xll-register add|remove PATH`: enters shisei.xll in, or takes it out of, the list of add-ins that Excel opens.
//!
//! Excel reads OPEN, OPEN1, OPEN2 … under HKCU\Software\Microsoft\Office\<version>\Excel\Options until one is
//! missing, so the list must stay dense. Other add-ins keep their order, their data and their type. The
//! installer runs this; it needs no rights beyond the user's.
#![cfg_attr(windows, allow(unsafe_code))] // the registry's interface is C

#[cfg(windows)]
mod registry;

/// Versions of Excel with this list: 2016 and later share 16.0.
#[cfg(windows)]
const VERSIONS: [&str; 2] = ["16.0", "15.0"];

fn main() -> std::process::ExitCode {
    #[cfg(windows)]
    {
        let arguments: Vec<String> = std::env::args().skip(1).collect();
        let done = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
            ["add", path] => registry::change(&VERSIONS, path, true),
            ["remove", path] => registry::change(&VERSIONS, path, false),
            _ => {
                eprintln!("xll-register add|remove PATH");
                return std::process::ExitCode::from(2);
            }
        };
        match done {
            Ok(()) => std::process::ExitCode::SUCCESS,
            Err(reason) => {
                eprintln!("{reason}");
                std::process::ExitCode::FAILURE
            }
        }
    }
    #[cfg(not(windows))]
    {
        eprintln!("xll-register changes the Windows registry and runs on Windows only");
        std::process::ExitCode::from(2)
    }
}
