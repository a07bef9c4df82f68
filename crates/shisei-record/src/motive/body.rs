//! Which columns make a body or a marker, and their values in metres and quaternions.

use shisei_core::frames::Pose;
use shisei_core::{Quaternion, Vec3, math};

use super::error::{Problem, Result};
use super::take::{Column, Rotation, Take};

const DEG: f64 = core::f64::consts::PI / 180.0;
/// Written poses have six digits after the point, as Motive's own.
const DIGITS: f64 = 1e6;

/// A rigid body or a bone.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Its name; a bone's is `SKELETON:BONE`.
    pub name: String,
    /// Motive's identifier.
    pub id: String,
    /// Its parent's name, where the take says it.
    pub parent: String,
    /// True for a bone of a skeleton.
    pub is_bone: bool,
    /// Columns of X, Y, Z and, of quaternions, W.
    rotation: [usize; 3],
    w: Option<usize>,
    position: [usize; 3],
    /// Column of the mean marker error.
    error: Option<usize>,
    form: Rotation,
    lengths_in_m: f64,
}

impl Body {
    /// All columns of the pose.
    pub(super) fn columns(&self) -> Vec<usize> {
        self.rotation.into_iter().chain(self.w).chain(self.position).collect()
    }
}

/// Where a marker's positions come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkerKind {
    /// From the solved body: filled even while the marker is hidden.
    Solved,
    /// Seen by the cameras and named after a body or skeleton (`NAME:MARKER`).
    Labeled,
    /// Seen by the cameras, without a name.
    Single,
}

/// A marker.
#[derive(Clone, Debug, PartialEq)]
pub struct Marker {
    /// Its name.
    pub name: String,
    /// Motive's identifier.
    pub id: String,
    /// Where its positions come from.
    pub kind: MarkerKind,
    position: [usize; 3],
    lengths_in_m: f64,
}

/// Columns of one kind, name and id that follow each other.
struct Group<'a> {
    head: &'a Column,
    /// Quantity and axis, lower case, and the column's number.
    members: Vec<(String, String, usize)>,
}

impl Group<'_> {
    fn find(&self, quantity: &str, axis: &str) -> Option<usize> {
        self.members.iter().find(|(q, a, _)| q == quantity && a == axis).map(|(_, _, column)| *column)
    }

    fn three(&self, quantity: &str) -> Option<[usize; 3]> {
        Some([self.find(quantity, "x")?, self.find(quantity, "y")?, self.find(quantity, "z")?])
    }
}

