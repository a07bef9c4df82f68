//! Which of this machine's addresses others see.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};

/// Addresses that nobody has (RFC 5737, RFC 3849): the way to them is the way to other networks.
const ANYWHERE_V4: IpAddr = IpAddr::V4(Ipv4Addr::new(192, 0, 2, 1));
const ANYWHERE_V6: IpAddr = IpAddr::V6(Ipv6Addr::new(0x2001, 0xdb8, 0, 0, 0, 0, 0, 1));
/// A port has to be named, and does not matter.
const PORT: u16 = 9;

/// This machine's address on the way to another: with several networks, the one that the other is on. None without a
/// way.
pub fn towards(other: SocketAddr) -> Option<IpAddr> {
    let any: IpAddr =
        if other.is_ipv4() { Ipv4Addr::UNSPECIFIED.into() } else { Ipv6Addr::UNSPECIFIED.into() };
    let socket = UdpSocket::bind((any, 0)).ok()?;
    // nothing is sent by that
    socket.connect(other).ok()?;
    socket.local_addr().ok().map(|own| own.ip())
}

/// An address to listen on, as somebody else would ask for it: one that stands for all of this machine's becomes the
/// one on the way to other networks, or without such a way the loopback's.
pub fn to_ask_for(listening: SocketAddr) -> SocketAddr {
    if !listening.ip().is_unspecified() {
        return listening;
    }
    let (anywhere, loopback): (_, IpAddr) = if listening.is_ipv4() {
        (ANYWHERE_V4, Ipv4Addr::LOCALHOST.into())
    } else {
        (ANYWHERE_V6, Ipv6Addr::LOCALHOST.into())
    };
    let own = towards(SocketAddr::new(anywhere, PORT)).unwrap_or(loopback);
    SocketAddr::new(own, listening.port())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_addresses_become_one_that_can_be_opened() {
        for all in ["0.0.0.0:7399", "[::]:7399"] {
            let all: SocketAddr = all.parse().unwrap();
            let one = to_ask_for(all);
            assert!(!one.ip().is_unspecified() && one.is_ipv4() == all.is_ipv4(), "{one}");
            assert_eq!(one.port(), 7399);
        }
        let one: SocketAddr = "192.168.1.5:80".parse().unwrap();
        assert_eq!(to_ask_for(one), one);
        assert_eq!(towards("127.0.0.1:80".parse().unwrap()), Some(Ipv4Addr::LOCALHOST.into()));
    }
}
