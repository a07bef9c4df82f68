//! A request's head: what is wanted, and whether it may be had.

use std::net::{IpAddr, SocketAddr};
use std::time::Duration;

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::time::timeout;

use super::Access;
use super::assets::{Asset, find};

/// Largest head, bytes, and how many fields it may have.
const HEAD_MAX: usize = 8192;
const FIELDS_MAX: usize = 64;
/// A head must be there, and an answer taken, within this time.
const PATIENCE: Duration = Duration::from_secs(5);

/// What to answer.
#[derive(Clone, Debug)]
pub enum Answer {
    /// The stream, for a WebSocket of this key.
    Stream(String),
    /// The status.
    Status,
    /// A file of the viewer.
    Asset(Asset),
    /// Code and reason.
    Refused(u16, &'static str),
}

/// Reads a head; none where the other side went away, was too slow, or spoke no HTTP.
pub async fn read(stream: &mut TcpStream, access: &Access) -> Option<Answer> {
    let mut head = Vec::with_capacity(1024);
    let reading = async {
        loop {
            let mut part = [0; 1024];
            let count = stream.read(&mut part).await.ok().filter(|count| *count > 0)?;
            head.extend_from_slice(part.get(..count)?);
            match answer(&head, access) {
                Parsed::Done(answer) => return Some(answer),
                Parsed::More if head.len() < HEAD_MAX => {}
                Parsed::More => return Some(Answer::Refused(431, "too large")),
                Parsed::Wrong => return Some(Answer::Refused(400, "not HTTP")),
            }
        }
    };
    timeout(PATIENCE, reading).await.ok().flatten()
}

enum Parsed {
    Done(Answer),
    More,
    Wrong,
}

fn answer(head: &[u8], access: &Access) -> Parsed {
    let mut fields = [httparse::EMPTY_HEADER; FIELDS_MAX];
    let mut request = httparse::Request::new(&mut fields);
    match request.parse(head) {
        Ok(httparse::Status::Complete(_)) => {}
        Ok(httparse::Status::Partial) => return Parsed::More,
        Err(_) => return Parsed::Wrong,
    }
    let field = |name: &str| {
        let mut found = request.headers.iter().filter(|field| field.name.eq_ignore_ascii_case(name));
        let first = found.next().and_then(|field| std::str::from_utf8(field.value).ok());
        // a field that comes twice is one that somebody tries something with
        if found.next().is_some() { None } else { first }
    };
    let target = request.path.unwrap_or_default();
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    Parsed::Done(if request.method == Some("GET") {
        decide(path, query, access, &field)
    } else {
        Answer::Refused(405, "only GET")
    })
}

fn decide<'a>(path: &str, query: &str, access: &Access, field: &impl Fn(&str) -> Option<&'a str>) -> Answer {
    // another site's name that leads to this address is not ours
    let host = field("host").unwrap_or_default();
    if access.token.is_none() && !is_this_machine(host, access.address) {
        return Answer::Refused(403, "open it as http://127.0.0.1 or http://localhost");
    }
    if let Some(asset) = find(path) {
        return Answer::Asset(asset);
    }
    if !matches!(path, "/stream" | "/status") {
        return Answer::Refused(404, "there is no such page");
    }
    if let Some(token) = &access.token {
        let given = query.split('&').find_map(|pair| pair.strip_prefix("token=")).unwrap_or_default();
        if !same(given.as_bytes(), token.as_bytes()) {
            return Answer::Refused(403, "open the address with the token that shisei live printed");
        }
    }
    // programs have no origin; pages of other sites have another
    if field("origin").is_some_and(|origin| origin.strip_prefix("http://") != Some(host)) {
        return Answer::Refused(403, "this page is of another site");
    }
    if path == "/status" {
        return Answer::Status;
    }
    let has = |name: &str, word: &str| {
        field(name).is_some_and(|value| value.split(',').any(|one| one.trim().eq_ignore_ascii_case(word)))
    };
    let upgrade = has("upgrade", "websocket") && has("connection", "upgrade");
    match field("sec-websocket-key").filter(|key| upgrade && key.len() <= 64) {
        Some(key) if field("sec-websocket-version") == Some("13") => Answer::Stream(key.to_owned()),
        _ => Answer::Refused(426, "a WebSocket is expected here"),
    }
}

/// A host's name as this machine calls itself, or the address itself, with its port.
fn is_this_machine(host: &str, address: SocketAddr) -> bool {
    let (name, given) = match host.rsplit_once(':') {
        Some((name, given)) if !host.ends_with(']') => (name, given.parse().ok()),
        _ => (host, Some(80)),
    };
    let ip = match address.ip() {
        IpAddr::V4(ip) => ip.to_string(),
        IpAddr::V6(ip) => format!("[{ip}]"),
    };
    given == Some(address.port())
        && ["localhost", "127.0.0.1", "[::1]", &ip].iter().any(|own| own.eq_ignore_ascii_case(name))
}

/// Equal, in a time that does not tell where they differ.
fn same(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |all, (x, y)| all | (x ^ y)) == 0
}

