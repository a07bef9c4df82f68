//! Packets into values. Nothing is allocated for more than the packet holds; what is not understood is skipped where
//! the packet says how long it is.

use super::model::{
    Body, BodyDescription, Frame, LabeledMarker, Model, ServerInfo, Skeleton, SkeletonDescription, Version,
};

/// A packet that ends too early, or counts more than it holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Malformed;

impl std::fmt::Display for Malformed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("malformed NatNet packet")
    }
}

impl std::error::Error for Malformed {}

type Result<T> = std::result::Result<T, Malformed>;

const BODY_BYTES: usize = 38;
const MARKER_BYTES: usize = 26;
const DESCRIPTION_BYTES: usize = 25;
const NAME_BYTES: usize = 256;

/// A packet's kind and payload.
pub fn packet(bytes: &[u8]) -> Result<(u16, &[u8])> {
    let mut reader = Reader(bytes);
    let id = reader.u16()?;
    reader.u16()?;
    Ok((id, reader.0))
}

/// A frame of a stream of this version.
pub fn frame(payload: &[u8], version: Version) -> Result<Frame> {
    let r = &mut Reader(payload);
    let sized = version.sized();
    let mut frame = Frame { number: r.i32()?, ..Frame::default() };
    frame.marker_sets = section(r, sized, 5, |r| {
        let name = r.text()?;
        let count = r.count(12)?;
        Ok((name, r.many(count, Reader::vector)?))
    })?;
    frame.other_markers_m = section(r, sized, 12, vector)?;
    frame.bodies = section(r, sized, BODY_BYTES, body)?;
    frame.skeletons = section(r, sized, 8, |r| {
        let id = r.i32()?;
        let count = r.count(BODY_BYTES)?;
        Ok(Skeleton { id, bones: r.many(count, body)? })
    })?;
    if sized {
        skip(r)?;
    }
    frame.markers = section(r, sized, MARKER_BYTES, |r| {
        Ok(LabeledMarker {
            id: r.i32()?,
            position_m: r.vector()?,
            size_m: r.f32()?,
            params: r.i16()?,
            residual_m: r.f32()?,
        })
    })?;
    for _force_plates_and_devices in 0..2 {
        if sized {
            skip(r)?;
        } else {
            analog(r)?;
        }
    }
    frame.timecode = (r.u32()?, r.u32()?);
    frame.timestamp_s = r.f64()?;
    frame.mid_exposure = r.u64()?;
    frame.data_received = r.u64()?;
    frame.transmit = r.u64()?;
    if sized {
        // a precision timestamp: seconds and their fraction
        r.u64()?;
    }
    frame.params = r.i16()?;
    Ok(frame)
}

/// Who the server is.
pub fn server_info(payload: &[u8]) -> Result<ServerInfo> {
    let mut r = Reader(payload);
    let name = r.take(NAME_BYTES)?;
    let end = name.iter().position(|byte| *byte == 0).unwrap_or(NAME_BYTES);
    let name = String::from_utf8_lossy(name.get(..end).unwrap_or_default()).into_owned();
    let (app_version, natnet_version) = (r.array()?, r.array()?);
    // servers before 3.0 end here
    let clock_hz = r.u64().unwrap_or(0);
    let data_port = r.u16().unwrap_or(super::DATA_PORT);
    let multicast = r.u8() != Ok(0);
    let group = r.array().unwrap_or(super::GROUP);
    Ok(ServerInfo { name, app_version, natnet_version, clock_hz, data_port, multicast, group })
}

/// Names and structure of what a server of this version streams. Kinds of things that are not known are skipped
/// from 4.1 on; before, the rest of the list is lost with them.
pub fn model(payload: &[u8], version: Version) -> Result<Model> {
    let r = &mut Reader(payload);
    let mut model = Model::default();
    for _ in 0..r.count(4)? {
        let kind = r.i32()?;
        if version.sized() {
            let size = r.count(1)?;
            // what one thing says wrongly does not spoil the others
            let _ = described(kind, &mut Reader(r.take(size)?), version, &mut model);
        } else if !described(kind, r, version, &mut model)? {
            break;
        }
    }
    Ok(model)
}

/// One description; false where its kind is not known.
fn described(kind: i32, r: &mut Reader<'_>, version: Version, model: &mut Model) -> Result<bool> {
    match kind {
        0 => {
            r.text()?;
            for _ in 0..r.count(1)? {
                r.text()?;
            }
        }
        1 => model.bodies.push(description(r, version)?),
        2 => {
            let (name, id) = (r.text()?, r.i32()?);
            let count = r.count(DESCRIPTION_BYTES)?;
            let bones = r.many(count, |r| description(r, version))?;
            model.skeletons.push(SkeletonDescription { name, id, bones });
        }
        3 => {
            r.i32()?;
            r.text()?;
            // size, origin, calibration matrix, corners, types
            r.take((2 + 3 + 144 + 12 + 2) * 4)?;
            channels(r)?;
        }
        4 => {
            r.i32()?;
            r.text()?;
            r.text()?;
            r.take(8)?;
            channels(r)?;
        }
        5 => {
            r.text()?;
            r.take(28)?;
        }
        _ => return Ok(false),
    }
    Ok(true)
}

