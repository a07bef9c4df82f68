//! Files as makers' tools write them, from a known motion: for tests and for the simulator's users.
//!
//! Each writer follows its dialect's header, units, separator and clock; numbers have nine decimals unless
//! the tool itself writes fewer.

use crate::units::RAD_PER_DEG;
use shisei_core::{STANDARD_GRAVITY_M_S2 as G, Vec3};
use std::fmt::Write;

/// A motion to write: N samples.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    /// Time, s, rising from about 0.
    pub time_s: &'a [f64],
    /// Specific force, m/s².
    pub acc_m_s2: &'a [Vec3],
    /// Angular rate, rad/s.
    pub gyro_rad_s: &'a [Vec3],
    /// Nominal rate, Hz.
    pub rate_hz: f64,
}

/// A file: name and bytes.
pub type File = (String, Vec<u8>);

/// Ids that [`write()`] knows.
pub const IDS: &[&str] = &[
    "shisei",
    "mu-01",
    "x-io",
    "phyphox",
    "sensor-logger",
    "sensorlog",
    "xsens-dot",
    "xsens-mt",
    "apdm",
    "shimmer",
    "metawear",
    "noraxon",
    "gaitmap",
    "euroc",
    "gyroflow",
    "microstrain",
    "ros",
    "android-ms",
    "headerless",
    "spresense",
];

/// Milliseconds, microseconds, nanoseconds since 1970 of the samples' start, where a tool writes them.
const START_S: i64 = 1_700_000_000;