/// Sends an answer and closes.
pub async fn reply(stream: &mut TcpStream, code: u16, kind: &str, body: &[u8]) {
    let reason = match code {
        200 => "OK",
        400 => "Bad Request",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        426 => "Upgrade Required",
        431 => "Request Header Fields Too Large",
        _ => "Service Unavailable",
    };
    let head = format!(
        "HTTP/1.1 {code} {reason}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nConnection: close\r\n\
         Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
         X-Frame-Options: DENY\r\nContent-Security-Policy: default-src 'self'; connect-src 'self' ws: wss:; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n\r\n",
        body.len()
    );
    // the other side may go when it likes
    let _ = timeout(PATIENCE, async {
        stream.write_all(head.as_bytes()).await?;
        stream.write_all(body).await?;
        stream.shutdown().await
    })
    .await;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(head: &str, token: Option<&str>) -> (u16, bool) {
        ask_at(Access { token: token.map(str::to_owned), ..Access::loopback(7399) }, head)
    }

    fn ask_at(access: Access, head: &str) -> (u16, bool) {
        match answer(head.replace('\n', "\r\n").as_bytes(), &access) {
            Parsed::Done(Answer::Refused(code, _)) => (code, false),
            Parsed::Done(Answer::Stream(_)) => (101, true),
            Parsed::Done(_) => (200, false),
            Parsed::More => (100, false),
            Parsed::Wrong => (400, false),
        }
    }

    fn stream(host: &str, origin: &str, query: &str) -> String {
        let origin = if origin.is_empty() { String::new() } else { format!("Origin: {origin}\n") };
        format!(
            "GET /stream{query} HTTP/1.1\nHost: {host}\n{origin}Connection: keep-alive, Upgrade\nUpgrade: websocket\n\
             Sec-WebSocket-Version: 13\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\n\n"
        )
    }

    #[test]
    fn own_page_and_programs_may_others_may_not() {
        assert_eq!(ask(&stream("127.0.0.1:7399", "", ""), None).0, 101);
        assert_eq!(ask(&stream("localhost:7399", "http://localhost:7399", ""), None).0, 101);
        assert_eq!(ask(&stream("[::1]:7399", "http://[::1]:7399", ""), None).0, 101);
        assert_eq!(ask(&stream("localhost:7399", "http://evil.example", ""), None).0, 403);
        assert_eq!(ask(&stream("localhost:7399", "https://localhost:7399", ""), None).0, 403);
        assert_eq!(ask(&stream("localhost:7399", "null", ""), None).0, 403);
        // a name of another site that leads here
        assert_eq!(ask(&stream("evil.example:7399", "http://evil.example:7399", ""), None).0, 403);
        assert_eq!(ask(&stream("localhost:80", "", ""), None).0, 403);
        assert_eq!(ask("GET / HTTP/1.1\n\n", None).0, 403);
    }

    #[test]
    fn the_address_that_is_printed_is_served() {
        for host in ["127.0.0.2:7399", "[::1]:7399"] {
            let address = host.parse().unwrap();
            let asked = |head: &str| ask_at(Access { address, token: None }, head).0;
            assert_eq!(asked(&stream(host, &format!("http://{host}"), "")), 101, "{host}");
            assert_eq!(asked(&stream("127.0.0.3:7399", "", "")), 403);
        }
        assert_eq!(ask(&stream("127.0.0.2:7399", "", ""), None).0, 403);
    }

    #[test]
    fn the_token_opens_and_nothing_else_does() {
        let host = "192.168.1.5:7399";
        assert_eq!(ask(&stream(host, "http://192.168.1.5:7399", "?token=abc"), Some("abc")).0, 101);
        assert_eq!(ask(&stream(host, "", "?a=1&token=abc"), Some("abc")).0, 101);
        for query in ["", "?token=", "?token=ab", "?token=abd", "?token=abcd", "?xtoken=abc"] {
            assert_eq!(ask(&stream(host, "", query), Some("abc")).0, 403, "{query}");
        }
        assert_eq!(ask(&stream(host, "http://evil.example", "?token=abc"), Some("abc")).0, 403);
        assert_eq!(ask("GET /status HTTP/1.1\nHost: a\n\n", Some("abc")).0, 403);
        assert_eq!(ask("GET /status?token=abc HTTP/1.1\nHost: a\n\n", Some("abc")).0, 200);
    }

    #[test]
    fn what_is_no_request_is_refused() {
        let host = "Host: localhost:7399\n";
        assert_eq!(ask(&format!("GET / HTTP/1.1\n{host}\n"), None).0, 200);
        assert_eq!(ask(&format!("POST / HTTP/1.1\n{host}\n"), None).0, 405);
        assert_eq!(ask(&format!("GET /../etc/passwd HTTP/1.1\n{host}\n"), None).0, 404);
        assert_eq!(ask(&format!("GET /stream HTTP/1.1\n{host}\n"), None).0, 426);
        assert_eq!(ask(&format!("GET / HTTP/1.1\n{host}{host}\n"), None).0, 403);
        assert_eq!(ask("\u{0}\u{1}nonsense\n\n", None).0, 400);
        assert_eq!(ask("GET / HTTP/1.1\nHost: loc", None).0, 100);
    }
}
