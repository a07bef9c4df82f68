//! Unit quaternions as rotations.
//!
//! Hamilton's product, order w, x, y, z. A quaternion named `a_from_b` turns coordinates in frame b into
//! coordinates in frame a: `v_a = q v_b q*`.

use crate::error::{Error, Result};
use crate::lanes::Number;
use crate::math;
use crate::vector::{self, Vec3};

/// A squared norm this near to 1 is 1 to rounding: products of two attitudes of the filters stay within half of it.
const UNIT_TO_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Hamilton product `a ⊗ b` of components w, x, y, z, as [`Quaternion::product`].
#[inline(always)]
pub(crate) fn product<T: Number>(a: [T; 4], b: [T; 4]) -> [T; 4] {
    let ([aw, ax, ay, az], [bw, bx, by, bz]) = (a, b);
    [
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    ]
}

/// A quaternion w + xi + yj + zk; of unit norm unless a function says otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quaternion {
    /// Scalar part, cos(angle/2).
    pub w: f64,
    /// x of the vector part, axis · sin(angle/2).
    pub x: f64,
    /// y of the vector part.
    pub y: f64,
    /// z of the vector part.
    pub z: f64,
}

impl From<Quaternion> for [f64; 4] {
    /// `[w, x, y, z]`.
    #[inline]
    fn from(q: Quaternion) -> Self {
        q.to_array()
    }
}

impl From<[f64; 4]> for Quaternion {
    /// From `[w, x, y, z]`; not normalised.
    #[inline]
    fn from(q: [f64; 4]) -> Self {
        Quaternion::from_array(q)
    }
}

impl Quaternion {
    /// No rotation.
    pub const IDENTITY: Quaternion = Quaternion { w: 1.0, x: 0.0, y: 0.0, z: 0.0 };

    /// From components; not normalised.
    #[inline(always)]
    pub const fn new(w: f64, x: f64, y: f64, z: f64) -> Self {
        Quaternion { w, x, y, z }
    }

    /// From `[w, x, y, z]`; not normalised.
    #[inline(always)]
    pub const fn from_array(q: [f64; 4]) -> Self {
        Quaternion { w: q[0], x: q[1], y: q[2], z: q[3] }
    }

    /// `[w, x, y, z]`.
    #[inline(always)]
    pub const fn to_array(self) -> [f64; 4] {
        [self.w, self.x, self.y, self.z]
    }

    /// From a quaternion given by a user: divided by its norm, save where that is 1 to rounding (what the filters give out is
    /// taken in with the same bits); refused when not finite or zero.
    pub fn try_normalized(self) -> Result<Self> {
        if !self.is_finite() {
            return Err(Error::NotFinite { row: 0 });
        }
        let largest = self.w.abs().max(self.x.abs()).max(self.y.abs()).max(self.z.abs());
        if largest == 0.0 {
            return Err(Error::ZeroQuaternion { row: 0 });
        }
        // Scale first only where squares would over- or underflow, so that ordinary input keeps its bits.
        let q = if (1e-100..1e100).contains(&largest) {
            self
        } else {
            Quaternion::new(self.w / largest, self.x / largest, self.y / largest, self.z / largest)
        };
        Ok(q.unit())
    }

    /// Divided by its norm, save where that is 1 to rounding: what the filters give out is taken in with the same bits.
    /// The caller knows that it is neither zero nor huge.
    #[inline(always)]
    pub(crate) fn unit(self) -> Self {
        let square = self.norm_squared();
        let n = if (square - 1.0).abs() <= UNIT_TO_ROUNDING { 1.0 } else { math::sqrt(square) };
        Quaternion::new(self.w / n, self.x / n, self.y / n, self.z / n)
    }

    /// Divided by its norm. The caller knows that it is neither zero nor huge.
    #[inline(always)]
    pub fn normalized(self) -> Self {
        let n = math::sqrt(self.norm_squared());
        Quaternion::new(self.w / n, self.x / n, self.y / n, self.z / n)
    }

    /// w² + x² + y² + z².
    #[inline(always)]
    pub fn norm_squared(self) -> f64 {
        (self.w * self.w + self.x * self.x) + (self.y * self.y + self.z * self.z)
    }

    /// q*, the inverse rotation of a unit quaternion.
    #[inline(always)]
    pub fn conjugate(self) -> Self {
        Quaternion::new(self.w, -self.x, -self.y, -self.z)
    }

    /// Hamilton product `self ⊗ other`: first `other`, then `self`.
    #[inline(always)]
    pub fn product(self, other: Self) -> Self {
        Quaternion::from_array(product(self.to_array(), other.to_array()))
    }

    /// `q v q*`: coordinates of v in the left frame.
    #[inline]
    pub fn rotate(self, v: Vec3) -> Vec3 {
        let u = [self.x, self.y, self.z];
        let t = vector::scale(vector::cross(u, v), 2.0);
        vector::add(vector::add(v, vector::scale(t, self.w)), vector::cross(u, t))
    }

    /// Rotation by `angle_rad` about an axis of any length; refused when the axis is zero or not finite.
    pub fn from_axis_angle(axis: Vec3, angle_rad: f64) -> Result<Self> {
        if !vector::is_finite(axis) || !angle_rad.is_finite() {
            return Err(Error::NotFinite { row: 0 });
        }
        let largest = axis[0].abs().max(axis[1].abs()).max(axis[2].abs());
        if largest == 0.0 {
            return Err(Error::ZeroAxis);
        }
        let a = [axis[0] / largest, axis[1] / largest, axis[2] / largest];
        let (sin, cos) = math::sin_cos(0.5 * angle_rad);
        let s = sin / vector::norm(a);
        Ok(Quaternion::new(cos, a[0] * s, a[1] * s, a[2] * s))
    }

