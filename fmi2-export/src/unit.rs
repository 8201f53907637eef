//! Physical units of variables: the exponents of the SI base units, and the units a person likes to read.

/// A unit as FMI 2.0 section 2.2.2 describes it: `UnitDefinitions/Unit`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Name in the description, e.g. `"N.m"`.
    pub name: &'static str,
    /// Exponents of kg, m, s, A, K, mol, cd, rad in this order.
    pub exponents: [i8; 8],
    /// value in base units = factor · value (offsets are not needed by any unit here).
    pub factor: f64,
    /// Display units: (name, factor) with value shown = factor · value.
    pub display: &'static [(&'static str, f64)],
}

const fn si(name: &'static str, kg: i8, m: i8, s: i8, rad: i8) -> Unit {
    Unit { name, exponents: [kg, m, s, 0, 0, 0, 0, rad], factor: 1.0, display: &[] }
}

const DEGREES_PER_RADIAN: f64 = 180.0 / core::f64::consts::PI;

/// Whatever the other end of a connection has: the description says nothing of it, and values pass as they are.
pub const ANY: Unit = si("", 0, 0, 0, 0);
/// A pure number.
pub const ONE: Unit = si("1", 0, 0, 0, 0);
/// Plane angle.
pub const RADIAN: Unit = Unit { display: &[("deg", DEGREES_PER_RADIAN)], ..si("rad", 0, 0, 0, 1) };
/// Angular velocity.
pub const RADIAN_PER_SECOND: Unit =
    Unit { display: &[("deg/s", DEGREES_PER_RADIAN)], ..si("rad/s", 0, 0, -1, 1) };
/// Angular acceleration.
pub const RADIAN_PER_SECOND_SQUARED: Unit = si("rad/s2", 0, 0, -2, 1);
/// Time.
pub const SECOND: Unit = Unit { display: &[("ms", 1e3)], ..si("s", 0, 0, 1, 0) };
/// Frequency.
pub const HERTZ: Unit = si("Hz", 0, 0, -1, 0);
/// Torque.
pub const NEWTON_METRE: Unit = Unit { display: &[("mN.m", 1e3)], ..si("N.m", 1, 2, -2, 0) };
/// Rate of change of a torque.
pub const NEWTON_METRE_PER_SECOND: Unit = si("N.m/s", 1, 2, -3, 0);
/// Moment of inertia.
pub const KILOGRAM_METRE_SQUARED: Unit = si("kg.m2", 1, 2, 0, 0);
/// Viscous friction of a rotation.
pub const NEWTON_METRE_SECOND_PER_RADIAN: Unit = si("N.m.s/rad", 1, 2, -1, -1);
/// Length in the scene (the camera of the paper sees 20 x 20 of these).
pub const WORLD_UNIT: Unit = si("wu", 0, 0, 0, 0);
/// Length in the image plane, -1..1 across the picture.
pub const IMAGE_UNIT: Unit = si("iu", 0, 0, 0, 0);
/// Length in the picture.
pub const PIXEL: Unit = si("px", 0, 0, 0, 0);
/// Brightness, 0..255.
pub const GREY_LEVEL: Unit = si("grey", 0, 0, 0, 0);
/// Coefficients of quadratic distortion.
pub const PER_IMAGE_UNIT: Unit = si("1/iu", 0, 0, 0, 0);
/// Coefficients of cubic distortion.
pub const PER_IMAGE_UNIT_SQUARED: Unit = si("1/iu2", 0, 0, 0, 0);
/// Coefficients of quintic distortion.
pub const PER_IMAGE_UNIT_FOURTH: Unit = si("1/iu4", 0, 0, 0, 0);
