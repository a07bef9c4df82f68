//! Named coordinate frames of a space and the transforms between them.
//!
//! | frame | handed | x | y | z | up |
//! |---|---|---|---|---|---|
//! | [`Axes::ZUp`] (shisei) | right | x | y | z | z |
//! | [`Axes::YUp`] (Motive, glTF, OpenSim) | right | x | z | −y | y |
//! | [`Axes::UnityYUp`] (Unity) | left | −x | z | −y | y |
//!
//! The table gives each frame's axes in those of shisei: a point (x, y, z) of shisei is (x, z, −y) in Motive
//! and (−x, z, −y) in Unity. From Motive to Unity x changes its sign, as OptiTrack's own Unity plugin does.
//! All transforms are signed permutations: exact, and back again to the bit.
//!
//! A rotation can be carried over in two ways. [`Change::rotation`] renames the axes of the world and those of
//! the body, so that no rotation stays no rotation; between frames of different hand there is no other way.
//! [`Change::world_of`] renames the world's axes only and leaves those of the body, which a sensor is fixed
//! to, as they are.

use crate::error::{Error, Result};
use crate::quaternion::Quaternion;
use crate::vector::{self, Vec3};

/// √½, correctly rounded.
const HALF_ROOT: f64 = core::f64::consts::FRAC_1_SQRT_2;

/// Where something is and how it is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Position of the body's origin in the world, m.
    pub position_m: Vec3,
    /// Turns body coordinates into world coordinates; unit norm.
    pub world_from_body: Quaternion,
}

/// A frame of the table above.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axes {
    /// Right-handed, z up: shisei's own, and Motive's when it exports Z-up.
    #[default]
    ZUp,
    /// Right-handed, y up: Motive's, glTF's and OpenSim's.
    YUp,
    /// Left-handed, y up: Unity's.
    UnityYUp,
}

impl Axes {
    /// All three.
    pub const ALL: [Axes; 3] = [Axes::ZUp, Axes::YUp, Axes::UnityYUp];

    /// The name users write: `z-up`, `y-up`, `unity`.
    pub fn name(self) -> &'static str {
        match self {
            Axes::ZUp => "z-up",
            Axes::YUp => "y-up",
            Axes::UnityYUp => "unity",
        }
    }

    /// The frame of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Axes::ALL.into_iter().find(|axes| axes.name() == name)
    }

    /// Up, in this frame's coordinates.
    pub fn up(self) -> Vec3 {
        match self {
            Axes::ZUp => [0.0, 0.0, 1.0],
            Axes::YUp | Axes::UnityYUp => [0.0, 1.0, 0.0],
        }
    }

    /// The change of coordinates from this frame to another.
    pub fn to(self, other: Axes) -> Change {
        Change { from: self, to: other }
    }
}

/// A change of coordinates from one frame to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Change {
    /// The frame of what goes in.
    pub from: Axes,
    /// The frame of what comes out.
    pub to: Axes,
}

impl Change {
    /// A position, velocity, acceleration or force.
    pub fn vector(self, v: Vec3) -> Vec3 {
        let [x, y, z] = match self.from {
            Axes::ZUp => v,
            Axes::YUp => [v[0], -v[2], v[1]],
            Axes::UnityYUp => [-v[0], -v[2], v[1]],
        };
        match self.to {
            Axes::ZUp => [x, y, z],
            Axes::YUp => [x, z, -y],
            Axes::UnityYUp => [-x, z, -y],
        }
    }

    /// An angular rate or another axial vector: a mirror turns it round.
    pub fn axial(self, v: Vec3) -> Vec3 {
        let moved = self.vector(v);
        if self.mirrors() { vector::scale(moved, -1.0) } else { moved }
    }

    /// A rotation, the axes of the world and of the body renamed alike.
    pub fn rotation(self, world_from_body: Quaternion) -> Quaternion {
        let q = world_from_body;
        let [x, y, z] = self.axial([q.x, q.y, q.z]);
        Quaternion::new(q.w, x, y, z)
    }

    /// A rotation, the axes of the world renamed and those of the body kept. Refused
    /// ([`Error::NotARotation`]) between a right-handed and a left-handed frame.
    pub fn world_of(self, world_from_body: Quaternion) -> Result<Quaternion> {
        if self.mirrors() {
            return Err(Error::NotARotation);
        }
        Ok(self.turn().product(world_from_body))
    }

