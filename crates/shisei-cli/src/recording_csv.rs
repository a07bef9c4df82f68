//! The recording columns as CSV.

use std::io::{self, Write};

use shisei_record::Recording;

use crate::orientation_csv::push_cell;

/// Writes `time_s, acc_x … gyr_z`, `temp_c` where there is one, and the kept columns of the input. Numbers are
/// the shortest that read back to the same bits.
pub fn write(out: &mut dyn Write, recording: &Recording) -> io::Result<()> {
    let mut line = b"time_s,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z".to_vec();
    if recording.temp_c.is_some() {
        line.extend_from_slice(b",temp_c");
    }
    for extra in &recording.extra {
        line.push(b',');
        push_cell(&mut line, &extra.name);
    }
    line.push(b'\n');
    let mut buffer = zmij::Buffer::new();
    for k in 0..recording.len() {
        let (acc, gyro) = (recording.acc_m_s2[k], recording.gyro_rad_s[k]);
        let row = [recording.time_s[k], acc[0], acc[1], acc[2], gyro[0], gyro[1], gyro[2]];
        let temp = recording.temp_c.as_ref().and_then(|all| all.get(k).copied());
        for (column, value) in row.into_iter().chain(temp).enumerate() {
            if column > 0 {
                line.push(b',');
            }
            line.extend_from_slice(buffer.format(value).as_bytes());
        }
        for extra in &recording.extra {
            line.push(b',');
            push_cell(&mut line, extra.cells.get(k).map_or("", |cell| cell));
        }
        line.push(b'\n');
        if line.len() > 1 << 16 {
            out.write_all(&line)?;
            line.clear();
        }
    }
    out.write_all(&line)
}
