//! The fused columns: `frame, time_s, p_x, p_y, p_z, q_w … q_z, source, gap_s, sigma_deg, sigma_mm, axes`.

use std::io::{self, Write};

use shisei_core::frames::Axes;
use shisei_core::fuse::FusedFrame;

use crate::write::{Column, Decimals, csv};

/// Names of the columns.
pub const NAMES: [&str; 14] = [
    "frame",
    "time_s",
    "p_x",
    "p_y",
    "p_z",
    "q_w",
    "q_x",
    "q_y",
    "q_z",
    "source",
    "gap_s",
    "sigma_deg",
    "sigma_mm",
    "axes",
];

/// A fused take, one row a frame.
#[derive(Clone, Copy, Debug)]
pub struct Fused<'a> {
    /// Frame numbers.
    pub frame: &'a [i64],
    /// Time of each frame, s.
    pub time_s: &'a [f64],
    /// The frames, in `from`.
    pub frames: &'a [FusedFrame],
    /// The world the poses are in.
    pub from: Axes,
    /// The world they are written in; between right-handed ones the body keeps its axes.
    pub to: Axes,
}

impl Fused<'_> {
    /// Writes CSV. Numbers are the shortest that read back; what is not known is `NaN`.
    pub fn csv(&self, sink: &mut dyn Write) -> io::Result<()> {
        self.with(|columns| csv(sink, &NAMES, columns, Decimals::Shortest))
    }

    /// Writes Parquet.
    #[cfg(feature = "parquet")]
    pub fn parquet<W: Write + Send>(&self, sink: W) -> io::Result<()> {
        self.with(|columns| crate::parquet_write::parquet(sink, &NAMES, columns))
    }

    fn with<T>(&self, write: impl FnOnce(&[Column<'_>]) -> T) -> T {
        let change = self.from.to(self.to);
        let mut poses = Vec::with_capacity(7 * self.frames.len());
        for frame in self.frames {
            let moved =
                frame.pose.map(|pose| change.world_of_pose(pose).unwrap_or_else(|_| change.pose(pose)));
            let row = moved.map_or([f64::NAN; 7], |pose| {
                let (p, q) = (pose.position_m, pose.world_from_body);
                [p[0], p[1], p[2], q.w, q.x, q.y, q.z]
            });
            poses.extend(row);
        }
        let of = |value: fn(&FusedFrame) -> f64| self.frames.iter().map(value).collect::<Vec<f64>>();
        let number: Vec<f64> = self.frame.iter().map(|frame| *frame as f64).collect();
        let gap = of(|frame| frame.gap_s);
        let sigma_deg = of(|frame| frame.sigma_rad.to_degrees());
        let sigma_mm = of(|frame| frame.sigma_m * 1e3);
        let source: Vec<Box<str>> = self.frames.iter().map(|frame| frame.source.name().into()).collect();
        let axes: Vec<Box<str>> = self.frames.iter().map(|_| self.to.name().into()).collect();
        let mut columns = vec![Column::Numbers(&number), Column::Numbers(self.time_s)];
        for offset in 0..7 {
            columns.push(Column::Strided { values: &poses, stride: 7, offset });
        }
        columns.extend([
            Column::Texts(&source),
            Column::Numbers(&gap),
            Column::Numbers(&sigma_deg),
            Column::Numbers(&sigma_mm),
            Column::Texts(&axes),
        ]);
        write(&columns)
    }
}
