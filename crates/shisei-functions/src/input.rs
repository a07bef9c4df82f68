//! Argument types. Each says its shape and how it is read from what a door hands over.

use crate::error::{Error, Result};
use crate::value::{Input, Range, Shape};
use shisei_core::{Quaternion, Vec3};

/// A type that can be an argument of a worksheet function.
pub trait FromInput<'a>: Sized {
    /// The shape it is read from.
    const SHAPE: Shape;

    /// Reads the argument `arg`; refuses a wrong shape, a number that is not finite and, where a rotation is
    /// needed, a zero quaternion.
    fn from_input(input: Input<'a>, arg: &'static str) -> Result<Self>;
}

impl<'a> FromInput<'a> for f64 {
    const SHAPE: Shape = Shape::Number;

    fn from_input(input: Input<'a>, arg: &'static str) -> Result<f64> {
        let [number] = vector::<1>(input, arg, Self::SHAPE)?;
        if number.is_finite() { Ok(number) } else { Err(not_finite(arg, 0)) }
    }
}

/// A vector of three finite numbers, as a row or a column.
#[derive(Clone, Copy, Debug)]
pub struct FiniteVec3(pub Vec3);

impl<'a> FromInput<'a> for FiniteVec3 {
    const SHAPE: Shape = Shape::Vector(3);

    fn from_input(input: Input<'a>, arg: &'static str) -> Result<Self> {
        let v = vector::<3>(input, arg, Self::SHAPE)?;
        if v.iter().all(|x| x.is_finite()) { Ok(FiniteVec3(v)) } else { Err(not_finite(arg, 0)) }
    }
}

impl RawQuat {
    /// The quaternion, refused when a component is not finite.
    pub fn finite(self, arg: &'static str) -> Result<Quaternion> {
        if self.0.is_finite() { Ok(self.0) } else { Err(not_finite(arg, 0)) }
    }
}

/// Three numbers as they stand, for `IsFiniteVec3`.
impl<'a> FromInput<'a> for Vec3 {
    const SHAPE: Shape = Shape::Vector(3);

    fn from_input(input: Input<'a>, arg: &'static str) -> Result<Self> {
        vector::<3>(input, arg, Self::SHAPE)
    }
}

/// Four numbers w, x, y, z as they stand: neither normalised nor checked.
#[derive(Clone, Copy, Debug)]
pub struct RawQuat(pub Quaternion);

impl<'a> FromInput<'a> for RawQuat {
    const SHAPE: Shape = Shape::Vector(4);

    fn from_input(input: Input<'a>, arg: &'static str) -> Result<Self> {
        Ok(RawQuat(Quaternion::from_array(vector::<4>(input, arg, Self::SHAPE)?)))
    }
}

/// A quaternion w, x, y, z as a row or a column, normalised on entry.
#[derive(Clone, Copy, Debug)]
pub struct UnitQuat(pub Quaternion);

impl<'a> FromInput<'a> for UnitQuat {
    const SHAPE: Shape = Shape::Vector(4);

    fn from_input(input: Input<'a>, arg: &'static str) -> Result<Self> {
        let RawQuat(q) = RawQuat::from_input(input, arg)?;
        q.try_normalized().map(UnitQuat).map_err(|error| Error::InArgument { arg, error })
    }
}

/// A series of N numbers a row, all finite; borrowed.
#[derive(Clone, Copy, Debug)]
pub struct Series<'a, const N: usize> {
    /// One sample a row.
    pub rows: &'a [[f64; N]],
}

impl<'a, const N: usize> FromInput<'a> for Series<'a, N> {
    const SHAPE: Shape = Shape::Series(N);

    fn from_input(input: Input<'a>, arg: &'static str) -> Result<Self> {
        let range = range(input, arg, Self::SHAPE)?;
        let (rows, rest) = range.data().as_chunks::<N>();
        if range.rows() == 0 {
            return Err(Error::InArgument { arg, error: shisei_core::Error::Empty });
        }
        if range.cols() != N || !rest.is_empty() {
            return Err(wrong_shape(arg, Self::SHAPE, range));
        }
        match first_not_finite(range) {
            Some(row) => Err(not_finite(arg, row)),
            None => Ok(Series { rows }),
        }
    }
}

/// Accelerations (3 columns) or accelerations and rates (6 columns), as `ApplyIMUCalib` takes them.
#[derive(Clone, Copy, Debug)]
pub enum SixColumns<'a> {
    /// N×3.
    Three(Series<'a, 3>),
    /// N×6.
    Six(Series<'a, 6>),
}

impl<'a> FromInput<'a> for SixColumns<'a> {
    const SHAPE: Shape = Shape::SeriesEither(3, 6);

    fn from_input(input: Input<'a>, arg: &'static str) -> Result<Self> {
        let range = range(input, arg, Self::SHAPE)?;
        match range.cols() {
            3 => Series::from_input(input, arg).map(SixColumns::Three),
            6 => Series::from_input(input, arg).map(SixColumns::Six),
            _ => Err(wrong_shape(arg, Self::SHAPE, range)),
        }
    }
}

/// Six or twelve calibration parameters, as a row or a column.
#[derive(Clone, Copy, Debug)]
pub enum CalibParameters {
    /// Bias and scale of one sensor.
    Six([f64; 6]),
    /// Bias and scale of both.
    Twelve([f64; 12]),
}

impl<'a> FromInput<'a> for CalibParameters {
    const SHAPE: Shape = Shape::VectorEither(6, 12);

    fn from_input(input: Input<'a>, arg: &'static str) -> Result<Self> {
        let range = range(input, arg, Self::SHAPE)?;
        if let Some(row) = first_not_finite(range) {
            return Err(not_finite(arg, row));
        }
        if range.rows() == 1 || range.cols() == 1 {
            if let Ok(six) = <[f64; 6]>::try_from(range.data()) {
                return Ok(CalibParameters::Six(six));
            }
            if let Ok(twelve) = <[f64; 12]>::try_from(range.data()) {
                return Ok(CalibParameters::Twelve(twelve));
            }
        }
        Err(wrong_shape(arg, Self::SHAPE, range))
    }
}

fn vector<const N: usize>(input: Input<'_>, arg: &'static str, shape: Shape) -> Result<[f64; N]> {
    let number;
    let range = match input {
        Input::Number(x) => {
            number = [x];
            Range::new(&number, 1, 1).ok_or(Error::Internal)?
        }
        Input::Missing => return Err(Error::Missing { arg }),
        Input::Range(range) => range,
    };
    let line = range.rows() == 1 || range.cols() == 1;
    match <[f64; N]>::try_from(range.data()) {
        Ok(v) if line => Ok(v),
        _ => Err(wrong_shape(arg, shape, range)),
    }
}

fn range<'a>(input: Input<'a>, arg: &'static str, shape: Shape) -> Result<Range<'a>> {
    match input {
        Input::Missing => Err(Error::Missing { arg }),
        Input::Number(_) => Err(Error::WrongShape { arg, expected: shape, rows: 1, cols: 1 }),
        Input::Range(range) => Ok(range),
    }
}

fn wrong_shape(arg: &'static str, expected: Shape, range: Range<'_>) -> Error {
    Error::WrongShape { arg, expected, rows: range.rows(), cols: range.cols() }
}

fn not_finite(arg: &'static str, row: usize) -> Error {
    Error::InArgument { arg, error: shisei_core::Error::NotFinite { row } }
}

/// The row of the first number that is not finite.
fn first_not_finite(range: Range<'_>) -> Option<usize> {
    let index = range.data().iter().position(|x| !x.is_finite())?;
    Some(index / range.cols().max(1))
}
