//! `sensor_msgs/msg/Imu` and `geometry_msgs/msg/PoseStamped` in ROS 2's encoding (XCDR1, little-endian), which viewers of
//! MCAP know.

use shisei_core::frames::Pose;

use crate::session::Sample;

/// Name of the schema.
pub const NAME: &str = "sensor_msgs/msg/Imu";

/// The schema: the message's definition and those it uses, after the ROS 2 interfaces (`common_interfaces`).
pub const DEFINITION: &str = "\
std_msgs/Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

/// A pose's message.
pub const POSE_NAME: &str = "geometry_msgs/msg/PoseStamped";

/// Its schema, after the ROS 2 interfaces.
pub const POSE_DEFINITION: &str = "\
std_msgs/Header header
geometry_msgs/Pose pose
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation
================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

/// Encapsulation and header: plain CDR, little-endian, aligned for float64.
fn header(frame_id: &str, time_ns: u64) -> Vec<u8> {
    let mut out = Vec::with_capacity(340);
    // Alignment counts from behind the encapsulation.
    out.extend_from_slice(&[0, 1, 0, 0]);
    out.extend_from_slice(&((time_ns / 1_000_000_000) as i32).to_le_bytes());
    out.extend_from_slice(&((time_ns % 1_000_000_000) as u32).to_le_bytes());
    out.extend_from_slice(&(frame_id.len() as u32 + 1).to_le_bytes());
    out.extend_from_slice(frame_id.as_bytes());
    out.push(0);
    while (out.len() - 4) % 8 != 0 {
        out.push(0);
    }
    out
}

/// The message of a pose at a time, ns since 1970.
pub fn pose(pose: &Pose, frame_id: &str, time_ns: u64) -> Vec<u8> {
    let mut out = header(frame_id, time_ns);
    let [w, x, y, z] = pose.world_from_body.to_array();
    for number in pose.position_m.into_iter().chain([x, y, z, w]) {
        out.extend_from_slice(&number.to_le_bytes());
    }
    out
}

/// The message of a sample at a time, ns since 1970.
pub fn imu(sample: &Sample, time_ns: u64) -> Vec<u8> {
    let mut out = header(&format!("node{}", sample.node), time_ns);
    let [w, x, y, z] = sample.world_from_body.to_array();
    let unknown = [0.0; 9];
    let numbers = [x, y, z, w]
        .into_iter()
        .chain(unknown)
        .chain(sample.gyro_rad_s)
        .chain(unknown)
        .chain(sample.acc_m_s2)
        .chain(unknown);
    for number in numbers {
        out.extend_from_slice(&number.to_le_bytes());
    }
    out
}
