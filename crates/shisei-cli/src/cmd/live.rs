//! `shisei live`: sensors and cameras together, in a browser.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::net::{IpAddr, Ipv4Addr, SocketAddr, SocketAddrV4};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use serde_json::{Value, json};
use shisei_core::Lang;
use shisei_core::frames::Axes;
use shisei_hub::live::{
    Door, Input, Mounting, Note, Output, Parts, Refused, Replay, Settings, run as run_hub,
};
use shisei_hub::natnet::{COMMAND_PORT, Client, DATA_PORT, NatNetOut};
use shisei_hub::osc::OscOut;
use shisei_hub::server::{Access, Serving};

use super::live_serial::{Serial, recorded_names};
use super::ports::stop_flag;
use crate::args_live::Live;
use crate::demo::Demo;
use crate::fail::{Failure, Outcome, say};
use crate::output::unwritable;

/// Where the viewer is unless said otherwise.
const PORT: u16 = 7399;
/// Where recordings go that are begun in the viewer.
const RECORDING: &str = "shisei-live.mcap";
/// Seed of the demonstration.
const SEED: u64 = 7;

/// Runs the command.
pub fn run(args: Live, lang: Lang) -> Outcome<()> {
    if !(0.0..=1000.0).contains(&args.speed) {
        return Err(wrong("--speed", lang));
    }
    if !(0.5..=3.0).contains(&args.lag) {
        return Err(wrong("--lag", lang));
    }
    let parts = Parts {
        inputs: inputs(&args, lang)?,
        outputs: outputs(&args, lang)?,
        access: access(args.listen.as_deref(), lang)?,
        known: known(&args.alignment, lang)?,
    };
    let pairs = args.pair.iter().map(|pair| {
        let (node, body) = pair.split_once('=').ok_or_else(|| wrong("--pair", lang))?;
        Ok((node.to_owned(), body.to_owned()))
    });
    let pairs: Vec<(String, String)> = pairs.collect::<Outcome<_>>()?;
    let twice =
        |(k, (node, _)): (usize, &(String, String))| pairs[..k].iter().any(|(earlier, _)| earlier == node);
    if pairs.iter().enumerate().any(twice) {
        return Err(Failure::input(say(
            lang,
            "a node is in two --pair; say one body for each",
            "--pair に同じノードが 2 回あります。ノードごとに剛体を 1 つ指定してください",
        )));
    }
    if args.for_s.is_some_and(|seconds| !(seconds.is_finite() && seconds >= 0.0)) {
        return Err(wrong("--for", lang));
    }
    let settings = Settings {
        axes: if args.demo { Axes::YUp } else { Axes::from_name(&args.optical_axes).unwrap_or(Axes::YUp) },
        pairs,
        record: args.record.clone().unwrap_or_else(|| PathBuf::from(RECORDING)),
        record_now: args.record.is_some(),
        lag_s: args.lag,
        demo: args.demo,
        lang,
        ..Settings::default()
    };
    let stop = stop_flag();
    if let Some(for_s) = args.for_s {
        let stop = Arc::clone(&stop);
        std::thread::spawn(move || {
            std::thread::sleep(Duration::from_secs_f64(for_s.min(1e6)));
            stop.store(true, Ordering::Relaxed);
        });
    }
    let (address, file) = (parts.access.address, settings.record.clone());
    let mut door = Terminal { as_json: args.json, lang };
    let hub = run_hub(settings, parts, &stop, &mut door).map_err(|refused| match refused {
        Refused::Address(error) if error.kind() == io::ErrorKind::AddrInUse => Failure::input(say(
            lang,
            format!("{address} is in use already, perhaps by another shisei live; choose another port with --listen 127.0.0.1:PORT"),
            format!("{address} は、別の shisei live などで使われています。--listen 127.0.0.1:PORT で別のポートを指定してください"),
        )),
        Refused::Address(error) => Failure::input(say(
            lang,
            format!("{address}: {error}; choose another port with --listen 127.0.0.1:PORT"),
            format!("{address}：{error}。--listen 127.0.0.1:PORT で別のポートを指定してください"),
        )),
        Refused::Recording(error) => Failure::input(unwritable(&file.display().to_string(), &error, lang)),
    })?;
    let (lost, samples) = hub.losses();
    eprintln!(
        "{}",
        say(lang, format!("{samples} samples, {lost} lost"), format!("{samples} サンプル、欠落 {lost}"))
    );
    match hub.unrecorded().first() {
        None => Ok(()),
        Some(file) => Err(Failure::input(say(
            lang,
            format!("{file} is not complete; what is said above tells why"),
            format!("{file} の記録は不完全です。理由は上の表示をご覧ください"),
        ))),
    }
}

