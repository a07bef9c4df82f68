//! A receiver's radio.

use core::cell::{Cell, RefCell};

use bt_hci::cmd::SyncCmd;
use bt_hci::cmd::le::{
    LeReadLocalSupportedFeatures, LeSetDataLength, LeSetPhy, LeSetScanEnable, LeSetScanParams,
};
use bt_hci::controller::{ControllerCmdAsync, ControllerCmdSync};
use bt_hci::event::Vendor;
use bt_hci::param::AddrKind;
use embassy_futures::join::join_array;
use embassy_futures::select::{Either, Either3, select, select3};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::channel::Channel;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Timer, with_timeout};
use heapless::Vec;
use shisei_device::receiver::{NODES_MAX, Receiver, ToNode};
use shisei_wire::calibration::CALIBRATION_BYTES;
use shisei_wire::gatt::{CALIBRATION, COMMAND_MAX, CONTROL, DATA, NAME_MAX, SERVICE, STATUS};
use shisei_wire::message::NO_NODE;
use trouble_host::advertise::AdStructure;
use trouble_host::prelude::*;

use crate::anchor::Anchor;
use crate::{Clock, Controller, Stopped};

/// Connection interval.
const INTERVAL: Duration = Duration::from_millis(15);
/// Without a word for so long, a link is gone.
const SUPERVISION: Duration = Duration::from_secs(2);
/// How long a connection may take.
const CONNECTING: Duration = Duration::from_secs(5);
/// How long a node may take to tell what it is.
const DISCOVERY: Duration = Duration::from_secs(10);
/// From one look at a node's state to the next.
const STATUS_EVERY: Duration = Duration::from_secs(10);
/// Kind of the command that changes the calibration that a node keeps.
const KEEP: u8 = 134;
/// From a command to the look at what it changed: a node looks at its commands every few milliseconds.
const SETTLING: Duration = Duration::from_millis(100);
/// Fixed bytes of a node's state; its name follows.
const STATUS_FIXED: usize = 9;
/// The link layer's reason where a node did not behave: ended by this side.
const REASON_OURS: u8 = 0x16;

/// What asks for notifications.
const NOTIFY: [u8; 2] = [1, 0];

type Command = Vec<u8, COMMAND_MAX>;

/// A node that was heard: how its address is meant, and the address.
type Heard = (AddrKind, [u8; 6]);

/// Between the radio and the receiver's board.
pub struct Radio<'a, K, const OUT: usize> {
    receiver: &'a RefCell<Receiver<OUT>>,
    clock: K,
    heard: Channel<NoopRawMutex, Heard, 8>,
    commands: [Channel<NoopRawMutex, Command, 4>; NODES_MAX],
    /// Handle of the link at each place.
    handles: [Cell<Option<u16>>; NODES_MAX],
}

impl<'a, K: Clock, const OUT: usize> Radio<'a, K, OUT> {
    /// A radio that tells this receiver what happens.
    pub fn new(receiver: &'a RefCell<Receiver<OUT>>, clock: K) -> Self {
        Radio {
            receiver,
            clock,
            heard: Channel::new(),
            commands: [const { Channel::new() }; NODES_MAX],
            handles: [const { Cell::new(None) }; NODES_MAX],
        }
    }

    /// Sends a command on; false, and told to the PC, where a node has too many before it.
    pub fn send(&self, command: &ToNode) -> bool {
        let sent = self.pass_on(command);
        if !sent {
            self.not_carried_out(command.node, command.bytes());
        }
        sent
    }

    fn not_carried_out(&self, node: u8, command: &[u8]) {
        let kind = command.first().copied().unwrap_or(0);
        self.receiver.borrow_mut().not_carried_out(node, kind, self.clock.now_us());
    }

    fn pass_on(&self, command: &ToNode) -> bool {
        let Ok(bytes) = Command::from_slice(command.bytes()) else { return false };
        let meant = |place: usize| command.node == NO_NODE || usize::from(command.node) == place;
        let places = self.commands.iter().enumerate().filter(|(place, _)| meant(*place));
        let connected = places.filter(|(place, _)| self.receiver.borrow().is_connected(*place));
        connected.fold(true, |all, (_, queue)| queue.try_send(bytes.clone()).is_ok() && all)
    }
}

