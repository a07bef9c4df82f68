//! `shisei record`: a receiver's data into a recording that survives whatever happens.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{self, IsTerminal, Read, Write};
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use serde_json::json;
use shisei_core::Lang;
use shisei_hub::live::input::unix_ns;
use shisei_hub::session::command_bytes;
use shisei_hub::{Item, Session, Take};
use shisei_wire::message::{Command, EventCode};

use super::ports::{Feed, Got, no_port, stop_flag};
use crate::args_live::Record;
use crate::fail::{Failure, Outcome, say};

/// How a file in MCAP begins.
const MCAP: &[u8; 6] = b"\x89MCAP0";
/// What was recorded is handed to the system at least this often: it survives the end of this process.
const FLUSH: Duration = Duration::from_millis(400);
/// And after so many bytes of the port: a file's come faster than any receiver's.
const FLUSH_BYTES: usize = 32_768;
/// The state is shown this often.
const SHOW: Duration = Duration::from_millis(500);
/// Without a frame for so long, that is said.
const SILENCE: Duration = Duration::from_secs(3);
/// From one try to open a lost port to the next.
const RETRY: Duration = Duration::from_millis(300);

/// Runs the command.
pub fn run(args: &Record, lang: Lang) -> Outcome<()> {
    if is_recording(&args.port) {
        let port = &args.port;
        return Err(Failure::input(say(
            lang,
            format!(
                "{port} is a recording already; give it to shisei orient, or play it with shisei live --replay {port}"
            ),
            format!(
                "{port} はすでに記録です。shisei orient に指定するか、shisei live --replay {port} で再生してください"
            ),
        )));
    }
    let mut feed = Feed::open(&args.port).map_err(|error| no_port(&args.port, &error, lang))?;
    let file = create(&args.output, args.force, lang)?;
    let handle = file.try_clone().map_err(|error| unwritable(args, &error, lang))?;
    let mut recorder = Recorder::new(args, file, lang).map_err(|error| unwritable(args, &error, lang))?;
    let outcome = recorder.work(&mut feed);
    let (written, readable) = (recorder.take.written(), recorder.session.counts().frames > 0);
    let summary = recorder.end();
    if let Err(error) = outcome.and(summary.1) {
        // What was not written whole is no use to anybody.
        let _ = handle.set_len(written);
        return Err(unwritable(args, &error, lang));
    }
    eprint!("{}", summary.0);
    if args.json {
        println!("{}", summary.2);
    }
    if !readable {
        let (port, output) = (&args.port, args.output.display());
        return Err(Failure::condition(say(
            lang,
            format!("{port}: nothing readable came; is it a receiver's? What came is kept in {output}"),
            format!(
                "{port}：読めるデータが届きませんでした。レシーバのポートか確認してください。届いたバイト列は {output} に残っています"
            ),
        )));
    }
    Ok(())
}

/// True for a file in MCAP: no bytes of a port.
fn is_recording(port: &str) -> bool {
    let is_file = Path::new(port).is_file();
    let mut head = [0; MCAP.len()];
    is_file && File::open(port).and_then(|mut file| file.read_exact(&mut head)).is_ok() && head == *MCAP
}

fn create(path: &Path, force: bool, lang: Lang) -> Outcome<File> {
    let opened = if force { File::create(path) } else { File::create_new(path) };
    opened.map_err(|error| {
        let shown = path.display();
        Failure::input(if error.kind() == io::ErrorKind::AlreadyExists {
            say(
                lang,
                format!("{shown} exists; name another file with -o, or overwrite it with --force"),
                format!("{shown} は既に存在します。-o で別名にするか、--force で上書きしてください"),
            )
        } else {
            say(
                lang,
                format!("{shown} could not be written ({error}); choose another place with -o"),
                format!("{shown} に書き込めませんでした ({error})。-o で別の場所を指定してください"),
            )
        })
    })
}

fn unwritable(args: &Record, error: &io::Error, lang: Lang) -> Failure {
    let shown = args.output.display();
    Failure::input(say(
        lang,
        format!("{shown}: {error}; recording ended here, what was recorded before is kept"),
        format!("{shown}：{error}。記録はここで終了しました。それまでの記録は残っています"),
    ))
}

/// Has the receiver tell its nodes' names and calibrations now, not within ten seconds: a short recording has them, too,
/// behind each node's first sample.
fn ask(feed: &mut Feed) {
    if let Some(bytes) = command_bytes(Command::Ask) {
        // a port that is gone says so when it is read
        let _ = feed.write(&bytes);
    }
}

struct Recorder<'a> {
    args: &'a Record,
    lang: Lang,
    take: Take<File>,
    session: Session,
    items: Vec<Item>,
    names: BTreeMap<u8, String>,
    /// Nodes with samples, and whether there is one more since the receiver was asked.
    sampled: BTreeSet<u8>,
    heard_anew: bool,
    tagged: u64,
    interruptions: u32,
    shown_lines: usize,
    /// Bytes since the last that were handed to the system.
    unflushed: usize,
}

