//! Moving bodies as files of other programs: our fused columns, OpenSim, glTF.

pub mod fused;
pub mod gltf;
pub mod opensim;

use shisei_core::frames::{Axes, Pose};

/// A body over time. Rows without a pose are left out of the files, whose readers interpolate.
#[derive(Clone, Copy, Debug)]
pub struct Track<'a> {
    /// Its name.
    pub name: &'a str,
    /// Time of each row, s, ascending.
    pub time_s: &'a [f64],
    /// Its pose in each row.
    pub poses: &'a [Option<Pose>],
    /// The world they are in; right-handed.
    pub axes: Axes,
}

impl Track<'_> {
    /// Time and pose of the rows that have one, the world's axes renamed to another right-handed world's.
    pub fn rows(&self, to: Axes) -> impl Iterator<Item = (f64, Pose)> + '_ {
        let change = self.axes.to(to);
        let rows = self.time_s.iter().zip(self.poses);
        rows.filter_map(move |(time_s, pose)| Some((*time_s, change.world_of_pose((*pose)?).ok()?)))
    }
}