impl Take {
    fn groups(&self) -> Vec<Group<'_>> {
        let mut groups: Vec<Group<'_>> = Vec::new();
        for (number, column) in self.columns.iter().enumerate() {
            let member = (column.quantity.trim().to_lowercase(), column.axis.trim().to_lowercase(), number);
            let same = |group: &Group<'_>| {
                (&group.head.kind, &group.head.name, &group.head.id)
                    == (&column.kind, &column.name, &column.id)
                    && group.find(&member.0, &member.1).is_none()
            };
            match groups.last_mut().filter(|group| same(group)) {
                Some(group) => group.members.push(member),
                None => groups.push(Group { head: column, members: vec![member] }),
            }
        }
        groups
    }

    /// Bodies and bones, in the order of the file. Refused: an unknown unit or rotation type.
    pub fn bodies(&self) -> Result<Vec<Body>> {
        let (form, lengths_in_m) = (self.rotation()?, self.lengths_in_m()?);
        let bodies = self.groups().into_iter().filter_map(|group| {
            let (rotation, position) = (group.three("rotation")?, group.three("position")?);
            let w = group.find("rotation", "w");
            // Columns decide where they and the first row disagree.
            let form = match (form, w) {
                (_, Some(_)) => Rotation::Quaternion,
                (Rotation::Quaternion, None) => Rotation::Euler([0, 1, 2]),
                (form, None) => form,
            };
            let error = group.members.iter().find(|(quantity, _, _)| quantity.contains("error"));
            Some(Body {
                name: group.head.name.to_string(),
                id: group.head.id.to_string(),
                parent: group.head.parent.to_string(),
                is_bone: group.head.kind.to_lowercase().contains("bone"),
                rotation,
                w,
                position,
                error: error.map(|(_, _, column)| *column),
                form,
                lengths_in_m,
            })
        });
        Ok(bodies.collect())
    }

    /// The body of a name (letter case aside where that is clear), or the only one. Refused: no bodies, several
    /// and none named, no such name, a bone that was exported relative to its parent.
    pub fn body(&self, name: Option<&str>) -> Result<Body> {
        let mut bodies = self.bodies()?;
        let names = |bodies: &[Body]| bodies.iter().map(|body| body.name.clone()).collect::<Vec<_>>();
        let found = match name {
            _ if bodies.is_empty() => return Err(self.refuse(Problem::NoBodies)),
            None if bodies.len() == 1 => 0,
            None => return Err(self.refuse(Problem::ManyBodies { names: names(&bodies) })),
            Some(name) => {
                let exact = bodies.iter().position(|body| body.name == name);
                let lower = name.to_lowercase();
                let alike = || bodies.iter().position(|body| body.name.to_lowercase() == lower);
                let Some(index) = exact.or_else(alike) else {
                    let problem = Problem::NoSuchBody { asked: name.to_owned(), names: names(&bodies) };
                    return Err(self.refuse(problem));
                };
                index
            }
        };
        let body = bodies.swap_remove(found);
        if body.is_bone && self.is_local() {
            return Err(self.refuse(Problem::LocalBones));
        }
        Ok(body)
    }

    /// Markers, in the order of the file. Refused: an unknown unit.
    pub fn markers(&self) -> Result<Vec<Marker>> {
        let lengths_in_m = self.lengths_in_m()?;
        let markers = self.groups().into_iter().filter_map(|group| {
            if group.three("rotation").is_some() {
                return None;
            }
            let position = group.three("position")?;
            let (kind, name) = (group.head.kind.to_lowercase(), group.head.name.to_string());
            let kind = if kind.contains("body marker") || kind.contains("bone marker") {
                MarkerKind::Solved
            } else if name.to_lowercase().starts_with("unlabeled") || !name.contains(':') {
                MarkerKind::Single
            } else {
                MarkerKind::Labeled
            };
            Some(Marker { name, id: group.head.id.to_string(), kind, position, lengths_in_m })
        });
        Ok(markers.collect())
    }

    /// The labelled markers of a rigid body, in the order of the file; none for a bone, whose skeleton's markers do not
    /// sit still on it. Refused: an unknown unit.
    pub fn markers_of(&self, body: &Body) -> Result<Vec<Marker>> {
        let own = |marker: &Marker| {
            let rest = marker.name.strip_prefix(body.name.as_str());
            marker.kind == MarkerKind::Labeled && rest.is_some_and(|rest| rest.starts_with(':'))
        };
        Ok(self.markers()?.into_iter().filter(|marker| !body.is_bone && own(marker)).collect())
    }

    fn cell(&self, column: usize, row: usize) -> f64 {
        self.columns.get(column).and_then(|c| c.cells.get(row)).copied().unwrap_or(f64::NAN)
    }

    /// The pose in a row, m, in the take's axes; none where a cell is blank or the quaternion is zero. Frozen
    /// poses are told by [`Take::tracked`].
    pub fn pose(&self, body: &Body, row: usize) -> Option<Pose> {
        let r = body.rotation.map(|column| self.cell(column, row));
        let p = body.position.map(|column| self.cell(column, row) / body.lengths_in_m);
        if !r.iter().chain(&p).all(|value| value.is_finite()) {
            return None;
        }
        let world_from_body = match (body.form, body.w) {
            (Rotation::Euler(order), _) => from_euler(order, r),
            (Rotation::Quaternion, w) => {
                let w = self.cell(w?, row);
                Quaternion::new(w, r[0], r[1], r[2]).try_normalized().ok()?
            }
        };
        Some(Pose { position_m: p, world_from_body })
    }

    /// Writes a pose into a row, rounded to the sixth digit after the point in the take's own unit; a pose that
    /// is not finite, and a row that is not there, change nothing.
    pub fn set_pose(&mut self, body: &Body, row: usize, pose: &Pose) {
        let q = pose.world_from_body;
        if !q.is_finite() || !pose.position_m.iter().all(|value| value.is_finite()) {
            return;
        }
        let mut set = |column: usize, value: f64| {
            if let Some(cell) = self.columns.get_mut(column).and_then(|c| c.cells.get_mut(row)) {
                *cell = math::round(value * DIGITS) / DIGITS;
            }
        };
        let rotation = match body.form {
            Rotation::Quaternion => [q.x, q.y, q.z],
            Rotation::Euler(order) => to_euler(order, q),
        };
        for axis in 0..3 {
            set(body.rotation[axis], rotation[axis]);
            set(body.position[axis], pose.position_m[axis] * body.lengths_in_m);
        }
        if let Some(w) = body.w {
            set(w, q.w);
        }
    }

    /// The mean distance of the body's markers from where the pose puts them, m; none where it is not given.
    pub fn marker_error_m(&self, body: &Body, row: usize) -> Option<f64> {
        let value = self.cell(body.error?, row) / body.lengths_in_m;
        value.is_finite().then_some(value)
    }

    /// A marker's position in a row, m, in the take's axes; none where it was not seen.
    pub fn marker_m(&self, marker: &Marker, row: usize) -> Option<Vec3> {
        let p = marker.position.map(|column| self.cell(column, row) / marker.lengths_in_m);
        p.iter().all(|value| value.is_finite()).then_some(p)
    }
}