impl<'a> Recorder<'a> {
    fn new(args: &'a Record, file: File, lang: Lang) -> io::Result<Self> {
        let port = args.port.rsplit(['/', '\\']).next().unwrap_or("port");
        Ok(Recorder {
            args,
            lang,
            take: Take::new(file, port)?,
            session: Session::default(),
            items: Vec::new(),
            names: BTreeMap::new(),
            sampled: BTreeSet::new(),
            heard_anew: false,
            tagged: 0,
            interruptions: 0,
            shown_lines: 0,
            unflushed: 0,
        })
    }

    /// Until Ctrl-C, the time is up, the file ends or the port stays away. An error is the recording's.
    fn work(&mut self, feed: &mut Feed) -> io::Result<()> {
        let stop = stop_flag();
        let started = Instant::now();
        let (mut flushed, mut shown, mut heard) = (started, started, started);
        let mut silence_said = false;
        let mut bytes = [0; 4096];
        let over = |started: Instant, for_s: Option<f64>| {
            stop.load(Ordering::Relaxed)
                || for_s.is_some_and(|for_s| started.elapsed().as_secs_f64() >= for_s)
        };
        while !over(started, self.args.for_s) {
            match feed.read(&mut bytes) {
                Ok(Got::Bytes(count)) => {
                    let frames = self.session.counts().frames;
                    self.bytes(bytes.get(..count).unwrap_or_default())?;
                    if std::mem::take(&mut self.heard_anew) {
                        ask(feed);
                    }
                    if self.session.counts().frames > frames {
                        heard = Instant::now();
                        silence_said = false;
                    }
                }
                Ok(Got::Nothing) => {}
                Ok(Got::End) => break,
                Err(error) => {
                    self.gone(&error)?;
                    let Some(back) = self.wait(|| over(started, self.args.for_s)) else { break };
                    *feed = back;
                    self.tell("the port is back", "ポートが復帰しました");
                    self.take.note("PortBack", unix_ns())?;
                    heard = Instant::now();
                }
            }
            if flushed.elapsed() >= FLUSH || self.unflushed >= FLUSH_BYTES {
                self.take.flush()?;
                self.unflushed = 0;
                flushed = Instant::now();
            }
            if heard.elapsed() >= SILENCE && !silence_said {
                silence_said = true;
                self.tell(
                    "nothing readable comes from the port; is it a receiver's?",
                    "ポートから読めるデータが来ません。レシーバのポートか確認してください",
                );
            }
            if shown.elapsed() >= SHOW {
                shown = Instant::now();
                self.show();
            }
        }
        Ok(())
    }

