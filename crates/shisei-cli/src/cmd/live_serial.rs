//! A receiver's serial port as an input of `shisei live`.

use std::io;
use std::sync::Arc;
use std::time::Duration;

use shisei_hub::live::{Input, Kind, Level, Line, Note, State, What};

use super::ports::{Feed, Got};

/// From one try to open a lost port to the next.
const RETRY: Duration = Duration::from_millis(300);

fn unopened(port: &str, error: &io::Error) -> Note {
    Note::new(
        Level::Warning,
        format!(
            "{port}: {error}; waiting for it. Is the receiver plugged in, and no other program using the port? `shisei devices` lists ports"
        ),
        format!(
            "{port}：{error}。使用できるまで待ちます。レシーバの接続と、他のプログラムがポートを使用していないことを確認してください。ポートの一覧は shisei devices で表示できます"
        ),
    )
}

/// What ports are called in a recording: the ends of their names, and where two have the same end, a number.
pub fn recorded_names(ports: &[String]) -> Vec<Arc<str>> {
    let mut names: Vec<Arc<str>> = Vec::new();
    for port in ports {
        let end = port.rsplit(['/', '\\']).next().filter(|end| !end.is_empty()).unwrap_or("port");
        let numbered = (2..).map(|number| format!("{end}-{number}"));
        let free =
            std::iter::once(end.to_owned()).chain(numbered).find(|name| !names.iter().any(|n| **n == **name));
        names.push(free.unwrap_or_default().into());
    }
    names
}

/// A receiver on a serial port, waited for when it is gone.
pub struct Serial {
    /// The port.
    pub port: String,
    /// As it is called in a recording.
    pub name: Arc<str>,
}

impl Input for Serial {
    fn name(&self) -> String {
        self.port.clone()
    }

    fn kind(&self) -> Kind {
        Kind::Serial
    }

    fn run(self: Box<Self>, line: &Line) {
        let name = &self.name;
        let mut bytes = [0; 4096];
        let mut told = false;
        while !line.stopped() {
            let mut feed = match Feed::open(&self.port) {
                Ok(feed) => feed,
                Err(error) => {
                    // once: of a port that was there it is said that it is gone
                    if !std::mem::replace(&mut told, true) {
                        line.note(name, unopened(&self.port, &error));
                    }
                    std::thread::sleep(RETRY);
                    continue;
                }
            };
            told = true;
            line.give(name, What::State(State::Connected));
            // what was to be said before nobody waits for any more
            while line.outbox().fetch().is_some() {}
            while !line.stopped() {
                // a port that is gone says so when it is read
                while let Some((_, bytes)) = line.outbox().fetch() {
                    let _ = feed.write(&bytes);
                }
                match feed.read(&mut bytes) {
                    Ok(Got::Bytes(count)) => {
                        let bytes = bytes.get(..count).unwrap_or_default().to_vec();
                        if !line.give(name, What::Serial(bytes)) {
                            return;
                        }
                    }
                    Ok(Got::Nothing) => {}
                    Ok(Got::End) => {
                        line.give(name, What::End);
                        return;
                    }
                    Err(_) => {
                        line.give(name, What::State(State::Lost));
                        break;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two receivers' bytes under one name could not be taken apart again.
    #[test]
    fn ports_have_names_of_their_own_in_a_recording() {
        let names = |ports: &[&str]| {
            let ports: Vec<String> = ports.iter().map(|&port| port.to_owned()).collect();
            recorded_names(&ports).iter().map(ToString::to_string).collect::<Vec<_>>()
        };
        assert_eq!(names(&["/dev/ttyACM0", "/dev/ttyACM1", "COM3"]), ["ttyACM0", "ttyACM1", "COM3"]);
        assert_eq!(
            names(&["/a/port", "/b/port", "/b/port", "port-2"]),
            ["port", "port-2", "port-3", "port-2-2"]
        );
        assert_eq!(names(&["/", r"\\.\COM10"]), ["port", "COM10"]);
    }
}