fn channels(r: &mut Reader<'_>) -> Result<()> {
    for _ in 0..r.count(1)? {
        r.text()?;
    }
    Ok(())
}

fn description(r: &mut Reader<'_>, version: Version) -> Result<BodyDescription> {
    let (name, id, parent, offset_m) = (r.text()?, r.i32()?, r.i32()?, r.vector()?);
    let count = r.count(16)?;
    let markers_m = r.many(count, Reader::vector)?;
    r.take(count * 4)?;
    if version.named_markers() {
        for _ in 0..count {
            r.text()?;
        }
    }
    Ok(BodyDescription { name, id, parent, offset_m, markers_m })
}

fn body(r: &mut Reader<'_>) -> Result<Body> {
    Ok(Body {
        id: r.i32()?,
        position_m: r.vector()?,
        quaternion_xyzw: [r.f32()?, r.f32()?, r.f32()?, r.f32()?],
        error_m: r.f32()?,
        params: r.i16()?,
    })
}

fn vector(r: &mut Reader<'_>) -> Result<[f32; 3]> {
    r.vector()
}

fn section<T>(
    r: &mut Reader<'_>,
    sized: bool,
    least: usize,
    mut item: impl FnMut(&mut Reader<'_>) -> Result<T>,
) -> Result<Vec<T>> {
    if !sized {
        let count = r.count(least)?;
        return r.many(count, item);
    }
    let wanted = r.i32()?;
    let size = r.count(1)?;
    let mut inner = Reader(r.take(size)?);
    let count = usize::try_from(wanted).map_err(|_| Malformed)?;
    if count > inner.0.len() / least {
        return Err(Malformed);
    }
    inner.many(count, &mut item)
}

/// A sized section that is not used.
fn skip(r: &mut Reader<'_>) -> Result<()> {
    r.i32()?;
    let size = r.count(1)?;
    r.take(size)?;
    Ok(())
}

/// Force plates or devices before 4.1.
fn analog(r: &mut Reader<'_>) -> Result<()> {
    for _ in 0..r.count(8)? {
        r.i32()?;
        for _ in 0..r.count(4)? {
            let count = r.count(4)?;
            r.take(count * 4)?;
        }
    }
    Ok(())
}

struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(Malformed)?;
        self.0 = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        self.take(N)?.try_into().map_err(|_| Malformed)
    }

    fn u8(&mut self) -> Result<u8> {
        Ok(u8::from_le_bytes(self.array()?))
    }

    fn u16(&mut self) -> Result<u16> {
        Ok(u16::from_le_bytes(self.array()?))
    }

    fn i16(&mut self) -> Result<i16> {
        Ok(i16::from_le_bytes(self.array()?))
    }

    fn i32(&mut self) -> Result<i32> {
        Ok(i32::from_le_bytes(self.array()?))
    }

    fn u32(&mut self) -> Result<u32> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    fn u64(&mut self) -> Result<u64> {
        Ok(u64::from_le_bytes(self.array()?))
    }

    fn f32(&mut self) -> Result<f32> {
        Ok(f32::from_le_bytes(self.array()?))
    }

    fn f64(&mut self) -> Result<f64> {
        Ok(f64::from_le_bytes(self.array()?))
    }

    fn vector(&mut self) -> Result<[f32; 3]> {
        Ok([self.f32()?, self.f32()?, self.f32()?])
    }

    /// A count of things of at least so many bytes each; never more than there is room for.
    fn count(&mut self, least: usize) -> Result<usize> {
        let count = usize::try_from(self.i32()?).map_err(|_| Malformed)?;
        if count > self.0.len() / least { Err(Malformed) } else { Ok(count) }
    }

    fn many<T>(&mut self, count: usize, mut item: impl FnMut(&mut Self) -> Result<T>) -> Result<Vec<T>> {
        (0..count).map(|_| item(self)).collect()
    }

    /// A string up to its zero byte, without control characters.
    fn text(&mut self) -> Result<String> {
        let end = self.0.iter().position(|byte| *byte == 0).ok_or(Malformed)?;
        let text = String::from_utf8_lossy(self.take(end)?);
        self.take(1)?;
        Ok(text.chars().filter(|c| !c.is_control()).collect())
    }
}