    fn bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        let now_ns = unix_ns();
        self.unflushed += bytes.len();
        self.take.raw(bytes, now_ns)?;
        self.session.push(bytes, &mut self.items);
        self.keep(now_ns)
    }

    fn keep(&mut self, now_ns: u64) -> io::Result<()> {
        for item in std::mem::take(&mut self.items) {
            self.take.item(&item, self.session.time_s(), now_ns)?;
            self.hear(&item);
        }
        Ok(())
    }

    /// What the user should know at once.
    fn hear(&mut self, item: &Item) {
        match item {
            Item::Sample(sample) => {
                self.tagged += u64::from(sample.frame.is_some());
                self.heard_anew |= self.sampled.insert(sample.node);
            }
            Item::Node(node) => {
                self.names.insert(node.node, node.name.clone());
            }
            Item::Rebooted(node, _) => {
                let who = self.who(*node);
                self.tell(&format!("{who} started anew"), &format!("{who} が再起動しました"));
            }
            Item::Lost(node, count) => {
                let who = self.who(*node);
                self.tell(
                    &format!("{who}: {count} samples lost"),
                    &format!("{who}：{count} サンプルが欠落しました"),
                );
            }
            Item::ReceiverRebooted(_) => self.tell("the receiver started anew", "レシーバが再起動しました"),
            Item::Event(event) => {
                let who = self.who(event.node);
                let value = event.value;
                match event.code {
                    EventCode::Connected => {
                        self.tell(&format!("{who} is connected"), &format!("{who} が接続しました"));
                    }
                    EventCode::Disconnected => {
                        self.tell(&format!("{who} is gone"), &format!("{who} が切断しました"));
                    }
                    EventCode::GateUp => {
                        self.tell("the recording gate rose", "記録ゲートが立ち上がりました");
                    }
                    EventCode::GateDown => {
                        self.tell("the recording gate fell", "記録ゲートが立ち下がりました");
                    }
                    EventCode::PulsesStopped => self.tell("no more pulses", "パルスが止まりました"),
                    EventCode::Dropped => self.tell(
                        &format!("{value} frames dropped because this computer read too slowly"),
                        &format!("読み取りが遅く、{value} フレームが破棄されました"),
                    ),
                    _ => {}
                }
            }
            Item::Calibration(..) | Item::CountedAnew | Item::Hello(_) | Item::Garbage => {}
        }
    }

    fn who(&self, node: u8) -> String {
        match self.names.get(&node).filter(|name| !name.is_empty()) {
            Some(name) => format!("{node} ({name})"),
            None => say(self.lang, format!("node {node}"), format!("ノード {node}")),
        }
    }

    fn gone(&mut self, error: &io::Error) -> io::Result<()> {
        self.interruptions += 1;
        self.take.note("PortGone", unix_ns())?;
        self.take.flush()?;
        self.tell(
            &format!("the port is gone ({error}); waiting for it, nothing recorded is lost"),
            &format!("ポートが切断されました ({error})。復帰を待っています。記録済みのデータは失われません"),
        );
        Ok(())
    }

    fn wait(&self, over: impl Fn() -> bool) -> Option<Feed> {
        let since = Instant::now();
        while !over() && since.elapsed().as_secs_f64() < self.args.wait {
            if let Ok(feed) = Feed::open(&self.args.port) {
                return Some(feed);
            }
            std::thread::sleep(RETRY);
        }
        None
    }

    /// A line that stays.
    fn tell(&mut self, en: &str, ja: &str) {
        self.wipe();
        eprintln!("{:9.3} s  {}", self.session.time_s(), say(self.lang, en, ja));
    }

    /// The lines that change, in a terminal.
    fn show(&mut self) {
        if !io::stderr().is_terminal() {
            return;
        }
        self.wipe();
        let mut lines = Vec::new();
        for node in self.session.nodes() {
            let Some(quality) = self.session.quality(node) else { continue };
            let clock = quality.clock_residual_s.map_or("–".into(), |s| format!("{:.1} µs", s * 1e6));
            let (who, rate, lost) = (self.who(node), quality.rate_hz, quality.lost);
            lines.push(say(
                self.lang,
                format!("{who}: {rate:6.1} Hz, lost {lost}, clock {clock}, {:+.1} ppm", quality.skew_ppm),
                format!("{who}：{rate:6.1} Hz、欠落 {lost}、時計 {clock}、{:+.1} ppm", quality.skew_ppm),
            ));
        }
        let pulse = self.session.newest_pulse().map_or("–".into(), |(count, _)| count.to_string());
        let kilobytes = self.take.written() / 1000;
        lines.push(say(
            self.lang,
            format!("pulse {pulse}, {kilobytes} kB; Ctrl-C stops"),
            format!("パルス {pulse}、{kilobytes} kB。Ctrl-C で終了します"),
        ));
        eprint!("{}", lines.join("\n") + "\n");
        let _ = io::stderr().flush();
        self.shown_lines = lines.len();
    }

    fn wipe(&mut self) {
        for _ in 0..std::mem::take(&mut self.shown_lines) {
            eprint!("\x1b[1A\x1b[2K");
        }
    }

    /// Ends the recording; the text and the JSON that say what is in it.
    fn end(mut self) -> (String, io::Result<()>, serde_json::Value) {
        self.wipe();
        self.session.finish(&mut self.items);
        let kept = self.keep(unix_ns());
        let counts = self.session.counts();
        let nodes: Vec<_> = self
            .session
            .nodes()
            .filter_map(|node| self.session.quality(node).map(|quality| (node, quality)))
            .map(|(node, quality)| {
                json!({
                    "node": node,
                    "name": self.names.get(&node).cloned().unwrap_or_default(),
                    "samples": quality.samples,
                    "lost": quality.lost,
                    "clock_residual_us": quality.clock_residual_s.map(|s| s * 1e6),
                    "skew_ppm": quality.skew_ppm,
                })
            })
            .collect();
        let path = self.args.output.display().to_string();
        let (samples, lost, garbage, tagged) = (counts.samples, counts.lost, counts.garbage, self.tagged);
        let value = json!({
            "output": path, "samples": samples, "tagged": tagged, "lost": lost, "pulses": counts.pulses,
            "unreadable_frames": garbage, "interruptions": self.interruptions, "nodes": nodes,
        });
        let text = say(
            self.lang,
            format!(
                "{samples} samples, {tagged} with a frame; {lost} lost, {garbage} unreadable frames\n→ {path}\n"
            ),
            format!(
                "{samples} サンプル (うちフレーム番号付き {tagged})、欠落 {lost}、読めないフレーム {garbage}\n→ {path}\n"
            ),
        );
        let finished = kept.and_then(|()| self.take.finish());
        (text, finished, value)
    }
}