/// A column of three: what stands in it.
type Pick = fn(&Motion<'_>, usize) -> Vec3;

fn acc(m: &Motion<'_>, i: usize) -> Vec3 {
    m.acc_m_s2.get(i).copied().unwrap_or_default()
}
fn acc_g(m: &Motion<'_>, i: usize) -> Vec3 {
    acc(m, i).map(|v| v / G)
}
fn acc_mg(m: &Motion<'_>, i: usize) -> Vec3 {
    acc(m, i).map(|v| v / G * 1000.0)
}
fn gyro(m: &Motion<'_>, i: usize) -> Vec3 {
    m.gyro_rad_s.get(i).copied().unwrap_or_default()
}
fn gyro_deg(m: &Motion<'_>, i: usize) -> Vec3 {
    gyro(m, i).map(|v| v / RAD_PER_DEG)
}

/// Lines of a table: stamp, triples with nine decimals, a fixed tail.
fn table(
    m: &Motion<'_>,
    head: &str,
    separator: char,
    stamp: impl Fn(usize, f64) -> String,
    picks: &[Pick],
    tail: &str,
) -> Vec<u8> {
    let mut out = head.to_owned();
    for (i, t) in m.time_s.iter().enumerate() {
        let mut first = true;
        let mut cell = |out: &mut String, text: &str| {
            if !std::mem::take(&mut first) {
                out.push(separator);
            }
            out.push_str(text);
        };
        let stamp = stamp(i, *t);
        if !stamp.is_empty() {
            cell(&mut out, &stamp);
        }
        for pick in picks {
            for v in pick(m, i) {
                cell(&mut out, &format!("{v:.9}"));
            }
        }
        out.push_str(tail);
        out.push('\n');
    }
    out.into_bytes()
}

fn seconds(_: usize, t: f64) -> String {
    format!("{t:.9}")
}

fn nanoseconds(t: f64) -> i64 {
    START_S * 1_000_000_000 + (t * 1e9).round() as i64
}

/// Writes a motion as a maker's tool does; `None` for an unknown id.
pub fn write(id: &str, m: &Motion<'_>) -> Option<Vec<File>> {
    let one = |name: &str, bytes: Vec<u8>| Some(vec![(name.to_owned(), bytes)]);
    match id {
        "shisei" => one(
            "shisei.csv",
            table(m, "time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z\n", ',', seconds, &[acc, gyro], ""),
        ),
        "mu-01" => one(
            "mu01.csv",
            table(
                m,
                "Time,Ax[m/s2],Ay[m/s2],Az[m/s2],Gx[rad/s],Gy[rad/s],Gz[rad/s],Temp\n",
                ',',
                |_, t| {
                    let tenths = ((t + 1887.8) * 10.0 + 1e-6).floor() as u64;
                    format!("{:02}:{:02}.{}", tenths / 600 % 60, tenths / 10 % 60, tenths % 10)
                },
                &[acc, gyro],
                ",4095",
            ),
        ),
        "x-io" => one(
            "ximu3.csv",
            table(
                m,
                "Timestamp (us),Gyroscope X (deg/s),Gyroscope Y (deg/s),Gyroscope Z (deg/s),Accelerometer X (g),\
                 Accelerometer Y (g),Accelerometer Z (g)\n",
                ',',
                |_, t| format!("{}", (t * 1e6).round() as i64 + 6_000_000),
                &[gyro_deg, acc_g],
                "",
            ),
        ),
        "phyphox" => {
            let file = |name: &str, unit: &str, pick: Pick| {
                let head = format!(
                    "\"Time (s)\",\"{name} x ({unit})\",\"{name} y ({unit})\",\"{name} z ({unit})\"\n"
                );
                (format!("{name}.csv"), table(m, &head, ',', seconds, &[pick], ""))
            };
            Some(vec![file("Acceleration", "m/s^2", acc), file("Gyroscope", "rad/s", gyro)])
        }
        "sensor-logger" => {
            fn reversed(v: Vec3) -> Vec3 {
                [v[2], v[1], v[0]]
            }
            let file = |name: &str, pick: Pick| {
                let stamp = |_: usize, t: f64| format!("{},{t:.9}", nanoseconds(t));
                (name.to_owned(), table(m, "time,seconds_elapsed,z,y,x\n", ',', stamp, &[pick], ""))
            };
            Some(vec![
                file("TotalAcceleration.csv", |m, i| reversed(acc(m, i))),
                file("Gyroscope.csv", |m, i| reversed(gyro(m, i))),
            ])
        }
        "sensorlog" => one(
            "sensorlog.csv",
            table(
                m,
                "loggingTime(txt)|accelerometerTimestamp_sinceReboot(s)|accelerometerAccelerationX(G)|\
                 accelerometerAccelerationY(G)|accelerometerAccelerationZ(G)|motionRotationRateX(rad/s)|\
                 motionRotationRateY(rad/s)|motionRotationRateZ(rad/s)|motionUserAccelerationX(G)|\
                 motionUserAccelerationY(G)|motionUserAccelerationZ(G)\n",
                '|',
                |_, t| format!("2023-11-14T22:13:{:06.3}+09:00|{t:.9}", t % 60.0),
                &[acc_g, gyro, |_, _| [0.0; 3]],
                "",
            ),
        ),
        _ => write_more(id, m),
    }
}

fn write_more(id: &str, m: &Motion<'_>) -> Option<Vec<File>> {
    let one = |name: &str, bytes: Vec<u8>| Some(vec![(name.to_owned(), bytes)]);
    let rate = m.rate_hz;
    match id {
        "xsens-dot" => one(
            "dot.csv",
            table(
                m,
                &format!(
                    "sep=,\nDeviceTag:,left\nFirmwareVersion:,2.0.0\nOutputRate:,{rate}Hz\n\n\
                     PacketCounter,SampleTimeFine,Acc_X,Acc_Y,Acc_Z,Gyr_X,Gyr_Y,Gyr_Z,Status\n"
                ),
                ',',
                // The counter wraps on the way.
                |i, t| format!("{},{}", i + 1, ((t * 1e6).round() as u64 + 4_294_467_296) % 4_294_967_296),
                &[acc, gyro_deg],
                ",0",
            ),
        ),
        "xsens-mt" => one(
            "mt.txt",
            table(
                m,
                &format!(
                    "// Start Time: Unknown\n// Update Rate: {rate:.1}Hz\n// Filter Profile: human (46.1)\n\
                     // Firmware Version: 4.0.2\nPacketCounter\tSampleTimeFine\tAcc_X\tAcc_Y\tAcc_Z\tGyr_X\tGyr_Y\t\
                     Gyr_Z\n"
                ),
                '\t',
                |i, _| format!("{}\t", (i + 65_500) % 65_536),
                &[acc, gyro],
                "",
            ),
        ),
        "apdm" => one(
            "apdm.csv",
            table(
                m,
                &format!(
                    "Test Name:,Walk\nSample Rate:,{rate},Hz\n\n\
                     Lumbar/Acceleration/X,Lumbar/Acceleration/Y,Lumbar/Acceleration/Z,Lumbar/Angular Velocity/X,\
                     Lumbar/Angular Velocity/Y,Lumbar/Angular Velocity/Z\n\
                     m/s^2,m/s^2,m/s^2,rad/s,rad/s,rad/s\n"
                ),
                ',',
                |_, _| String::new(),
                &[acc, gyro],
                "",
            ),
        ),
        "shimmer" => one(
            "shimmer.csv",
            table(
                m,
                "sep=;\nShimmer_6AX3_Timestamp_Unix_CAL;Shimmer_6AX3_Accel_LN_X_CAL;Shimmer_6AX3_Accel_LN_Y_CAL;\
                 Shimmer_6AX3_Accel_LN_Z_CAL;Shimmer_6AX3_Gyro_X_CAL;Shimmer_6AX3_Gyro_Y_CAL;Shimmer_6AX3_Gyro_Z_CAL;\n\
                 ms;m/(s^2);m/(s^2);m/(s^2);deg/s;deg/s;deg/s;\n",
                ';',
                |_, t| {
                    format!(
                        "{}.{:03}",
                        START_S * 1000 + (t * 1e3 + 1e-7).floor() as i64,
                        ((t * 1e6 + 0.5).floor() as i64) % 1000
                    )
                },
                &[acc, gyro_deg],
                ";",
            ),
        ),
        "metawear" => {
            let file = |name: &str, unit: &str, pick: Pick| {
                let head = format!(
                    "epoch (ms),time (-13:00),elapsed (s),x-axis ({unit}),y-axis ({unit}),z-axis ({unit})\n"
                );
                let stamp = |_: usize, t: f64| {
                    let ms = (t * 1e3).round() as i64;
                    format!(
                        "{},2023-11-14T22:13:{:06.3},{t:.3}",
                        START_S * 1000 + ms,
                        (20_000 + ms) as f64 / 1e3 % 60.0
                    )
                };
                (format!("{name}.csv"), table(m, &head, ',', stamp, &[pick], ""))
            };
            Some(vec![file("Accelerometer", "g", acc_g), file("Gyroscope", "deg/s", gyro_deg)])
        }
        "noraxon" => {
            let bytes = table(
                m,
                "time;Pelvis Accel Sensor X (mG);Pelvis Accel Sensor Y (mG);Pelvis Accel Sensor Z (mG);\
                 Pelvis Gyroscope X (deg/s);Pelvis Gyroscope Y (deg/s);Pelvis Gyroscope Z (deg/s)\n",
                ';',
                seconds,
                &[acc_mg, gyro_deg],
                "",
            );
            one("noraxon.csv", bytes.into_iter().map(|b| if b == b'.' { b',' } else { b }).collect())
        }
        "gaitmap" => one(
            "gaitmap.csv",
            table(m, "time,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z\n", ',', seconds, &[acc, gyro_deg], ""),
        ),
        "euroc" => one(
            "euroc.csv",
            table(
                m,
                "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],\
                 a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n",
                ',',
                |_, t| format!("{}", nanoseconds(t)),
                &[gyro, acc],
                "",
            ),
        ),
        "gyroflow" => one("log.gcsv", gyroflow(m)),
        "microstrain" => one(
            "SensorConnectData.csv",
            table(
                m,
                "Time,inertial-1234.56789:scaledAccelX,inertial-1234.56789:scaledAccelY,inertial-1234.56789:scaledAccelZ,\
                 inertial-1234.56789:scaledGyroX,inertial-1234.56789:scaledGyroY,inertial-1234.56789:scaledGyroZ\n",
                ',',
                seconds,
                &[acc_g, gyro],
                "",
            ),
        ),
        "ros" => one(
            "imu.csv",
            table(
                m,
                "%time,field.header.seq,field.header.stamp,field.angular_velocity.x,field.angular_velocity.y,\
                 field.angular_velocity.z,field.linear_acceleration.x,field.linear_acceleration.y,\
                 field.linear_acceleration.z\n",
                ',',
                |i, t| format!("{},{i},{}", nanoseconds(t) + 1_234_567, nanoseconds(t)),
                &[gyro, acc],
                "",
            ),
        ),
        "android-ms" => {
            let file = |name: &str, pick: Pick| {
                let stamp = |_: usize, t: f64| {
                    let ms = (t * 1e3).round() as u64 + 54_201;
                    format!("2021-07-30 13:28:{:02},{}", ms / 1000 % 60, ms % 1000)
                };
                (format!("{name}.csv"), table(m, "Timestamp,Milliseconds,X,Y,Z\n", ',', stamp, &[pick], ""))
            };
            Some(vec![file("Accelerometer", acc), file("Gyroscope", gyro)])
        }
        "headerless" => one("imu.log", table(m, "", ' ', seconds, &[acc, gyro], "")),
        "spresense" => one("log_imu.txt", spresense(m)),
        _ => None,
    }
}

fn gyroflow(m: &Motion<'_>) -> Vec<u8> {
    let (gscale, ascale) = (1e-5, 1e-5);
    let mut out = format!(
        "GYROFLOW IMU LOG\nversion,1.3\nid,shisei\norientation,XYZ\ntimestamp,1644159993\nvendor,shisei\ntscale,0.000001\n\
         gscale,{gscale}\nascale,{ascale}\nt,gx,gy,gz,ax,ay,az\n"
    );
    for (i, t) in m.time_s.iter().enumerate() {
        let [gx, gy, gz] = gyro(m, i).map(|v| (v / gscale).round());
        let [ax, ay, az] = acc_g(m, i).map(|v| (v / ascale).round());
        let _ = writeln!(out, "{},{gx},{gy},{gz},{ax},{ay},{az}", (t * 1e6).round());
    }
    out.into_bytes()
}

fn spresense(m: &Motion<'_>) -> Vec<u8> {
    let mut out = String::new();
    for (i, t) in m.time_s.iter().enumerate() {
        let ticks = ((t * 19_200_000.0).round() as u64 + 0xFFF0_0000) as u32;
        let _ = write!(out, "{ticks:08x},{:08x}", 25.5f32.to_bits());
        for v in gyro(m, i).into_iter().chain(acc(m, i)) {
            let _ = write!(out, ",{:08x}", (v as f32).to_bits());
        }
        out.push('\n');
    }
    out.into_bytes()
}
