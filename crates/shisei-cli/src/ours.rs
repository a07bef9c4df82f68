//! What lets an existing file be overwritten without `--force`: it is our own earlier result of the same kind.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use shisei_record::{motive, parquet_write};

/// A kind of result.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// CSV with the orientation columns.
    Orientation,
    /// CSV with the recording columns.
    Recording,
    /// A report page.
    Html,
    /// A plot.
    Png,
    /// A calibration.
    Calibration,
    /// A table as Parquet; its footer says who made it.
    Parquet,
    /// CSV with the motion columns.
    Motion,
    /// CSV with the fused columns.
    Fused,
    /// A take as Motive's CSV; its notes say who wrote it.
    Motive,
    /// OpenSim's orientations; a line of their head says who wrote them.
    Sto,
    /// OpenSim's motion; the same.
    Mot,
    /// Binary glTF.
    Glb,
    /// A fused take as MCAP. The recordings of `shisei record` and `live` are none.
    Mcap,
    /// Another table: Allan curves, directions.
    Table,
    /// The bytes of a receiver: never known to be ours.
    Bytes,
}

/// Endings that promise a format, ours and others'.
const PROMISES: &[&str] = &[
    "bin", "csv", "txt", "tsv", "parquet", "html", "htm", "png", "svg", "jpg", "jpeg", "pdf", "json", "sto",
    "mot", "glb", "gltf", "mcap", "xlsx", "xlsm", "xls", "ods", "mat", "npy", "npz", "h5", "gz", "zip",
    "bz2", "xz", "zst",
];

/// Bytes of a file that are looked at.
const HEAD: u64 = 1 << 16;

const RECORDING: &[&str] =
    &["time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z", "time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z,temp_c"];
const ORIENTATION: &[&str] = &[
    "time_s,q_w,q_x,q_y,q_z,yaw_rad,pitch_rad,roll_rad",
    "time_s,q_w,q_x,q_y,q_z,yaw_deg,pitch_deg,roll_deg",
    "time_s,q_w,q_x,q_y,q_z,yaw_rad,pitch_rad,roll_rad,sigma_tilt_rad,sigma_heading_rad,rest",
    "time_s,q_w,q_x,q_y,q_z,yaw_deg,pitch_deg,roll_deg,sigma_tilt_deg,sigma_heading_deg,rest",
];
const MOTION: &[&str] = &["time_s,vel_x,vel_y,vel_z,pos_x,pos_y,pos_z,sigma_pos_m"];
const FUSED: &[&str] = &["frame,time_s,p_x,p_y,p_z,q_w,q_x,q_y,q_z,source,gap_s,sigma_deg,sigma_mm,axes"];
const TABLES: &[&str] = &[
    "axis,tau_s,deviation,low,high,degrees_of_freedom,noise_exponent",
    "gyr_x,gyr_y,gyr_z,sigma_x,sigma_y,sigma_z,acc_x,acc_y,acc_z",
];

