//! `shisei simulate lab`: a receiver's serial port without a receiver.

use std::path::Path;

use shisei_core::Lang;
use shisei_hub::Session;
use shisei_twin::lab::{Lab, Movement, Outage, Settings};

use super::devices::calibration_for_node;
use crate::args_live::{Lab as LabArgs, MovementName, Simulate, Simulated};
use crate::fail::{Failure, Outcome, say};
use crate::ours::head;
use crate::output::{Kind, Writer};

/// How long a file of bytes is unless asked for otherwise, s.
const FILE_S: f64 = 60.0;
/// Time from one look at the port to the next, s.
const LOOK_S: f64 = 0.005;

/// Runs the command.
pub fn run(args: &Simulate, lang: Lang) -> Outcome<()> {
    let Simulated::Lab(args) = &args.what;
    let settings = settings(args, lang)?;
    match &args.output {
        Some(path) => to_file(path, settings, args.for_s.unwrap_or(FILE_S), lang),
        None => port::offer(settings, args.for_s, lang),
    }
}

fn settings(args: &LabArgs, lang: Lang) -> Outcome<Settings> {
    let wrong = |what: &str| {
        Failure::input(say(
            lang,
            format!("{what}: out of range or not of the form that --help shows"),
            format!("{what} が範囲外か、--help に示す形式と異なります"),
        ))
    };
    let check = |good: bool, what: &str| if good { Ok(()) } else { Err(wrong(what)) };
    check((1..=6).contains(&args.nodes), "--nodes")?;
    check((1.0..=1000.0).contains(&args.camera_rate), "--camera-rate")?;
    check((0.0..1.0).contains(&args.missed), "--missed")?;
    check((0.0..=1000.0).contains(&args.jitter), "--jitter")?;
    check((0.0..=500.0).contains(&args.skew), "--skew")?;
    check(args.gate.is_none_or(|s| (0.0..1e6).contains(&s)), "--gate")?;
    check(args.for_s.is_none_or(|s| (0.0..=1e6).contains(&s)), "--for")?;
    let numbers = |text: &str| -> Option<Vec<f64>> {
        text.split(':').map(|part| part.parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0)).collect()
    };
    let mut outages = Vec::new();
    for text in &args.outage {
        let parts = numbers(text).unwrap_or_default();
        let &[node, from_s, to_s] = parts.as_slice() else { return Err(wrong("--outage")) };
        check(node < args.nodes as f64 && from_s <= to_s, "--outage")?;
        outages.push(Outage { node: node as usize, from_s, to_s });
    }
    let mut reboots = Vec::new();
    for text in &args.reboot {
        let parts = numbers(text).unwrap_or_default();
        let &[node, at_s] = parts.as_slice() else { return Err(wrong("--reboot")) };
        check(node < args.nodes as f64, "--reboot")?;
        reboots.push((node as usize, at_s));
    }
    let mut calibrations = Vec::new();
    for text in &args.calibrations {
        let Some((node, path)) = text.split_once('=') else { return Err(wrong("--calibration")) };
        let node: usize = node.parse().map_err(|_| wrong("--calibration"))?;
        check(node < args.nodes, "--calibration")?;
        calibrations.push((node, calibration_for_node(Path::new(path), lang)?));
    }
    Ok(Settings {
        movement: match args.movement {
            MovementName::Free => Movement::Free,
            MovementName::Poses => Movement::Poses,
        },
        calibrations,
        nodes: args.nodes,
        seed: args.seed,
        camera_hz: args.camera_rate,
        gate_s: args.gate,
        missed: args.missed,
        anchor_jitter_us: args.jitter,
        skew_ppm: args.skew,
        outages,
        reboots,
        ..Settings::default()
    })
}

fn to_file(path: &Path, settings: Settings, duration_s: f64, lang: Lang) -> Outcome<()> {
    let shown = path.display();
    if path.is_file() && !is_receivers(&head(path)) {
        return Err(Failure::input(say(
            lang,
            format!("{shown} exists and is no file of a receiver's bytes; name another file with -o"),
            format!("{shown} は既に存在し、レシーバのバイト列ではありません。-o で別名にしてください"),
        )));
    }
    let mut lab = Lab::new(settings);
    let (mut bytes, mut time_s) = (Vec::new(), 0.0);
    while time_s < duration_s {
        time_s += LOOK_S;
        lab.run_to(time_s);
        lab.serial(&mut bytes);
    }
    // what may not be overwritten has been refused above
    let writer = Writer::new(true, lang, []);
    writer.write(path, Kind::Bytes, |out| out.write_all(&bytes))?;
    eprintln!("→ {shown}");
    Ok(())
}

