//! The page, the stream and the status over HTTP, in a thread of its own.
//!
//! Only this machine can reach it unless an address is given, and then only who has the token. So it is with the
//! viewer; outputs of the hub have addresses of their own and know no token. Who has no business
//! here costs little: connections that have not asked for anything are few and the oldest of them go first, clients
//! are few, their messages small and rare, and what they are sent is always the newest, so that a slow one holds up
//! nobody.

mod assets;
mod client;
mod request;

use std::collections::VecDeque;
use std::io;
use std::net::{SocketAddr, TcpListener as StdListener};
use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use std::time::Duration;

use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio::task::AbortHandle;
use tokio::time::timeout;

use crate::live::Board;
use crate::live::input::ToHub;
use crate::own_address::to_ask_for;

/// Connections that have not asked for anything yet.
const WAITING_MAX: usize = 128;
/// After a failed accept.
const PAUSE: Duration = Duration::from_millis(50);
/// At the end clients are told, and waited for no longer than this; looked after so often.
const FAREWELL: Duration = Duration::from_millis(500);
const LOOK: Duration = Duration::from_millis(5);
/// Bytes of the token.
const TOKEN_BYTES: usize = 16;

/// Where to listen and who may come.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Access {
    /// The address.
    pub address: SocketAddr,
    /// What clients must know; none: this machine only.
    pub token: Option<String>,
}

impl Access {
    /// This machine only; port 0 is any that is free.
    pub fn loopback(port: u16) -> Self {
        Access { address: SocketAddr::from(([127, 0, 0, 1], port)), token: None }
    }

    /// An address that others can reach, with a fresh token; without one where only this machine can reach it.
    pub fn listen(address: SocketAddr) -> io::Result<Self> {
        if address.ip().is_loopback() {
            return Ok(Access { address, token: None });
        }
        let mut bytes = [0; TOKEN_BYTES];
        getrandom::fill(&mut bytes).map_err(io::Error::other)?;
        let token = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Access { address, token: Some(token) })
    }
}

/// The server while it runs; it ends when this is dropped.
#[derive(Debug)]
pub struct Serving {
    /// Where it listens, its port known.
    pub access: Access,
    stop: watch::Sender<bool>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Serving {
    /// What to open in a browser, here or on another computer.
    pub fn url(&self) -> String {
        let address = to_ask_for(self.access.address);
        match &self.access.token {
            Some(token) => format!("http://{address}/?token={token}"),
            None => format!("http://{address}/"),
        }
    }
}

impl Drop for Serving {
    fn drop(&mut self) {
        self.stop.send_replace(true);
        if let Some(thread) = self.thread.take() {
            // a panic of the server has been printed already
            let _ = thread.join();
        }
    }
}

/// What every connection needs.
#[derive(Debug)]
struct Shared {
    access: Access,
    board: Arc<Board>,
    to_hub: SyncSender<ToHub>,
    stop: watch::Receiver<bool>,
}

/// Begins to serve what is on the board; clients' wishes go to the hub.
pub fn start(access: Access, board: Arc<Board>, to_hub: SyncSender<ToHub>) -> io::Result<Serving> {
    let listener = StdListener::bind(access.address)?;
    listener.set_nonblocking(true)?;
    let access = Access { address: listener.local_addr()?, ..access };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
    let (stop, stopped) = watch::channel(false);
    let shared = Arc::new(Shared { access: access.clone(), board, to_hub, stop: stopped });
    let thread = std::thread::spawn(move || runtime.block_on(accept(listener, shared)));
    Ok(Serving { access, stop, thread: Some(thread) })
}

async fn accept(listener: StdListener, shared: Arc<Shared>) {
    let Ok(listener) = TcpListener::from_std(listener) else { return };
    let mut waiting: VecDeque<AbortHandle> = VecDeque::new();
    let mut stop = shared.stop.clone();
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            _ = stop.changed() => break,
        };
        let Ok((stream, _)) = accepted else {
            tokio::time::sleep(PAUSE).await;
            continue;
        };
        waiting.retain(|connection| !connection.is_finished());
        if waiting.len() >= WAITING_MAX
            && let Some(oldest) = waiting.pop_front()
        {
            oldest.abort();
        }
        let shared = Arc::clone(&shared);
        waiting.push_back(tokio::spawn(connection(stream, shared)).abort_handle());
    }
    drop(listener);
    let _ = timeout(FAREWELL, async {
        while shared.board.clients() > 0 {
            tokio::time::sleep(LOOK).await;
        }
    })
    .await;
}

/// A connection until it has said what it wants. An error is the other side's: nobody needs to hear of it.
async fn connection(mut stream: TcpStream, shared: Arc<Shared>) {
    if stream.set_nodelay(true).is_err() {
        return;
    }
    let Some(answer) = request::read(&mut stream, &shared.access).await else { return };
    match answer {
        request::Answer::Stream(key) => {
            // from here on it is a client, and no longer among those that wait
            tokio::spawn(client::serve(stream, key, shared));
        }
        request::Answer::Status => {
            let status = Arc::clone(&shared.board.status.borrow());
            request::reply(&mut stream, 200, "application/json; charset=utf-8", status.as_bytes()).await;
        }
        request::Answer::Asset(asset) => {
            request::reply(&mut stream, 200, asset.kind, asset.bytes).await;
        }
        request::Answer::Refused(code, why) => {
            request::reply(&mut stream, code, "text/plain; charset=utf-8", why.as_bytes()).await;
        }
    }
}
