//! A Bluetooth link as far as it matters here: connection events every 15 ms, each with a counter and an anchor point
//! on both sides; some are missed; what is not heard for two seconds is gone; a node that is not connected advertises.

use super::{Lab, Settings};

/// Connection interval, s.
const INTERVAL_S: f64 = 0.015;
/// Without a word for so long, both sides give up, s.
const SUPERVISION_S: f64 = 2.0;
/// The link layer's reason for it.
const REASON_TIMEOUT: u8 = 0x08;
/// From advertisement to advertisement, s.
const ADVERTISING_S: f64 = 0.1;
/// From an advertisement to subscribed notifications, s.
const CONNECTING_S: f64 = 0.3;
/// Packets an event.
const PACKETS_MAX: usize = 4;
/// Airtime of a packet and its acknowledgement, s.
const PACKET_S: f64 = 1.2e-3;

/// The state of one link.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Link {
    /// The node advertises.
    #[default]
    Idle,
    /// Connecting to a place, done at a time.
    Connecting { place: usize, done_s: f64 },
    /// Connected.
    Up { place: usize, event: u16, next_s: f64, heard_s: f64, node_gone: bool },
}

impl Link {
    /// The node restarted: its side of the link is gone, the receiver does not know yet.
    pub fn vanish(&mut self) {
        match self {
            Link::Up { node_gone, .. } => *node_gone = true,
            Link::Idle | Link::Connecting { .. } => *self = Link::Idle,
        }
    }
}

impl Settings {
    fn out_of_reach(&self, node: usize, time_s: f64) -> bool {
        self.outages
            .iter()
            .any(|outage| outage.node == node && (outage.from_s..outage.to_s).contains(&time_s))
    }
}

impl Lab {
    /// What happens on a node's link up to now.
    pub(super) fn link(&mut self, index: usize, now_s: f64) {
        let reach = !self.settings.out_of_reach(index, now_s);
        let now_us = self.receiver_clock.us(now_s);
        match self.nodes[index].link {
            Link::Idle => {
                let slot = (now_s / ADVERTISING_S) as u64;
                let before = ((now_s - super::STEP_S) / ADVERTISING_S) as u64;
                if !reach || slot == before {
                    return;
                }
                let address = [index as u8 + 1, 0, 0, 0, 0xee, 0xff];
                if let Some(place) = self.receiver.advertised(address, now_us) {
                    self.nodes[index].link = Link::Connecting { place, done_s: now_s + CONNECTING_S };
                }
            }
            Link::Connecting { place, done_s } => {
                if !reach {
                    self.nodes[index].link = Link::Idle;
                } else if now_s >= done_s {
                    self.places.iter_mut().filter(|at| **at == Some(index)).for_each(|at| *at = None);
                    self.places[place] = Some(index);
                    let node = &mut self.nodes[index];
                    node.board.link_changed = Some(true);
                    node.link =
                        Link::Up { place, event: 0, next_s: now_s + 0.003, heard_s: now_s, node_gone: false };
                    let (name, status) = (node.device.name().to_owned(), node.device.status());
                    self.receiver.connected(place, &name, &status, now_us);
                }
            }
            Link::Up { .. } => self.events(index, now_s),
        }
    }

    /// Connection events up to now.
    fn events(&mut self, index: usize, now_s: f64) {
        while let Link::Up { place, event, next_s, heard_s, node_gone } = self.nodes[index].link {
            if next_s > now_s {
                return;
            }
            let node = &mut self.nodes[index];
            let missed = node.random.uniform() < self.settings.missed;
            let heard = !missed && !node_gone && !self.settings.out_of_reach(index, next_s);
            let jitter = self.settings.anchor_jitter_us;
            let own_us = self.receiver_clock.exact_us(next_s) + jitter * node.random.normal();
            self.receiver.anchor(place, event, own_us.max(0.0) as u64);
            if heard {
                let clock = node.clock();
                let node_us = clock.exact_us(next_s) + jitter * node.random.normal();
                node.board.anchor = Some((event, node_us.max(0.0) as u64));
                let kept = node.device.calibration().and_then(|kept| kept.encode().ok());
                self.receiver.calibration(place, kept.as_ref().map_or(&[][..], |bytes| bytes));
                for k in 0..PACKETS_MAX {
                    let Some(packet) = node.board.radio.pop_front() else { break };
                    // The task that takes it runs when it gets to it.
                    let late_s = 150e-6 - 80e-6 * shisei_core::math::ln(1.0 - node.random.uniform());
                    let arrival_s = next_s + (k as f64 + 1.0) * PACKET_S + late_s;
                    self.receiver.notification(place, &packet, self.receiver_clock.us(arrival_s));
                }
            }
            let heard_s = if heard { next_s } else { heard_s };
            if next_s - heard_s > SUPERVISION_S {
                if !node_gone {
                    node.board.link_changed = Some(false);
                    // What the radio had taken is lost with the link.
                    node.board.radio.clear();
                }
                node.link = Link::Idle;
                self.receiver.disconnected(place, REASON_TIMEOUT, self.receiver_clock.us(next_s));
                return;
            }
            node.link = Link::Up {
                place,
                event: event.wrapping_add(1),
                next_s: next_s + INTERVAL_S,
                heard_s,
                node_gone,
            };
        }
    }
}