    /// Exp of a rotation vector (axis · angle, rad); exact at zero.
    pub fn from_rotation_vector(v_rad: Vec3) -> Self {
        let angle = vector::norm(v_rad);
        let (sin, cos) = math::sin_cos(0.5 * angle);
        // sin(θ/2)/θ; below 1e-8 rad the next term of its series is under half an ulp
        let s = if angle < 1e-8 { 0.5 } else { sin / angle };
        Quaternion::new(cos, v_rad[0] * s, v_rad[1] * s, v_rad[2] * s)
    }

    /// Log: the rotation vector (axis · angle, rad) with angle in 0 … π.
    pub fn to_rotation_vector(self) -> Vec3 {
        let q = if self.w < 0.0 { self.negated() } else { self };
        let u = [q.x, q.y, q.z];
        let sin = vector::norm(u);
        let s = if sin < 1e-150 { 2.0 } else { 2.0 * math::atan2(sin, q.w) / sin };
        vector::scale(u, s)
    }

    /// Unit axis and angle in 0 … π, rad; the axis of no rotation is x.
    pub fn to_axis_angle(self) -> (Vec3, f64) {
        let q = if self.w < 0.0 { self.negated() } else { self };
        let u = [q.x, q.y, q.z];
        let sin = vector::norm(u);
        if sin < 1e-150 {
            return ([1.0, 0.0, 0.0], 0.0);
        }
        ([u[0] / sin, u[1] / sin, u[2] / sin], 2.0 * math::atan2(sin, q.w))
    }

    /// The same rotation with all signs changed.
    #[inline]
    pub fn negated(self) -> Self {
        Quaternion::new(-self.w, -self.x, -self.y, -self.z)
    }

    /// The rotation matrix, rows first: `v_a = R v_b`.
    pub fn to_matrix(self) -> [[f64; 3]; 3] {
        let Quaternion { w, x, y, z } = self;
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    }

    /// From a rotation matrix (Shepperd's choice of the largest component, w ≥ 0); refused when a row's
    /// product with another is off by more than 1e-6 or the matrix is left-handed.
    pub fn from_matrix(r: [[f64; 3]; 3]) -> Result<Self> {
        for i in 0..3 {
            if !vector::is_finite(r[i]) {
                return Err(Error::NotFinite { row: i });
            }
            for j in 0..3 {
                let expected = if i == j { 1.0 } else { 0.0 };
                if (vector::dot(r[i], r[j]) - expected).abs() > 1e-6 {
                    return Err(Error::NotARotation);
                }
            }
        }
        if vector::dot(r[0], vector::cross(r[1], r[2])) < 0.0 {
            return Err(Error::NotARotation);
        }
        let trace = r[0][0] + r[1][1] + r[2][2];
        let q = if trace >= r[0][0] && trace >= r[1][1] && trace >= r[2][2] {
            Quaternion::new(1.0 + trace, r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1])
        } else if r[0][0] >= r[1][1] && r[0][0] >= r[2][2] {
            let s = 1.0 + r[0][0] - r[1][1] - r[2][2];
            Quaternion::new(r[2][1] - r[1][2], s, r[0][1] + r[1][0], r[0][2] + r[2][0])
        } else if r[1][1] >= r[2][2] {
            let s = 1.0 - r[0][0] + r[1][1] - r[2][2];
            Quaternion::new(r[0][2] - r[2][0], r[0][1] + r[1][0], s, r[1][2] + r[2][1])
        } else {
            let s = 1.0 - r[0][0] - r[1][1] + r[2][2];
            Quaternion::new(r[1][0] - r[0][1], r[0][2] + r[2][0], r[1][2] + r[2][1], s)
        };
        let q = q.normalized();
        Ok(if q.w < 0.0 { q.negated() } else { q })
    }

    /// Spherical interpolation on the shorter arc: `a` at t = 0, `b` at t = 1; t outside extrapolates.
    pub fn slerp(a: Self, b: Self, t: f64) -> Self {
        let step = a.conjugate().product(b).to_rotation_vector();
        a.product(Quaternion::from_rotation_vector(vector::scale(step, t)))
    }

    /// Normalised linear interpolation on the shorter arc.
    pub fn nlerp(a: Self, b: Self, t: f64) -> Self {
        let dot = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
        let b = if dot < 0.0 { b.negated() } else { b };
        let s = 1.0 - t;
        Quaternion::new(s * a.w + t * b.w, s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z)
            .normalized()
    }

    /// World z in body coordinates, `q* (0,0,1) q`: what a resting accelerometer reads, divided by g.
    #[inline]
    pub fn up_body(self) -> Vec3 {
        let Quaternion { w, x, y, z } = self;
        [2.0 * (x * z - w * y), 2.0 * (w * x + y * z), (w * w + z * z) - (x * x + y * y)]
    }

    /// The angle of the rotation, rad in 0 … π.
    pub fn angle(self) -> f64 {
        2.0 * math::atan2(vector::norm([self.x, self.y, self.z]), self.w.abs())
    }

    /// True when all four components are finite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.w.is_finite() && self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }
}