    /// Position and rotation, the axes of the world and of the body renamed alike.
    pub fn pose(self, pose: Pose) -> Pose {
        Pose {
            position_m: self.vector(pose.position_m),
            world_from_body: self.rotation(pose.world_from_body),
        }
    }

    /// Position and rotation, the axes of the world renamed only; refused as [`Change::world_of`].
    pub fn world_of_pose(self, pose: Pose) -> Result<Pose> {
        Ok(Pose {
            position_m: self.vector(pose.position_m),
            world_from_body: self.world_of(pose.world_from_body)?,
        })
    }

    /// The way back.
    pub fn inverse(self) -> Change {
        Change { from: self.to, to: self.from }
    }

    fn mirrors(self) -> bool {
        (self.from == Axes::UnityYUp) != (self.to == Axes::UnityYUp)
    }

    /// `to_from_from` of two right-handed frames: a quarter turn about x, or none.
    fn turn(self) -> Quaternion {
        match (self.from, self.to) {
            (Axes::YUp, Axes::ZUp) => Quaternion::new(HALF_ROOT, HALF_ROOT, 0.0, 0.0),
            (Axes::ZUp, Axes::YUp) => Quaternion::new(HALF_ROOT, -HALF_ROOT, 0.0, 0.0),
            _ => Quaternion::IDENTITY,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Vec3, b: Vec3) -> bool {
        vector::norm(vector::sub(a, b)) < 1e-15
    }

    fn some_rotation() -> Quaternion {
        Quaternion::new(0.5, -0.1, 0.7, 0.2).normalized()
    }

    /// Points with a meaning: one step to Motive's right (x), up (y) and towards the viewer (z).
    #[test]
    fn the_table() {
        let to_shisei = Axes::YUp.to(Axes::ZUp);
        assert_eq!(to_shisei.vector([1.0, 2.0, 3.0]), [1.0, -3.0, 2.0]);
        // OptiTrack's Unity plugin (OptitrackStreamingClient.cs): position (−x, y, z), quaternion
        // (−x, y, z, −w), which is (x, −y, −z, w) with all signs changed
        let to_unity = Axes::YUp.to(Axes::UnityYUp);
        assert_eq!(to_unity.vector([1.0, 2.0, 3.0]), [-1.0, 2.0, 3.0]);
        let q = Quaternion::new(0.1, 0.2, 0.3, 0.4);
        assert_eq!(to_unity.rotation(q), Quaternion::new(0.1, 0.2, -0.3, -0.4));
        for from in Axes::ALL {
            for to in Axes::ALL {
                assert_eq!(from.to(to).vector(from.up()), to.up());
            }
            assert_eq!(Axes::from_name(from.name()), Some(from));
        }
    }

    #[test]
    fn there_and_back_is_exact() {
        let pose = Pose { position_m: [0.1, -2.3, 4.5], world_from_body: some_rotation() };
        for from in Axes::ALL {
            for to in Axes::ALL {
                let change = from.to(to);
                assert_eq!(change.inverse().pose(change.pose(pose)), pose);
                assert_eq!(change.inverse().axial(change.axial([1.0, 2.0, 3.0])), [1.0, 2.0, 3.0]);
            }
        }
    }

    /// Rotating and then changing coordinates is changing coordinates and then rotating, mirror or not.
    #[test]
    fn rotations_follow_vectors() {
        let (q, v) = (some_rotation(), [0.3, -0.5, 0.8]);
        for from in Axes::ALL {
            for to in Axes::ALL {
                let change = from.to(to);
                let (here, there) = (change.vector(q.rotate(v)), change.rotation(q).rotate(change.vector(v)));
                assert!(close(here, there), "{change:?}");
            }
        }
    }

    #[test]
    fn only_the_world_is_renamed() {
        let (q, v) = (some_rotation(), [0.3, -0.5, 0.8]);
        for change in [Axes::YUp.to(Axes::ZUp), Axes::ZUp.to(Axes::YUp), Axes::YUp.to(Axes::YUp)] {
            let turned = change.world_of(q).unwrap();
            assert!(close(turned.rotate(v), change.vector(q.rotate(v))), "{change:?}");
            let back = change.inverse().world_of(turned).unwrap();
            assert!(back.conjugate().product(q).angle() < 1e-15);
        }
        assert_eq!(Axes::YUp.to(Axes::UnityYUp).world_of(q), Err(Error::NotARotation));
        assert!(Axes::UnityYUp.to(Axes::UnityYUp).world_of(q).is_ok());
    }
}