/// What is said where the command was given; the viewer says the same.
struct Terminal {
    as_json: bool,
    lang: Lang,
}

impl Door for Terminal {
    fn serving(&mut self, serving: &Serving) {
        let url = serving.url();
        if self.as_json {
            println!("{}", json!({"url": url, "token": serving.access.token}));
        } else {
            println!("{url}");
        }
        // nobody reads it: the viewer works all the same
        let _ = io::stdout().flush();
        eprintln!(
            "{}",
            say(
                self.lang,
                "open this address in a browser; Ctrl-C stops",
                "このアドレスをブラウザで開いてください。Ctrl-C で終了します",
            )
        );
    }

    fn note(&mut self, note: &Note) {
        eprintln!("{}", note.sentence(self.lang));
    }
}

fn wrong(what: &str, lang: Lang) -> Failure {
    Failure::input(say(
        lang,
        format!("{what}: out of range or not of the form that --help shows"),
        format!("{what} が範囲外か、--help に示す形式と異なります"),
    ))
}

fn access(listen: Option<&str>, lang: Lang) -> Outcome<Access> {
    let Some(listen) = listen else { return Ok(Access::loopback(PORT)) };
    let address = listen
        .parse::<SocketAddr>()
        .or_else(|_| listen.parse::<IpAddr>().map(|ip| SocketAddr::from((ip, PORT))))
        .map_err(|_| wrong("--listen", lang))?;
    Access::listen(address).map_err(|error| Failure::input(format!("{listen}: {error}")))
}

fn outputs(args: &Live, lang: Lang) -> Outcome<Vec<Box<dyn Output>>> {
    let mut outputs: Vec<Box<dyn Output>> = Vec::new();
    if let Some(text) = &args.natnet_out {
        let (address, command, data) = natnet_address(text).ok_or_else(|| wrong("--natnet-out", lang))?;
        if args.natnet_multicast.is_some_and(|group| !group.is_multicast()) {
            return Err(wrong("--natnet-multicast", lang));
        }
        let out = match args.natnet_multicast {
            Some(group) => NatNetOut::multicast(address, command, SocketAddrV4::new(group, data), Axes::YUp),
            None => NatNetOut::new(address, command, data, Axes::YUp),
        };
        let out = out.map_err(|error| {
            Failure::input(say(
                lang,
                format!("--natnet-out {text}: {error}; does Motive run here? choose other ports: {address}:1520:1521"),
                format!("--natnet-out {text}：{error}。このコンピュータで Motive が動作している場合は、別のポートを指定してください (例 {address}:1520:1521)"),
            ))
        })?;
        outputs.push(Box::new(out));
    }
    if let Some(text) = &args.osc {
        let to = text.parse().map_err(|_| wrong("--osc", lang))?;
        let out = OscOut::new(to).map_err(|error| Failure::input(format!("--osc {text}: {error}")))?;
        outputs.push(Box::new(out));
    }
    Ok(outputs)
}

/// What is given out is asked for again: the same poses would go round and round.
fn feeds_itself(natnet: &str, natnet_out: &str) -> bool {
    let asked = natnet
        .parse::<SocketAddrV4>()
        .or_else(|_| natnet.parse::<Ipv4Addr>().map(|ip| SocketAddrV4::new(ip, COMMAND_PORT)));
    let given = natnet_address(natnet_out).map(|(address, command, _)| SocketAddrV4::new(address, command));
    given.is_some_and(|given| asked == Ok(given))
}

