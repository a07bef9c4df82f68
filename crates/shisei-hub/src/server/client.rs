//! A client of the stream.

use std::sync::Arc;
use std::time::{Duration, Instant};

use futures_util::{SinkExt, StreamExt};
use socket2::SockRef;
use tokio::io::AsyncWriteExt;
use tokio::net::TcpStream;
use tokio::sync::broadcast::error::RecvError;
use tokio::time::timeout;
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::handshake::derive_accept_key;
use tokio_tungstenite::tungstenite::protocol::frame::coding::CloseCode;
use tokio_tungstenite::tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tokio_tungstenite::tungstenite::{Message, Utf8Bytes};

use super::{Shared, request};
use crate::live::Command;
use crate::live::board::{Board, Text};
use crate::live::hub::SHOW;
use crate::live::input::ToHub;

/// Clients at one time.
pub const CLIENTS_MAX: usize = 32;
/// Largest message of a client, bytes.
const MESSAGE_MAX: usize = 4096;
/// Messages a second of a client, and how many at once.
const MESSAGES_HZ: f64 = 20.0;
const MESSAGES_BURST: f64 = 40.0;
/// What waits in the system for a slow client, bytes: the newest poses are not far behind the rest.
const SEND_BUFFER: usize = 64 * 1024;
/// A client that takes nothing for so long is gone.
const PATIENCE: Duration = Duration::from_secs(5);

type Socket = WebSocketStream<TcpStream>;

/// A place among the clients, given back when dropped.
struct Place(Arc<Board>);

impl Drop for Place {
    fn drop(&mut self) {
        self.0.leave();
    }
}

/// Serves a client until it goes.
pub async fn serve(mut stream: TcpStream, key: String, shared: Arc<Shared>) {
    if !shared.board.enter(CLIENTS_MAX) {
        request::reply(&mut stream, 503, "text/plain; charset=utf-8", b"too many clients").await;
        return;
    }
    let _place = Place(Arc::clone(&shared.board));
    let head = format!(
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Accept: {}\r\n\r\n",
        derive_accept_key(key.as_bytes())
    );
    // without the smaller buffer a slow client only sees older poses
    let _ = SockRef::from(&stream).set_send_buffer_size(SEND_BUFFER);
    if !matches!(timeout(PATIENCE, stream.write_all(head.as_bytes())).await, Ok(Ok(()))) {
        return;
    }
    let config = WebSocketConfig::default()
        .read_buffer_size(MESSAGE_MAX)
        .write_buffer_size(0)
        .max_write_buffer_size(1024 * 1024)
        .max_message_size(Some(MESSAGE_MAX))
        .max_frame_size(Some(MESSAGE_MAX));
    let mut socket = WebSocketStream::from_raw_socket(stream, Role::Server, Some(config)).await;
    let end = talk(&mut socket, &shared).await;
    let frame = end.map(|(code, reason)| CloseFrame { code, reason: Utf8Bytes::from_static(reason) });
    // it may be gone already
    let _ = timeout(PATIENCE, socket.close(frame)).await;
}

/// Why a client is sent away; none: it went.
type End = Option<(CloseCode, &'static str)>;

async fn talk(socket: &mut Socket, shared: &Shared) -> End {
    let board = &shared.board;
    let (mut scene, mut poses, mut status) =
        (board.scene.subscribe(), board.poses.subscribe(), board.status.subscribe());
    let mut notes = board.notes.subscribe();
    let mut stop = shared.stop.clone();
    let mut allowance = Allowance { left: MESSAGES_BURST, at: Instant::now() };
    send(socket, &board.hello).await?;
    for first in [&mut scene, &mut status] {
        let text = Arc::clone(&first.borrow_and_update());
        send(socket, &text).await?;
    }
    let mut next = tokio::time::Instant::now();
    loop {
        tokio::select! {
            message = socket.next() => match message {
                Some(Ok(Message::Text(text))) => {
                    if !allowance.take() {
                        return Some((CloseCode::Policy, "too many messages"));
                    }
                    // what is not understood is passed over
                    if let Some(command) = Command::parse(&text) {
                        let _ = shared.to_hub.try_send(ToHub::Command(command));
                    }
                }
                Some(Ok(Message::Close(_))) | None => return None,
                Some(Ok(_)) => {
                    if !allowance.take() {
                        return Some((CloseCode::Policy, "too many messages"));
                    }
                }
                Some(Err(_)) => return Some((CloseCode::Protocol, "not understood")),
            },
            changed = scene.changed() => {
                changed.ok()?;
                let text = Arc::clone(&scene.borrow_and_update());
                send(socket, &text).await?;
            }
            changed = status.changed() => {
                changed.ok()?;
                let text = Arc::clone(&status.borrow_and_update());
                send(socket, &text).await?;
            }
            note = notes.recv() => match note {
                Ok(text) => send(socket, &text).await?,
                Err(RecvError::Lagged(_)) => {}
                Err(RecvError::Closed) => return None,
            },
            changed = async {
                tokio::time::sleep_until(next).await;
                poses.changed().await
            } => {
                changed.ok()?;
                next = tokio::time::Instant::now() + SHOW * 9 / 10;
                let text = Arc::clone(&poses.borrow_and_update());
                send(socket, &text).await?;
            }
            _ = stop.changed() => return Some((CloseCode::Away, "shisei live ends")),
        }
    }
}

/// Sends a text; none where the client does not take it.
async fn send(socket: &mut Socket, text: &Text) -> Option<()> {
    if text.is_empty() {
        return Some(());
    }
    let message = Message::Text(Utf8Bytes::from(&**text));
    timeout(PATIENCE, socket.send(message)).await.ok()?.ok()
}

/// How many messages a client may still send.
struct Allowance {
    left: f64,
    at: Instant,
}

impl Allowance {
    fn take(&mut self) -> bool {
        let now = Instant::now();
        self.left = (self.left + now.duration_since(self.at).as_secs_f64() * MESSAGES_HZ).min(MESSAGES_BURST);
        self.at = now;
        self.left -= 1.0;
        self.left >= 0.0
    }
}
