//! A node's radio.

use core::cell::{Cell, RefCell};

use bt_hci::cmd::SyncCmd;
use bt_hci::event::Vendor;
use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::channel::Channel;
use embassy_time::{Duration, Timer};
use heapless::Vec;
use shisei_device::node::Node;
use shisei_wire::calibration::{CALIBRATION_BYTES, Calibration};
use shisei_wire::gatt::{
    CALIBRATION, COMMAND_MAX, CONTROL, DATA, NAME_MAX, NOTIFICATION_MAX, SERVICE, STATUS,
};
use shisei_wire::message::Command;
use trouble_host::gap::GAP_SERVICE_ATTRIBUTE_COUNT;
use trouble_host::prelude::*;

use crate::anchor::Anchor;
use crate::{Controller, Stopped};

/// Packets that the radio has taken and not yet sent.
const OUTGOING: usize = 4;
/// Bytes of [`Node::status`]; the name follows.
const STATUS_FIXED: usize = 9;
/// Longest state.
const STATUS_MAX: usize = STATUS_FIXED + NAME_MAX;

type Status = Vec<u8, STATUS_MAX>;
type Kept = Vec<u8, CALIBRATION_BYTES>;

/// Between the radio and the node's board; what [`shisei_device::node::Board`] asks about the radio is answered here.
pub struct Radio {
    outgoing: Channel<NoopRawMutex, Vec<u8, NOTIFICATION_MAX>, OUTGOING>,
    commands: Channel<NoopRawMutex, Vec<u8, COMMAND_MAX>, 4>,
    link_changed: Cell<Option<bool>>,
    anchor: Cell<Option<Anchor>>,
    status: RefCell<Status>,
    kept: RefCell<Kept>,
    /// What `kept` is the bytes of: they are made anew only where it changed.
    calibration: Cell<Option<Calibration>>,
}

impl Default for Radio {
    fn default() -> Self {
        Radio {
            outgoing: Channel::new(),
            commands: Channel::new(),
            link_changed: Cell::new(None),
            anchor: Cell::new(None),
            status: RefCell::new(Vec::new()),
            kept: RefCell::new(Vec::new()),
            calibration: Cell::new(None),
        }
    }
}

impl Radio {
    /// A receiver subscribed (true) or is gone (false) since the last call.
    pub fn link_changed(&self) -> Option<bool> {
        self.link_changed.take()
    }

    /// A newer anchor point.
    pub fn anchor(&self) -> Option<Anchor> {
        self.anchor.take()
    }

    /// Takes a packet; false where there is no room now.
    pub fn notify(&self, packet: &[u8]) -> bool {
        Vec::from_slice(packet).is_ok_and(|packet| self.outgoing.try_send(packet).is_ok())
    }

    /// A written command: copies it into `out` and returns its length.
    pub fn command(&self, out: &mut [u8]) -> Option<usize> {
        let command = self.commands.try_receive().ok()?;
        out.get_mut(..command.len())?.copy_from_slice(&command);
        Some(command.len())
    }

    /// What is read from now on: state and name, and the calibration that is kept.
    pub fn set_status(&self, node: &Node) {
        let mut status = Status::new();
        // 9 + 20 bytes at most, which fit.
        let _ = status.extend_from_slice(&node.status());
        let _ = status.extend_from_slice(node.name().as_bytes());
        *self.status.borrow_mut() = status;
        let calibration = node.calibration().copied();
        if self.calibration.replace(calibration) != calibration {
            let kept = calibration.and_then(|kept| kept.encode().ok());
            *self.kept.borrow_mut() = kept.map(Kept::from).unwrap_or_default();
        }
    }

    fn name(&self) -> Vec<u8, NAME_MAX> {
        let status = self.status.borrow();
        Vec::from_slice(status.get(STATUS_FIXED..).unwrap_or_default()).unwrap_or_default()
    }
}

impl EventHandler for Radio {
    fn on_vendor(&self, vendor: &Vendor<'_>) {
        if let Some(anchor) = Anchor::read(vendor) {
            self.anchor.set(Some(anchor));
        }
    }
}

/// GAP's and GATT's own; the service, packets with their switch, commands, state, calibration.
const ATTRIBUTES: usize = GAP_SERVICE_ATTRIBUTE_COUNT + 1 + 3 + 2 + 2 + 2;

type Attributes<'a> = AttributeServer<'a, NoopRawMutex, DefaultPacketPool, ATTRIBUTES, 1>;

/// What a receiver can read, write and subscribe to.
struct Server<'a> {
    attributes: Attributes<'a>,
    data: Characteristic<Vec<u8, 1>>,
    control: Characteristic<Vec<u8, COMMAND_MAX>>,
    status: Characteristic<Status>,
    kept: Characteristic<Kept>,
}

/// Where the values of the characteristics are.
struct Values {
    command: [u8; COMMAND_MAX],
    status: [u8; STATUS_MAX],
    kept: [u8; CALIBRATION_BYTES],
}

