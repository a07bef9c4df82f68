//! `shisei devices`: serial ports, receivers and their nodes, and commands to nodes.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

use serde_json::json;
use shisei_core::Lang;
use shisei_hub::session::{NodeInfo, command_bytes};
use shisei_hub::{Item, Session, kept};
use shisei_wire::message::{Command, EventCode, Hello, NO_NODE, Settings};
use shisei_wire::packet::FilterKind;
use shisei_wire::{AccRange, Calibration, GyroRange};

use super::ports::{Feed, Got, no_port};
use crate::args_live::Devices;
use crate::calibration;
use crate::fail::{Failure, Outcome, say};

/// How long a receiver may take to answer.
const PATIENCE: Duration = Duration::from_millis(2500);
/// Nodes are told in one go; so long after the first word there is no more.
const AFTER: Duration = Duration::from_millis(300);
/// How our receivers call themselves on USB.
const PRODUCT: &str = "shisei";

/// Runs the command.
pub fn run(args: &Devices, lang: Lang) -> Outcome<()> {
    let commands = commands(args, lang)?;
    let listed = serialport::available_ports().unwrap_or_default();
    let mut ports = Vec::new();
    let mut ours: Vec<String> = args.ports.clone();
    for port in &listed {
        let usb = match &port.port_type {
            serialport::SerialPortType::UsbPort(usb) => Some(usb),
            _ => None,
        };
        let product = usb.and_then(|usb| usb.product.clone()).unwrap_or_default();
        if args.ports.is_empty() && product.contains(PRODUCT) {
            ours.push(port.port_name.clone());
        }
        let id = usb.map(|usb| format!("{:04x}:{:04x}", usb.vid, usb.pid));
        ports.push(json!({"port": port.port_name, "usb": id, "product": product}));
    }
    if ours.is_empty() && !commands.is_empty() {
        return Err(Failure::input(say(
            lang,
            "no receiver was found; name its port",
            "レシーバが見つかりません。ポートを指定してください",
        )));
    }
    if args.ports.is_empty() {
        one_is_meant(&ours, &commands, lang)?;
    }
    let mut receivers = Vec::new();
    for name in &ours {
        receivers.push((name.clone(), ask(name, &commands, lang)?));
    }
    if args.json {
        let told: Vec<_> = receivers.iter().map(|(name, answer)| answer.json(name)).collect();
        println!("{}", json!({"ports": ports, "receivers": told}));
        return Ok(());
    }
    if args.ports.is_empty() {
        for port in &ports {
            let text = |key: &str| port[key].as_str().unwrap_or_default().to_owned();
            println!("{}  {} {}", text("port"), text("usb"), text("product"));
        }
        if ports.is_empty() {
            println!("{}", say(lang, "no serial ports", "シリアルポートがありません"));
        }
    }
    for (name, answer) in &receivers {
        print!("{}", answer.text(name, lang));
    }
    Ok(())
}