impl<K: Clock, const OUT: usize> EventHandler for Radio<'_, K, OUT> {
    fn on_vendor(&self, vendor: &Vendor<'_>) {
        let Some(anchor) = Anchor::read(vendor) else { return };
        if let Some(place) = self.handles.iter().position(|handle| handle.get() == Some(anchor.handle)) {
            let time_us = self.clock.from_controller_us(anchor.controller_us);
            self.receiver.borrow_mut().anchor(place, anchor.event, time_us);
        }
    }

    fn on_adv_reports(&self, reports: bt_hci::param::LeAdvReportsIter<'_>) {
        for report in reports.flatten() {
            let ours = AdStructure::decode(report.data).flatten().any(|part| match part {
                AdStructure::CompleteServiceUuids128(services)
                | AdStructure::IncompleteServiceUuids128(services) => services.contains(&SERVICE),
                _ => false,
            });
            if let (true, Ok(address)) = (ours, report.addr.raw().try_into()) {
                // A full queue: it advertises again.
                let _ = self.heard.try_send((report.addr_kind, address));
            }
        }
    }
}

/// Commands of the controller that a receiver needs beyond the common ones.
pub trait Central<A: SyncCmd>:
    Controller<A>
    + ControllerCmdSync<LeSetScanParams>
    + ControllerCmdSync<LeSetScanEnable>
    + ControllerCmdSync<LeSetDataLength>
    + ControllerCmdSync<LeReadLocalSupportedFeatures>
    + ControllerCmdAsync<LeSetPhy>
{
}

impl<A: SyncCmd, C> Central<A> for C where
    C: Controller<A>
        + ControllerCmdSync<LeSetScanParams>
        + ControllerCmdSync<LeSetScanEnable>
        + ControllerCmdSync<LeSetDataLength>
        + ControllerCmdSync<LeReadLocalSupportedFeatures>
        + ControllerCmdAsync<LeSetPhy>
{
}