impl Kind {
    /// Endings that promise what is written.
    pub fn endings(self) -> &'static [&'static str] {
        match self {
            Kind::Orientation | Kind::Recording => &["csv", "parquet", "txt"],
            Kind::Motion | Kind::Table | Kind::Fused | Kind::Motive => &["csv", "txt"],
            Kind::Html => &["html", "htm"],
            Kind::Png => &["png"],
            Kind::Calibration => &["json"],
            Kind::Parquet => &["parquet"],
            Kind::Sto => &["sto"],
            Kind::Mot => &["mot"],
            Kind::Glb => &["glb"],
            Kind::Mcap => &["mcap"],
            Kind::Bytes => &["bin"],
        }
    }

    /// Whether a file's name promises another format.
    pub fn is_promised_otherwise(self, path: &Path) -> bool {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        ending.is_some_and(|ending| {
            PROMISES.contains(&ending.as_str()) && !self.endings().contains(&ending.as_str())
        })
    }

    /// Whether an existing file is our own result of this kind. One that cannot be read is not.
    pub fn is_ours(self, path: &Path) -> bool {
        if matches!(self, Kind::Parquet) {
            return File::open(path).is_ok_and(|mut file| parquet_write::is_ours(&mut file));
        }
        self.is_head(&head(path))
    }

    fn is_head(self, head: &[u8]) -> bool {
        let has = |needle: &str| head.windows(needle.len()).any(|window| window == needle.as_bytes());
        match self {
            Kind::Orientation => is_table(head, ORIENTATION),
            Kind::Recording => is_table(head, RECORDING),
            Kind::Motion => is_table(head, MOTION),
            Kind::Fused => is_table(head, FUSED),
            Kind::Table => is_table(head, TABLES),
            Kind::Html => has("<meta name=\"generator\" content=\"shisei "),
            Kind::Png => head.starts_with(b"\x89PNG") && has("Software\0shisei "),
            Kind::Motive => motive::is_ours(head),
            Kind::Sto => head.starts_with(b"DataRate=") && ends_our_header(head),
            Kind::Mot => has("\ninDegrees=yes\ngenerator=shisei ") && ends_our_header(head),
            Kind::Glb => head.starts_with(b"glTF") && has("\"generator\":\"shisei "),
            Kind::Mcap => head.starts_with(b"\x89MCAP0\r\n") && has("shisei.FusedFrame"),
            Kind::Calibration => has("\"shisei-calibration\""),
            Kind::Parquet | Kind::Bytes => false,
        }
    }
}

/// Whether a table's header is one of ours, whole, or followed by kept columns: those of a receiver's recordings, or
/// others with their names quoted, which those of a table made by hand or by another program are not beside ours.
fn is_table(head: &[u8], headers: &[&str]) -> bool {
    let line = head.split(|&byte| byte == b'\n').next().unwrap_or_default();
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    headers.iter().any(|ours| {
        line.strip_prefix(ours.as_bytes()).is_some_and(|kept| {
            kept.is_empty() || kept == b",node,boot,seq,frame,from_gate" || kept.starts_with(b",\"")
        })
    })
}

/// Whether the header of an OpenSim table ends with our mark. OpenSim keeps the mark where it writes such a table again,
/// but ends the header otherwise.
fn ends_our_header(head: &[u8]) -> bool {
    let mut lines = head.split(|&byte| byte == b'\n');
    let before = lines.by_ref().take_while(|line| *line != b"endheader").last();
    before.is_some_and(|line| line.starts_with(b"generator=shisei "))
}

/// True for a file with the columns that `orient` writes, with or without others after them.
pub fn is_orientation(path: &Path) -> bool {
    let head = head(path);
    ORIENTATION.iter().any(|ours| head.starts_with(ours.as_bytes()))
}

/// The first bytes of a file, as far as they can be read.
pub fn head(path: &Path) -> Vec<u8> {
    let mut bytes = Vec::new();
    if let Ok(file) = File::open(path) {
        // What cannot be read is not ours, which is the safe answer.
        let _ = file.take(HEAD).read_to_end(&mut bytes);
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_ours_by_its_header() {
        for (header, expected) in [
            ("time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z\n0,", true),
            ("time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z,temp_c\r\n0,", true),
            ("time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z,\"label\"\n0,", true),
            ("time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z,label\n0,", false),
            ("time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z_raw\n0,", false),
            ("\"time_s\",\"acc_x\",\"acc_y\",\"acc_z\",\"gyr_x\",\"gyr_y\",\"gyr_z\"\n0,", false),
            ("", false),
        ] {
            assert_eq!(Kind::Recording.is_head(header.as_bytes()), expected, "{header}");
        }
        // As we write it, and as OpenSim writes it again.
        let ours = b"DataRate=120.000000\nDataType=Quaternion\nversion=3\nOpenSimVersion=4.5\ngenerator=shisei 0.1.0\nendheader\ntime\tTool\n";
        assert!(Kind::Sto.is_head(ours));
        let theirs = b"DataRate=120.000000\ngenerator=shisei 0.1.0\nDataType=Quaternion\nversion=3\nOpenSimVersion=4.6\nendheader\ntime\tTool\n";
        assert!(!Kind::Sto.is_head(theirs));
        let subject = b"time_s,q_w,q_x,q_y,q_z,yaw_rad,pitch_rad,roll_rad,subject\n";
        assert!(!Kind::Orientation.is_head(subject));
    }
}
