//! What NatNet packets say. Positions m, quaternions x, y, z, w, both in the server's frame.

/// A bitstream version.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Version {
    /// Major.
    pub major: u8,
    /// Minor.
    pub minor: u8,
}

impl Version {
    /// 3.0, Motive 2.0.
    pub const V3_0: Self = Version { major: 3, minor: 0 };
    /// 4.0, Motive 3.0.
    pub const V4_0: Self = Version { major: 4, minor: 0 };
    /// 4.1, Motive 3.1.
    pub const V4_1: Self = Version { major: 4, minor: 1 };

    /// Sections and descriptions say how many bytes they have; frames have assets and a precision timestamp.
    pub fn sized(self) -> bool {
        self >= Version::V4_1
    }

    /// Rigid bodies' markers have names.
    pub fn named_markers(self) -> bool {
        self >= Version::V4_0
    }
}

/// Who the server is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ServerInfo {
    /// Name of the application.
    pub name: String,
    /// Its version.
    pub app_version: [u8; 4],
    /// Version of its stream.
    pub natnet_version: [u8; 4],
    /// Ticks of its clock a second, Hz.
    pub clock_hz: u64,
    /// Where frames are sent from.
    pub data_port: u16,
    /// Frames go to a group.
    pub multicast: bool,
    /// That group.
    pub group: [u8; 4],
}

impl ServerInfo {
    /// Version of its stream.
    pub fn version(&self) -> Version {
        Version { major: self.natnet_version[0], minor: self.natnet_version[1] }
    }
}

/// A rigid body or a bone in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Its number; a bone's has the skeleton's in its upper half.
    pub id: i32,
    /// Position, m.
    pub position_m: [f32; 3],
    /// Attitude, world from body.
    pub quaternion_xyzw: [f32; 4],
    /// Mean error of its markers, m.
    pub error_m: f32,
    /// Bit 0: tracked.
    pub params: i16,
}

impl Body {
    /// It was seen in this frame.
    pub fn tracked(&self) -> bool {
        self.params & 1 != 0
    }
}

/// A skeleton in a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skeleton {
    /// Its number.
    pub id: i32,
    /// Its bones.
    pub bones: Vec<Body>,
}

/// A marker in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabeledMarker {
    /// Asset's number in the upper half, marker's in the lower.
    pub id: i32,
    /// Position, m.
    pub position_m: [f32; 3],
    /// Diameter, m.
    pub size_m: f32,
    /// Bit 0 occluded, bit 1 from the point cloud, bit 2 solved by the model, bit 3 has a model, bit 4 unlabelled.
    pub params: i16,
    /// Residual, m.
    pub residual_m: f32,
}

/// A frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Its number.
    pub number: i32,
    /// Named sets of markers, m.
    pub marker_sets: Vec<(String, Vec<[f32; 3]>)>,
    /// Markers without a name, m.
    pub other_markers_m: Vec<[f32; 3]>,
    /// Rigid bodies.
    pub bodies: Vec<Body>,
    /// Skeletons.
    pub skeletons: Vec<Skeleton>,
    /// All markers.
    pub markers: Vec<LabeledMarker>,
    /// SMPTE timecode and subframe.
    pub timecode: (u32, u32),
    /// The program's count of time, s: a counter, not a clock.
    pub timestamp_s: f64,
    /// Middle of the exposure, ticks of the server's clock.
    pub mid_exposure: u64,
    /// When the cameras' data were there, ticks.
    pub data_received: u64,
    /// When the frame was sent, ticks.
    pub transmit: u64,
    /// Bit 0: recording; bit 1: the descriptions changed.
    pub params: i16,
}

/// What a rigid body or bone is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyDescription {
    /// Its name.
    pub name: String,
    /// Its number.
    pub id: i32,
    /// The bone it hangs on; −1 or 0: none.
    pub parent: i32,
    /// Where it hangs, m.
    pub offset_m: [f32; 3],
    /// Its markers in body coordinates, m.
    pub markers_m: Vec<[f32; 3]>,
}

/// What a skeleton is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkeletonDescription {
    /// Its name.
    pub name: String,
    /// Its number.
    pub id: i32,
    /// Its bones.
    pub bones: Vec<BodyDescription>,
}

/// All that is streamed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// Rigid bodies.
    pub bodies: Vec<BodyDescription>,
    /// Skeletons.
    pub skeletons: Vec<SkeletonDescription>,
}
