//! What the straight line between measured and simulated says of an output: its unit of measurement, its sign, its offset.

use super::converted;
use crate::import::Match;
use crate::import::policy::IMPORT;
use crate::import::starts::{self, Start};
use crate::import::straight_line::Line;
use crate::observe::{Affine, measure};
use orchestrator::fmu::{Description, Variable};

/// Units that logs are written in, beside the model's own.
const USUAL: [&str; 22] = [
    "degC", "deg", "rpm", "deg/s", "mm", "cm", "km", "km/h", "mV", "kV", "mA", "uA", "kPa", "bar", "kW",
    "kN", "mN.m", "g", "ms", "%", "mA.h", "degF",
];

/// What a line says of unit, sign and offset of an output. `known`: its sign is.
pub(super) fn judge(
    matched: &mut Match,
    line: Line,
    description: &Description,
    starts: &[Start],
    known: bool,
    notices: &mut Vec<String>,
) {
    let variable = &description.variables[matched.variable];
    let said = format!("correlation with the model {:.2}, slope {:.3}", line.correlation, line.slope);
    if line.correlation.abs() < IMPORT.tells && known {
        return;
    }
    let has_unit = matched.unit.is_none() && unit_of(line, variable, description).is_some();
    if !line.begun && !has_unit {
        matched.evidence.push(format!(
            "nothing tried: the stretch without gaps begins within the log, and nothing says where the model stood there ({said})"
        ));
        return;
    }
    if line.correlation.abs() < IMPORT.tells || line.slope < 0.0 && !line.fits() {
        matched.evidence.push(format!("the model alone says nothing of sign and unit ({said})"));
        notices.push(format!(
            "column {:?} and {} don't go together ({said}): look at unit and sign",
            matched.column, variable.name
        ));
        return;
    }
    if matched.unit.is_none()
        && let Some((unit, found)) = unit_of(line, variable, description)
    {
        matched.evidence.push(format!("in {unit}, by trial: {said}, offset {:.4}", line.offset));
        matched.unit = Some(unit.to_owned());
        if line.slope < 0.0 {
            matched.affine = Some(Affine { scale: -found.scale, offset: found.offset });
        }
        return;
    }
    if let Some((affine, what)) = turned_or_shifted(matched, line, description, starts) {
        matched.affine = Some(affine);
        let apart = apart(line);
        matched.evidence.push(format!("{what}, by trial: {said}, means apart by {apart:.4}"));
        notices.push(format!("column {:?}: {what}, by trial ({said})", matched.column));
        return;
    }
    let size_fits = (line.slope.abs() - 1.0).abs() < IMPORT.unit.1;
    let fits =
        if size_fits { "sign and size fit" } else { "the sign fits, the size does not: look at the unit" };
    matched.evidence.push(format!("{fits}: {said}"));
}

/// How far the means of model and log are apart once the sign is the model's.
fn apart(line: Line) -> f64 {
    line.mean.1 - line.slope.signum() * line.mean.0
}

/// The conversion of an output whose sign is turned or whose offset is large, and what was done.
fn turned_or_shifted(
    matched: &Match,
    line: Line,
    description: &Description,
    starts: &[Start],
) -> Option<(Affine, String)> {
    let (own, sign) = (converted(matched, description), line.slope.signum());
    // where the log itself says how the model starts, an offset is in the start as well; a slope that isn't one has an offset of its own
    let far = line.fits()
        && starts::find(starts, matched.variable).is_none()
        && apart(line).abs() > IMPORT.offset * line.spread;
    let other = other_zero(line, own, &description.variables[matched.variable], description);
    if let Some((unit, affine)) = other.filter(|_| far && sign > 0.0) {
        return Some((affine, format!("in {unit}, whatever its header says")));
    }
    let what = match (sign < 0.0, far) {
        (true, true) => "sign turned and offset taken out",
        (true, false) => "sign turned",
        (false, true) => "offset taken out",
        (false, false) => return None,
    };
    let offset = if far { -sign * apart(line) } else { 0.0 };
    Some((Affine { scale: sign * own.scale, offset: sign * own.offset + offset }, what.to_owned()))
}

/// The unit of measurement with another zero, but the same size, with which the means of model and log are no longer far apart: degrees
/// Celsius under a header that says kelvin.
fn other_zero(
    line: Line,
    own: Affine,
    variable: &Variable,
    description: &Description,
) -> Option<(&'static str, Affine)> {
    USUAL.into_iter().find_map(|unit| {
        let found = measure::conversion(unit, variable, description).ok()?;
        let (same, shift) = (found.scale == own.scale, found.offset - own.offset);
        let near = (apart(line) + shift).abs() <= IMPORT.offset * line.spread;
        (same && shift != 0.0 && near).then_some((unit, found))
    })
}

/// The unit of measurement that explains a slope.
fn unit_of(line: Line, variable: &Variable, description: &Description) -> Option<(&'static str, Affine)> {
    variable.unit.as_deref().filter(|unit| !unit.is_empty())?;
    let near = |slope: f64| line.correlation.abs() >= IMPORT.unit.0 && (slope - 1.0).abs() < IMPORT.unit.1;
    USUAL.into_iter().find_map(|unit| {
        let found = measure::conversion(unit, variable, description).ok()?;
        // measured = slope · model + offset is scale · measured + shift = model
        let shifted = found.offset != 0.0;
        let apart = (found.scale * line.offset + found.offset).abs();
        let zero = !shifted || apart < 0.2 * found.offset.abs();
        let other = shifted || (found.scale - 1.0).abs() > 1e-6;
        (other && near(found.scale * line.slope.abs()) && zero).then_some((unit, found))
    })
}