/// Runs the radio of a receiver until the controller fails. `address` is a static random one; `report_anchors`
/// switches reports of anchor points on.
pub async fn run<C, A, K, const OUT: usize>(
    controller: C,
    address: [u8; 6],
    report_anchors: A,
    radio: &Radio<'_, K, OUT>,
) -> Result<(), Stopped>
where
    C: Central<A>,
    A: SyncCmd,
    K: Clock,
{
    let mut resources: HostResources<DefaultPacketPool, NODES_MAX, 16> = HostResources::new();
    let stack =
        trouble_host::new(controller, &mut resources).set_random_address(Address::random(address)).build();
    let mut runner = stack.runner();
    let begun: [Signal<NoopRawMutex, Connection<'_, DefaultPacketPool>>; NODES_MAX] =
        [const { Signal::new() }; NODES_MAX];
    // Set when the node that connected last is served, or is not.
    let settled = Signal::<NoopRawMutex, ()>::new();
    let place = |place: usize| {
        let (stack, begun, settled) = (&stack, &begun, &settled);
        async move {
            let (Some(begun), Some(handle)) = (begun.get(place), radio.handles.get(place)) else { return };
            loop {
                let connection = begun.wait().await;
                handle.set(Some(connection.handle().raw()));
                serve(stack, radio, place, &connection, settled).await;
                handle.set(None);
                settled.signal(());
            }
        }
    };
    let find = async {
        stack.command(report_anchors).await.map_err(|_| Stopped)?;
        loop {
            let (place, heard) = find(&stack, radio).await?;
            settled.reset();
            if let (Some(connection), Some(begun)) = (connect(&stack, heard).await, begun.get(place)) {
                begun.signal(connection);
                settled.wait().await;
            }
        }
    };
    let places = join_array([place(0), place(1), place(2), place(3), place(4), place(5)]);
    match select3(runner.run_with_handler(radio), find, places).await {
        Either3::Second(stopped) => stopped,
        Either3::First(_) | Either3::Third(_) => Err(Stopped),
    }
}

/// Scans until a node is heard that the receiver has a place for.
async fn find<C, K: Clock, const OUT: usize>(
    stack: &Stack<'_, C, DefaultPacketPool>,
    radio: &Radio<'_, K, OUT>,
) -> Result<(usize, Heard), Stopped>
where
    C: trouble_host::Controller + ControllerCmdSync<LeSetScanParams> + ControllerCmdSync<LeSetScanEnable>,
{
    let mut central = stack.central();
    let mut scanner = Scanner::new(&mut central);
    // A quarter of the time, so that the links keep theirs.
    let config = ScanConfig {
        active: false,
        interval: Duration::from_millis(120),
        window: Duration::from_millis(30),
        ..ScanConfig::default()
    };
    radio.heard.clear();
    let session = scanner.scan(&config).await.map_err(|_| Stopped)?;
    let found = loop {
        let heard = radio.heard.receive().await;
        let place = radio.receiver.borrow_mut().advertised(heard.1, radio.clock.now_us());
        if let Some(place) = place {
            break (place, heard);
        }
    };
    session.stop().await;
    Ok(found)
}

async fn connect<'a, C: trouble_host::Controller>(
    stack: &'a Stack<'_, C, DefaultPacketPool>,
    (kind, address): Heard,
) -> Option<Connection<'a, DefaultPacketPool>> {
    let target = [Address::new(kind, BdAddr::new(address))];
    let config = ConnectConfig {
        connect_params: RequestedConnParams {
            min_connection_interval: INTERVAL,
            max_connection_interval: INTERVAL,
            supervision_timeout: SUPERVISION,
            ..RequestedConnParams::default()
        },
        scan_config: ScanConfig {
            filter_accept_list: &target,
            interval: Duration::from_millis(60),
            window: Duration::from_millis(30),
            ..ScanConfig::default()
        },
    };
    let mut central = stack.central();
    with_timeout(CONNECTING, central.connect(&config)).await.ok()?.ok()
}

/// A node, from its connection to its end.
async fn serve<C, K: Clock, const OUT: usize>(
    stack: &Stack<'_, C, DefaultPacketPool>,
    radio: &Radio<'_, K, OUT>,
    place: usize,
    connection: &Connection<'_, DefaultPacketPool>,
    settled: &Signal<NoopRawMutex, ()>,
) where
    C: trouble_host::Controller
        + ControllerCmdSync<LeSetDataLength>
        + ControllerCmdSync<LeReadLocalSupportedFeatures>
        + ControllerCmdAsync<LeSetPhy>,
{
    let gone = async {
        loop {
            if let ConnectionEvent::Disconnected { reason } = connection.next().await {
                return reason.into_inner();
            }
        }
    };
    let told = Cell::new(false);
    let work = async {
        // Longer packets and the faster PHY save airtime; a controller without them is slower, no more.
        let _ = connection.update_data_length(stack, 251, 2120).await;
        let _ = connection.set_phy(stack, PhyKind::Le2M).await;
        let client = GattClient::<C, DefaultPacketPool, 4>::new(stack, connection).await.ok()?;
        let talk = talk(&client, radio, place, &told, settled);
        match select(client.task(), talk).await {
            Either::First(_) => None,
            Either::Second(ended) => ended,
        }
    };
    let reason = match select(gone, work).await {
        Either::First(reason) => reason,
        Either::Second(_) => {
            connection.disconnect();
            Timer::after(Duration::from_millis(100)).await;
            REASON_OURS
        }
    };
    if told.get() {
        radio.receiver.borrow_mut().disconnected(place, reason, radio.clock.now_us());
    }
}