/// `ADDR` or `ADDR:CMD:DATA`.
fn natnet_address(text: &str) -> Option<(Ipv4Addr, u16, u16)> {
    let mut parts = text.split(':');
    let address = parts.next()?.parse().ok()?;
    let ports: Vec<u16> = parts.map(|part| part.parse().ok()).collect::<Option<_>>()?;
    match ports.as_slice() {
        [] => Some((address, COMMAND_PORT, DATA_PORT)),
        [command, data] => Some((address, *command, *data)),
        _ => None,
    }
}

fn inputs(args: &Live, lang: Lang) -> Outcome<Vec<Box<dyn Input>>> {
    let mut inputs: Vec<Box<dyn Input>> = Vec::new();
    if args.demo {
        inputs.push(Box::new(Demo::new(SEED)));
    }
    for (port, name) in args.serial.iter().zip(recorded_names(&args.serial)) {
        inputs.push(Box::new(Serial { port: port.clone(), name }));
    }
    if let Some(host) = &args.natnet {
        if args.natnet_out.as_ref().is_some_and(|out| feeds_itself(host, out)) {
            return Err(Failure::input(say(
                lang,
                format!(
                    "--natnet {host} is what --natnet-out gives out itself; name Motive's address, or other ports to give out on"
                ),
                format!(
                    "--natnet {host} は --natnet-out の送信元と同じです。Motive のアドレスか、送信用の別のポートを指定してください"
                ),
            )));
        }
        inputs.push(Box::new(Client::new(host)));
    }
    for path in &args.replay {
        let unreadable = |error: io::Error| {
            let shown = path.display();
            let (en, ja) = match error.kind() {
                // the words of the decoder would help nobody
                io::ErrorKind::InvalidData | io::ErrorKind::UnexpectedEof => (
                    "there are no bytes of a receiver or of Motive in it, or it is damaged at its beginning"
                        .to_owned(),
                    "レシーバや Motive から届いたデータを含まないか、先頭が破損しています".to_owned(),
                ),
                _ => (error.to_string(), error.to_string()),
            };
            Failure::input(say(
                lang,
                format!("{shown}: {en}; a recording of shisei record or shisei live is expected"),
                format!("{shown}：{ja}。shisei record または shisei live の記録を指定してください"),
            ))
        };
        let file = std::fs::read(path).map_err(unreadable)?;
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        inputs.push(Box::new(Replay::new(&name, &file, args.speed).map_err(unreadable)?));
    }
    if inputs.is_empty() {
        return Err(Failure::input(say(
            lang,
            "nothing to show: give --serial PORT, --natnet HOST or --replay TAKE.mcap, or try --demo",
            "表示するデータがありません。--serial PORT、--natnet HOST、--replay TAKE.mcap を指定するか、--demo をお試しください",
        )));
    }
    Ok(inputs)
}

/// What `shisei fuse --json` found, by the bodies' names.
fn known(paths: &[PathBuf], lang: Lang) -> Outcome<BTreeMap<String, Mounting>> {
    let mut known = BTreeMap::new();
    for path in paths {
        let shown = path.display();
        let text = std::fs::read(path).map_err(|error| {
            let (en, ja) = (format!("{shown}: {error}"), format!("{shown}：{error}"));
            Failure::input(say(
                lang,
                en + "; name what shisei fuse --json printed",
                ja + "。shisei fuse --json の出力を指定してください",
            ))
        })?;
        let (name, mounting) = mounting(&text).ok_or_else(|| {
            Failure::input(say(
                lang,
                format!("{shown}: not what shisei fuse --json prints"),
                format!("{shown} は shisei fuse --json の出力ではありません"),
            ))
        })?;
        known.insert(name, mounting);
    }
    Ok(known)
}

fn mounting(text: &[u8]) -> Option<(String, Mounting)> {
    let value: Value = serde_json::from_slice(text).ok()?;
    Mounting::parse(&value)
}
