//! The virtual controllers' process, and the way to them.

use std::net::TcpListener;
use std::process::{Child, Command, Stdio};

use bt_hci::controller::ExternalController;
use bt_hci_serial::SerialTransport;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embedded_io_adapters::tokio_1::FromTokio;
use tokio::net::TcpStream;
use tokio::net::tcp::{OwnedReadHalf, OwnedWriteHalf};

use crate::{DeviceClock, monotonic_us};

bt_hci::cmd! {
    /// Nordic's switch of reports of anchor points.
    ReportAnchors(VENDOR_SPECIFIC, 0x11f) { Params = bool; Return = (); }
}

/// A controller over TCP.
pub type Controller = ExternalController<
    SerialTransport<NoopRawMutex, FromTokio<OwnedReadHalf>, FromTokio<OwnedWriteHalf>>,
    10,
>;

/// The Python that has bumble: `SHISEI_PYTHON`, else the one in target/venv.
pub fn python() -> String {
    let own = concat!(env!("CARGO_MANIFEST_DIR"), "/../../target/venv/bin/python");
    std::env::var("SHISEI_PYTHON").unwrap_or_else(|_| own.to_owned())
}

/// A script beside this crate.
pub fn script(name: &str) -> String {
    format!("{}/py/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// Virtual controllers, the receiver's first.
pub struct Controllers {
    child: Child,
    ports: Vec<u16>,
    /// Each device's clock, which is its controller's.
    pub clocks: Vec<DeviceClock>,
}

impl Controllers {
    /// Starts controllers for a receiver and some nodes, waits until they are there. `missed`: share of connection
    /// events; `jitter_us`: standard deviation of anchor points.
    pub fn start(nodes: usize, missed: f64, jitter_us: f64) -> Self {
        let base_us = monotonic_us();
        let clock = |k: usize| DeviceClock {
            base_us,
            offset_us: 1e6 + 3e5 * k as f64,
            // The receiver's, then the nodes': the first differs from it by 40 ppm.
            ppm: if k == 0 { -20.0 } else { 20.0 - 15.0 * (k as f64 - 1.0) },
        };
        let clocks: Vec<DeviceClock> = (0..=nodes).map(clock).collect();
        let ports = free_ports(nodes + 1);
        let mut command = Command::new(python());
        command.arg(script("controllers.py"));
        command.args([base_us.to_string(), missed.to_string(), jitter_us.to_string()]);
        for (port, clock) in ports.iter().zip(&clocks) {
            command.arg(format!("{port}:{}:{}", clock.offset_us, clock.ppm));
        }
        let child = begin(&mut command);
        Controllers { child, ports, clocks }
    }

    /// Connects to a controller: 0 is the receiver's.
    pub async fn open(&self, k: usize) -> Controller {
        open(self.ports[k]).await
    }

    /// The port of a controller.
    pub fn port(&self, k: usize) -> u16 {
        self.ports[k]
    }
}

impl Drop for Controllers {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Starts a script and waits for its word `ready`.
pub fn begin(command: &mut Command) -> Child {
    use std::io::{BufRead, BufReader};
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("Python starts");
    let mut line = String::new();
    BufReader::new(child.stdout.take().expect("it is piped")).read_line(&mut line).expect("it says a line");
    assert_eq!(line.trim(), "ready");
    child
}

/// Ports that are free now.
pub fn free_ports(count: usize) -> Vec<u16> {
    let listeners: Vec<TcpListener> =
        (0..count).map(|_| TcpListener::bind("127.0.0.1:0").expect("a port is free")).collect();
    listeners.iter().map(|listener| listener.local_addr().expect("it is bound").port()).collect()
}

/// Connects to a controller at a port.
pub async fn open(port: u16) -> Controller {
    let stream = TcpStream::connect(("127.0.0.1", port)).await.expect("the controller listens");
    stream.set_nodelay(true).expect("TCP");
    let (read, write) = stream.into_split();
    ExternalController::new(SerialTransport::new(FromTokio::new(read), FromTokio::new(write)))
}