/// Refused: a command that changes a node, while there are several receivers with nodes of the same numbers.
fn one_is_meant(found: &[String], commands: &[Command<'_>], lang: Lang) -> Outcome<()> {
    if found.len() < 2 || !commands.iter().any(changes) {
        return Ok(());
    }
    let found = found.join(", ");
    Err(Failure::input(say(
        lang,
        format!("several receivers were found ({found}); name the port of the one whose node is meant"),
        format!(
            "レシーバが複数見つかりました ({found})。対象のノードがあるレシーバのポートを指定してください"
        ),
    )))
}

/// A node is another after the command.
fn changes(command: &Command<'_>) -> bool {
    match command {
        Command::Ask | Command::Identify(_) => false,
        Command::Calibrate(_) | Command::Rename(..) | Command::Configure(..) | Command::Keep(..) => true,
    }
}

#[derive(Default)]
struct Answer {
    hello: Option<Hello>,
    nodes: Vec<NodeInfo>,
    /// What nodes keep.
    kept: BTreeMap<u8, Option<Calibration>>,
    refused: bool,
}

impl Answer {
    fn json(&self, port: &str) -> serde_json::Value {
        let version = |firmware: [u8; 3]| firmware.map(|part| part.to_string()).join(".");
        let nodes: Vec<_> = self
            .nodes
            .iter()
            .map(|node| {
                json!({
                    "node": node.node, "name": node.name, "address": node.address, "connected": node.connected,
                    "battery_mv": node.battery_mv, "firmware": version(node.firmware),
                    "temperature_c": node.temperature_centi_c.map(|t| f64::from(t) / 100.0),
                    "calibration": self.kept_by(node.node).map(kept::json),
                })
            })
            .collect();
        json!({
            "port": port, "firmware": self.hello.map(|hello| version(hello.firmware)),
            "dropped_frames": self.hello.map(|hello| hello.dropped), "gate_seen": self.hello.map(|h| h.gate_seen),
            "nodes": nodes,
        })
    }

    fn kept_by(&self, node: u8) -> Option<&Calibration> {
        self.kept.get(&node).and_then(Option::as_ref)
    }

    /// The first node that a command meant and that does not keep what it was to.
    fn not_keeping(&self, commands: &[Command<'_>]) -> Option<u8> {
        commands.iter().find_map(|command| {
            let Command::Keep(meant, wanted) = command else { return None };
            let meant = |node: &&NodeInfo| node.connected && (*meant == NO_NODE || *meant == node.node);
            let mut nodes = self.nodes.iter().filter(meant).map(|node| node.node);
            nodes.find(|node| self.kept.get(node) != Some(wanted))
        })
    }

    fn text(&self, port: &str, lang: Lang) -> String {
        let Some(hello) = self.hello else { return String::new() };
        let [major, minor, patch] = hello.firmware;
        let dropped = hello.dropped;
        let mut text = say(
            lang,
            format!("{port}: receiver {major}.{minor}.{patch}, {dropped} frames dropped\n"),
            format!("{port}：レシーバ {major}.{minor}.{patch}、破棄 {dropped} フレーム\n"),
        );
        let comma = say(lang, ", ", "、");
        for node in &self.nodes {
            let state = if node.connected {
                say(lang, "connected", "接続中")
            } else {
                say(lang, "away", "未接続")
            };
            let temperature = node
                .temperature_centi_c
                .map(|t| format!("{comma}{:.1} °C", f64::from(t) / 100.0))
                .unwrap_or_default();
            let calibrated = self.kept_by(node.node).map_or_else(String::new, |kept| {
                let id = kept.id();
                say(lang, format!(", calibrated ({id:04x})"), format!("、キャリブレーション済み ({id:04x})"))
            });
            let volts = f64::from(node.battery_mv) / 1000.0;
            text += &format!(
                "  {} {} {}  {state}{comma}{volts:.2} V{temperature}{calibrated}\n",
                node.node, node.address, node.name
            );
        }
        if self.nodes.is_empty() {
            text += &say(lang, "  no nodes\n", "  ノードはありません\n");
        }
        text
    }
}

/// Sends the commands, asks, and hears the answer.
fn ask(name: &str, commands: &[Command<'_>], lang: Lang) -> Outcome<Answer> {
    let failed = |error: &io::Error| no_port(name, error, lang);
    let mut feed = Feed::open(name).map_err(|error| failed(&error))?;
    if let Feed::Port(_) = &feed {
        for command in commands.iter().chain([&Command::Ask]) {
            let bytes = command_bytes(*command).ok_or_else(|| wrong_command(lang))?;
            feed.write(&bytes).map_err(|error| failed(&error))?;
        }
    }
    let (mut session, mut answer, mut items) = (Session::default(), Answer::default(), Vec::new());
    let asked = Instant::now();
    let mut heard: Option<Instant> = None;
    let mut bytes = [0; 4096];
    let open = |answer: &Answer, heard: Option<Instant>| {
        heard.is_none_or(|at| at.elapsed() < AFTER) || answer.not_keeping(commands).is_some()
    };
    while asked.elapsed() < PATIENCE && open(&answer, heard) {
        match feed.read(&mut bytes).map_err(|error| failed(&error))? {
            Got::Bytes(count) => session.push(bytes.get(..count).unwrap_or_default(), &mut items),
            Got::Nothing => {}
            Got::End => break,
        }
        for item in items.drain(..) {
            match item {
                Item::Hello(hello) => {
                    answer.hello = Some(hello);
                    heard.get_or_insert_with(Instant::now);
                }
                Item::Node(node) => {
                    answer.nodes.retain(|known| known.node != node.node);
                    answer.nodes.push(node);
                }
                Item::Calibration(node, calibration) => {
                    answer.kept.insert(node, calibration);
                }
                Item::Event(event) if event.code == EventCode::BadCommand => answer.refused = true,
                _ => {}
            }
        }
    }
    if answer.hello.is_none() {
        return Err(Failure::condition(say(
            lang,
            format!("{name} does not answer like a receiver; is it the right port?"),
            format!("{name} からレシーバの応答がありません。ポートを確認してください"),
        )));
    }
    if answer.refused {
        return Err(Failure::condition(say(
            lang,
            format!("{name}: the receiver did not take the command; is that node connected?"),
            format!("{name}：コマンドが受け付けられませんでした。そのノードが接続中か確認してください"),
        )));
    }
    if let Some(node) = answer.not_keeping(commands) {
        return Err(Failure::condition(say(
            lang,
            format!(
                "{name}: node {node} did not take the calibration; its firmware, or the receiver's, may be older than this shisei: flash both anew"
            ),
            format!(
                "{name}：ノード {node} にキャリブレーションを保存できませんでした。ノードかレシーバのファームウェアがこの shisei より古い可能性があります。書き込み直してください"
            ),
        )));
    }
    answer.nodes.sort_by_key(|node| node.node);
    Ok(answer)
}

fn wrong_command(lang: Lang) -> Failure {
    Failure::input(say(
        lang,
        "a command to a node is wrong: NODE is a number from 0 or all; a name has at most 20 bytes; settings are \
         FILTER,N,DPS,G, e.g. 0=estimator,4,2000,8; a calibration is CAL.json or none",
        "ノードへのコマンドが正しくありません。NODE は 0 からの番号または all、名前は 20 バイト以内、設定は FILTER,N,DPS,G (例: 0=estimator,4,2000,8)、キャリブレーションは CAL.json または none です",
    ))
}

fn commands(args: &Devices, lang: Lang) -> Outcome<Vec<Command<'_>>> {
    let wrong = || wrong_command(lang);
    let mut commands = read_commands(args).ok_or_else(wrong)?;
    if let Some(text) = &args.store_calibration {
        let (node, file) = text.split_once('=').ok_or_else(wrong)?;
        let node = place(node).ok_or_else(wrong)?;
        let calibration =
            if file == "none" { None } else { Some(calibration_for_node(Path::new(file), lang)?) };
        commands.push(Command::Keep(node, calibration));
    }
    Ok(commands)
}

/// A calibration file as a node keeps it.
pub fn calibration_for_node(path: &Path, lang: Lang) -> Outcome<Calibration> {
    let calibration = kept::for_node(&calibration::read(path, lang)?.calibration);
    if calibration.is_sound() {
        return Ok(calibration);
    }
    let shown = path.display();
    Err(Failure::input(say(
        lang,
        format!(
            "{shown}: a node does not keep this: the accelerometer's bias may be 5 m/s² at most, the gyroscope's 0.5 rad/s, and the matrices no further than 0.25 from the identity; calibrate again, in m/s² and rad/s and the sensor's own axes"
        ),
        format!(
            "{shown}：ノードに保存できない値です。バイアスは加速度 5 m/s²、ジャイロ 0.5 rad/s 以内、行列は単位行列から 0.25 以内が必要です。m/s²、rad/s、センサ自身の軸でキャリブレーションをやり直してください"
        ),
    )))
}

fn read_commands(args: &Devices) -> Option<Vec<Command<'_>>> {
    let mut commands = Vec::new();
    if let Some(node) = &args.identify {
        commands.push(Command::Identify(place(node)?));
    }
    if let Some(node) = &args.recalibrate {
        commands.push(Command::Calibrate(place(node)?));
    }
    if let Some(text) = &args.rename {
        let (node, name) = text.split_once('=')?;
        commands.push(Command::Rename(place(node)?, name));
    }
    if let Some(text) = &args.configure {
        let (node, settings) = text.split_once('=')?;
        let parts: Vec<&str> = settings.split(',').collect();
        let [filter, batch, dps, g] = *parts else { return None };
        let filter = match filter {
            "complementary" => FilterKind::Complementary,
            "estimator" => FilterKind::Estimator,
            _ => return None,
        };
        let (dps, g) = (dps.parse::<u16>().ok()?, g.parse::<u16>().ok()?);
        let gyro_range = GyroRange::ALL.into_iter().find(|range| range.degrees_per_second() == dps)?;
        let acc_range = AccRange::ALL.into_iter().find(|range| range.g() == g)?;
        let settings = Settings { filter, batch: batch.parse().ok()?, gyro_range, acc_range };
        commands.push(Command::Configure(place(node)?, settings));
    }
    Some(commands)
}

fn place(text: &str) -> Option<u8> {
    if text == "all" { Some(NO_NODE) } else { text.parse().ok().filter(|place| *place < NO_NODE) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_is_changed_only_where_its_receiver_is_known() {
        let ports = ["/dev/ttyACM0".to_owned(), "/dev/ttyACM1".to_owned()];
        let asked = |ports: &[String], command| one_is_meant(ports, &[command], Lang::En);
        for command in [
            Command::Calibrate(0),
            Command::Rename(0, "left"),
            Command::Configure(0, Settings::default()),
            Command::Keep(NO_NODE, None),
        ] {
            assert!(asked(&ports[..1], command).is_ok() && asked(&ports, command).is_err(), "{command:?}");
        }
        assert!(
            asked(&ports, Command::Identify(NO_NODE)).is_ok() && one_is_meant(&ports, &[], Lang::Ja).is_ok()
        );
    }
}