/// R = R_a R_b R_c for the order a, b, c; `degrees` by axis.
fn from_euler(order: [usize; 3], degrees: Vec3) -> Quaternion {
    let about = |axis: usize| {
        let mut v = [0.0; 3];
        v[axis] = degrees[axis] * DEG;
        Quaternion::from_rotation_vector(v)
    };
    about(order[0]).product(about(order[1])).product(about(order[2]))
}

/// Degrees by axis; where the middle angle is a right angle, the last one is 0.
fn to_euler(order: [usize; 3], q: Quaternion) -> Vec3 {
    let m = q.to_matrix();
    let [a, b, c] = order;
    // +1 for the even permutations (x y z and its rotations)
    let sign = if (a + 1) % 3 == b { 1.0 } else { -1.0 };
    let across = math::hypot(m[a][a], m[a][b]);
    let middle = math::atan2(sign * m[a][c], across);
    let (first, last) = if across > 1e-9 {
        (math::atan2(-sign * m[b][c], m[c][c]), math::atan2(-sign * m[a][b], m[a][a]))
    } else {
        (math::atan2(sign * m[c][b], m[b][b]), 0.0)
    };
    let mut degrees = [0.0; 3];
    degrees[a] = first / DEG;
    degrees[b] = middle / DEG;
    degrees[c] = last / DEG;
    degrees
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn euler_angles_there_and_back_in_all_orders() {
        for order in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]] {
            for degrees in [[10.0, 20.0, 30.0], [-170.0, 80.0, 5.0], [0.0, -60.0, 120.0]] {
                let q = from_euler(order, degrees);
                let back = from_euler(order, to_euler(order, q));
                assert!(back.conjugate().product(q).angle() < 1e-12, "{order:?} {degrees:?}");
            }
            // the middle angle at a right angle
            let mut degrees = [25.0; 3];
            degrees[order[1]] = 90.0;
            let q = from_euler(order, degrees);
            let back = from_euler(order, to_euler(order, q));
            assert!(back.conjugate().product(q).angle() < 1e-7, "{order:?}");
        }
    }

    /// qx(10°) ⊗ qy(20°) ⊗ qz(30°), multiplied out with Python's math module.
    #[test]
    fn euler_xyz_is_intrinsic() {
        let q = from_euler([0, 1, 2], [10.0, 20.0, 30.0]);
        let expected = [
            0.943_714_364_147_489,
            0.127_679_440_695_780_63,
            0.144_878_125_417_369_16,
            0.268_535_822_751_569_3,
        ];
        for (found, expected) in q.to_array().iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{q:?}");
        }
    }
}
