//! `sensor_msgs/msg/Imu` in ROS 2's encoding (XCDR1, little-endian), which viewers of MCAP know.

use super::Sample;

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

/// The message of a sample at a time, ns since 1970.
pub fn imu(sample: &Sample, time_ns: u64) -> Vec<u8> {
    let mut out = Vec::with_capacity(340);
    // Encapsulation: plain CDR, little-endian. Alignment counts from behind it.
    out.extend_from_slice(&[0, 1, 0, 0]);
    out.extend_from_slice(&((time_ns / 1_000_000_000) as i32).to_le_bytes());
    out.extend_from_slice(&((time_ns % 1_000_000_000) as u32).to_le_bytes());
    let frame_id = format!("node{}\0", sample.node);
    out.extend_from_slice(&(frame_id.len() as u32).to_le_bytes());
    out.extend_from_slice(frame_id.as_bytes());
    while (out.len() - 4) % 8 != 0 {
        out.push(0);
    }
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