impl<'a> Server<'a> {
    fn new(Values { command, status, kept }: &'a mut Values) -> Result<Self, Stopped> {
        let mut table = AttributeTable::new();
        let gap = PeripheralConfig { name: "shisei", appearance: &appearance::sensor::GENERIC_SENSOR };
        GapConfig::Peripheral(gap).build(&mut table).map_err(|_| Stopped)?;
        let mut service = table.add_service(Service::new(Uuid::new_long(SERVICE)));
        let notify = [CharacteristicProp::Notify];
        let data = service.add_characteristic_small(Uuid::new_long(DATA), notify, Vec::new()).build();
        let write = [CharacteristicProp::Write];
        let control = service.add_characteristic(Uuid::new_long(CONTROL), write, Vec::new(), command).build();
        let read = [CharacteristicProp::Read];
        let status = service.add_characteristic(Uuid::new_long(STATUS), read, Vec::new(), status).build();
        let kept = service.add_characteristic(Uuid::new_long(CALIBRATION), read, Vec::new(), kept).build();
        service.build();
        Ok(Server { attributes: AttributeServer::new(table), data, control, status, kept })
    }
}

/// Runs the radio of a node until the controller fails. `address` is a static random one; `report_anchors` switches
/// reports of anchor points on. [`Radio::set_status`] is to be called before, for the name is advertised.
pub async fn run<C, A>(
    controller: C,
    address: [u8; 6],
    report_anchors: A,
    radio: &Radio,
) -> Result<(), Stopped>
where
    C: Controller<A>,
    A: SyncCmd,
{
    let mut resources: HostResources<DefaultPacketPool, 1, 2> = HostResources::new();
    let stack =
        trouble_host::new(controller, &mut resources).set_random_address(Address::random(address)).build();
    let mut runner = stack.runner();
    let work = async {
        stack.command(report_anchors).await.map_err(|_| Stopped)?;
        let mut values =
            Values { command: [0; COMMAND_MAX], status: [0; STATUS_MAX], kept: [0; CALIBRATION_BYTES] };
        let server = Server::new(&mut values)?;
        let mut peripheral = stack.peripheral();
        loop {
            // A failure here is of the moment: a link that broke while it was made.
            if serve(&mut peripheral, &server, radio).await.is_err() {
                Timer::after(Duration::from_millis(100)).await;
            }
        }
    };
    match select(runner.run_with_handler(radio), work).await {
        Either::First(_) => Err(Stopped),
        Either::Second(stopped) => stopped,
    }
}

/// Advertises, and serves the receiver that comes until it goes.
async fn serve<C: trouble_host::Controller>(
    peripheral: &mut Peripheral<'_, C, DefaultPacketPool>,
    server: &Server<'_>,
    radio: &Radio,
) -> Result<(), BleHostError<C::Error>> {
    let (mut data, mut scan) = ([0; 31], [0; 31]);
    let flags = AdStructure::Flags(LE_GENERAL_DISCOVERABLE | BR_EDR_NOT_SUPPORTED);
    let services = [SERVICE];
    let data_length =
        AdStructure::encode_slice(&[flags, AdStructure::CompleteServiceUuids128(&services)], &mut data)?;
    let scan_length = AdStructure::encode_slice(&[AdStructure::CompleteLocalName(&radio.name())], &mut scan)?;
    let parameters = AdvertisementParameters {
        interval_min: Duration::from_millis(100),
        interval_max: Duration::from_millis(150),
        ..AdvertisementParameters::default()
    };
    let advertisement = Advertisement::ConnectableScannableUndirected {
        adv_data: data.get(..data_length).unwrap_or_default(),
        scan_data: scan.get(..scan_length).unwrap_or_default(),
    };
    let connection = peripheral.advertise(&parameters, advertisement).await?.accept().await?;
    let connection = connection.with_attribute_server(&server.attributes)?;
    radio.anchor.set(None);
    radio.outgoing.clear();
    let notify = async {
        loop {
            let packet = radio.outgoing.receive().await;
            if server.data.notify_raw(&connection, &packet, false).await.is_err() {
                // The link is gone, which `requests` is told as well.
                core::future::pending::<()>().await;
            }
        }
    };
    let requests = async {
        let mut subscribed = false;
        loop {
            match connection.next().await {
                GattConnectionEvent::Disconnected { .. } => return,
                GattConnectionEvent::Gatt { event } => answer(event, server, radio).await,
                _ => {}
            }
            let now = server.data.should_notify(&connection);
            if now != subscribed {
                subscribed = now;
                radio.link_changed.set(Some(now));
            }
        }
    };
    let _: Either<(), ()> = select(notify, requests).await;
    radio.link_changed.set(Some(false));
    radio.outgoing.clear();
    Ok(())
}

async fn answer(event: GattEvent<'_, '_, DefaultPacketPool>, server: &Server<'_>, radio: &Radio) {
    let refusal = match &event {
        GattEvent::Read(read) if read.handle() == server.status.handle => {
            let set = server.status.set(&server.attributes, &radio.status.borrow());
            set.err().map(|_| AttErrorCode::INSUFFICIENT_RESOURCES)
        }
        GattEvent::Read(read) if read.handle() == server.kept.handle => {
            let set = server.kept.set(&server.attributes, &radio.kept.borrow());
            set.err().map(|_| AttErrorCode::INSUFFICIENT_RESOURCES)
        }
        GattEvent::Write(write) if write.handle() == server.control.handle => write.with_data(|_, bytes| {
            if Command::decode_for_node(bytes).is_err() {
                return Some(AttErrorCode::VALUE_NOT_ALLOWED);
            }
            let queued = Vec::from_slice(bytes).is_ok_and(|command| radio.commands.try_send(command).is_ok());
            (!queued).then_some(AttErrorCode::INSUFFICIENT_RESOURCES)
        }),
        _ => None,
    };
    let reply = match refusal {
        None => event.accept(),
        Some(why) => event.reject(why),
    };
    if let Ok(reply) = reply {
        reply.send().await;
    }
}
