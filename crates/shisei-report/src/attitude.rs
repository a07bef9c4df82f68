//! The small 3-D attitude of a page: a box with its axes that follows the time under the cursor.

use shisei_core::Quaternion;

use crate::column::Column;
use crate::{decimate, encode};

/// Bytes of one row in the page: time f64 and four f32, as base64.
pub(crate) const BYTES_PER_ROW: usize = 32;

/// Attitudes over time.
#[derive(Clone, Debug)]
pub struct AttitudeView<'a> {
    /// Time of each row, s.
    pub time_s: &'a [f64],
    /// Attitude of each row; rows that are not finite are left out.
    pub world_from_body: &'a [Quaternion],
}

impl AttitudeView<'_> {
    /// As a JSON object for the page's script: about evenly spaced rows.
    pub(crate) fn to_json(&self, max_rows: usize) -> String {
        let mut rows = decimate::even_rows(&Column::Slice(self.time_s), max_rows);
        rows.retain(|&r| self.world_from_body.get(r).is_some_and(|q| q.is_finite()));
        let time = rows.iter().filter_map(|&r| self.time_s.get(r).copied());
        let q = rows
            .iter()
            .filter_map(|&r| self.world_from_body.get(r))
            .flat_map(|q| q.to_array().map(|c| c as f32));
        format!(r#"{{"t":"{}","q":"{}"}}"#, encode::f64s(time), encode::f32s(q))
    }
}