/// A file's beginning is what a receiver sends.
fn is_receivers(head: &[u8]) -> bool {
    let mut session = Session::default();
    session.push(head, &mut Vec::new());
    session.counts().frames > 0
}

#[cfg(unix)]
mod port {
    use std::io::{self, ErrorKind, Read, Write};
    use std::sync::atomic::Ordering;
    use std::time::{Duration, Instant};

    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
    use shisei_core::Lang;
    use shisei_twin::lab::{Lab, Settings};

    use super::LOOK_S;
    use crate::cmd::ports::stop_flag;
    use crate::fail::{Failure, Outcome, say};

    /// Offers a pseudo-terminal in real time and prints its name.
    pub fn offer(settings: Settings, for_s: Option<f64>, lang: Lang) -> Outcome<()> {
        serve(settings, for_s, lang).map_err(|error| {
            Failure::input(say(
                lang,
                format!("no pseudo-terminal ({error}); -o writes the bytes to a file instead"),
                format!("疑似端末を使用できません ({error})。-o でファイルに書き出せます"),
            ))
        })
    }

    fn serve(settings: Settings, for_s: Option<f64>, lang: Lang) -> io::Result<()> {
        let owner = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&owner)?;
        unlockpt(&owner)?;
        let name = ptsname(&owner, Vec::new())?.to_string_lossy().into_owned();
        // Kept open, so that a program that closes it does not end the laboratory.
        let user = std::fs::File::options().read(true).write(true).open(&name)?;
        let mut modes = tcgetattr(&user)?;
        modes.make_raw();
        tcsetattr(&user, OptionalActions::Now, &modes)?;
        rustix::io::ioctl_fionbio(&owner, true)?;
        let mut line = std::fs::File::from(owner);
        println!("{name}");
        io::stdout().flush()?;
        eprintln!(
            "{}",
            say(
                lang,
                format!("a receiver's port until Ctrl-C; try: shisei record {name} -o take.mcap"),
                format!("レシーバのポートです (Ctrl-C で終了)。例: shisei record {name} -o take.mcap"),
            )
        );
        let stop = stop_flag();
        let mut lab = Lab::new(settings);
        let started = Instant::now();
        let (mut waiting, mut commands) = (Vec::new(), [0; 256]);
        while !stop.load(Ordering::Relaxed) {
            let time_s = started.elapsed().as_secs_f64();
            if for_s.is_some_and(|for_s| time_s >= for_s) {
                break;
            }
            lab.run_to(time_s);
            match line.read(&mut commands) {
                Ok(count) => lab.command(commands.get(..count).unwrap_or_default()),
                Err(error) if quiet(&error) => {}
                Err(error) => return Err(error),
            }
            // The line takes what it can; the rest waits in the receiver, which drops whole frames.
            if waiting.is_empty() {
                lab.serial(&mut waiting);
            }
            match line.write(&waiting) {
                Ok(count) => {
                    waiting.drain(..count);
                }
                Err(error) if quiet(&error) => {}
                Err(error) => return Err(error),
            }
            std::thread::sleep(Duration::from_secs_f64(LOOK_S));
        }
        Ok(())
    }

    fn quiet(error: &io::Error) -> bool {
        matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
    }
}

#[cfg(not(unix))]
mod port {
    use shisei_core::Lang;
    use shisei_twin::lab::Settings;

    use crate::fail::{Failure, Outcome, say};

    /// There are no pseudo-terminals here.
    pub fn offer(_: Settings, _: Option<f64>, lang: Lang) -> Outcome<()> {
        Err(Failure::input(say(
            lang,
            "this system has no pseudo-terminals; -o writes the bytes to a file, which `shisei record` reads",
            "このシステムには疑似端末がありません。-o でファイルに書き出すと、shisei record で読めます",
        )))
    }
}