/// Finds out what the node is, then passes on what it and the PC say.
async fn talk<C: trouble_host::Controller, K: Clock, const OUT: usize>(
    client: &GattClient<'_, C, DefaultPacketPool, 4>,
    radio: &Radio<'_, K, OUT>,
    place: usize,
    told: &Cell<bool>,
    settled: &Signal<NoopRawMutex, ()>,
) -> Option<()> {
    let commands = radio.commands.get(place)?;
    let mut status = [0; STATUS_FIXED + NAME_MAX];
    let discover = async {
        let service = client.services_by_uuid(&Uuid::new_long(SERVICE)).await.ok()?.first()?.clone();
        let data: Characteristic<Vec<u8, 1>> =
            client.characteristic_by_uuid(&service, &Uuid::new_long(DATA)).await.ok()?;
        let control: Characteristic<Command> =
            client.characteristic_by_uuid(&service, &Uuid::new_long(CONTROL)).await.ok()?;
        let state: Characteristic<Vec<u8, 1>> =
            client.characteristic_by_uuid(&service, &Uuid::new_long(STATUS)).await.ok()?;
        // Nodes before the first that keep calibrations do not have it.
        let kept: Option<Characteristic<Vec<u8, 1>>> =
            client.characteristic_by_uuid(&service, &Uuid::new_long(CALIBRATION)).await.ok();
        let length = client.read_characteristic(&state, &mut status).await.ok()?;
        // Listened to before it is asked for, so that the first packet is not missed.
        let packets = client.listen(&data).ok()?;
        commands.clear();
        tell(radio, place, status.get(..length)?);
        told.set(true);
        read_back(client, radio, place, kept.as_ref()).await;
        client.write_handle(data.cccd_handle()?.handle(), &NOTIFY).await.ok()?;
        Some((control, state, kept, packets))
    };
    let (control, state, kept, mut packets) = with_timeout(DISCOVERY, discover).await.ok()??;
    settled.signal(());
    let pass_on = async {
        loop {
            let packet = packets.next().await;
            radio.receiver.borrow_mut().notification(place, packet.as_ref(), radio.clock.now_us());
        }
    };
    let requests = async {
        loop {
            match select(commands.receive(), Timer::after(STATUS_EVERY)).await {
                Either::First(command) => {
                    // A link that is gone is noticed elsewhere as well.
                    if client.write_characteristic(&control, &command).await.is_err() {
                        radio.not_carried_out(place as u8, &command);
                    }
                    if command.first() == Some(&KEEP) {
                        Timer::after(SETTLING).await;
                        read_back(client, radio, place, kept.as_ref()).await;
                    }
                }
                Either::Second(()) => {
                    let mut status = [0; STATUS_FIXED + NAME_MAX];
                    let length = client.read_characteristic(&state, &mut status).await.ok()?;
                    let status = status.get(..length)?;
                    radio.receiver.borrow_mut().status(place, status);
                }
            }
        }
    };
    match select(pass_on, requests).await {
        Either::First(()) => None,
        Either::Second(ended) => ended,
    }
}

/// Reads the calibration that a node keeps, and passes it on.
async fn read_back<C: trouble_host::Controller, K: Clock, const OUT: usize>(
    client: &GattClient<'_, C, DefaultPacketPool, 4>,
    radio: &Radio<'_, K, OUT>,
    place: usize,
    kept: Option<&Characteristic<Vec<u8, 1>>>,
) {
    let mut bytes = [0; CALIBRATION_BYTES];
    let length = match kept {
        Some(kept) => client.read_characteristic(kept, &mut bytes).await.ok(),
        None => Some(0),
    };
    if let Some(read) = length.and_then(|length| bytes.get(..length)) {
        radio.receiver.borrow_mut().calibration(place, read);
    }
}

fn tell<K: Clock, const OUT: usize>(radio: &Radio<'_, K, OUT>, place: usize, status: &[u8]) {
    let (fixed, name) = status.split_at_checked(STATUS_FIXED).unwrap_or((status, &[]));
    let name = core::str::from_utf8(name).unwrap_or("");
    radio.receiver.borrow_mut().connected(place, name, fixed, radio.clock.now_us());
}
