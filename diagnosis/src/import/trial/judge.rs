//! What the straight line between measured and simulated says of an output: its unit of measurement, its sign, its offset.

use super::converted;
use crate::import::Match;
use crate::import::policy::IMPORT;
use crate::import::starts::{self, Start};
use crate::import::straight_line::Line;
use crate::observe::{Affine, measure};
use crate::statistics::levels::ROUNDING;
use orchestrator::fmu::{Description, Variable};

/// Units that logs are written in, beside the model's own.
const USUAL: [&str; 22] = [
    "degC", "deg", "rpm", "deg/s", "mm", "cm", "km", "km/h", "mV", "kV", "mA", "uA", "kPa", "bar", "kW",
    "kN", "mN.m", "g", "ms", "%", "mA.h", "degF",
];

/// What is known where a line is judged.
pub(super) struct Told<'a> {
    /// The unit's.
    pub description: &'a Description,
    /// Which parameters are starts of which states.
    pub starts: &'a [Start],
    /// Signs are known.
    pub signs: bool,
    /// The start, which no log gives, that shifts the whole course of an output.
    pub shifted_by: &'a dyn Fn(&Match) -> Option<String>,
}

/// What a line says of unit, sign and offset of an output.
pub(super) fn judge(matched: &mut Match, line: Line, told: &Told<'_>, notices: &mut Vec<String>) {
    let Told { description, signs: known, .. } = *told;
    let variable = &description.variables[matched.variable];
    let said = format!("correlation with the model {:.2}, slope {}", line.correlation, in_short(line.slope));
    if line.correlation.abs() < IMPORT.tells && known {
        return;
    }
    let own = converted(matched, description);
    let seen = unit_of(line, own, matched.unit.is_some(), (variable, description));
    if !line.begun && (seen.is_none() || matched.unit.is_some()) {
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
    let (near, mut is_told) = (seen.is_some(), false);
    match (seen, matched.unit.clone()) {
        (Some(seen @ Seen { beside: None, .. }), None) => {
            return take_unit(matched, line, own, seen, &said, notices);
        }
        (Some(seen), header) => is_told = tell(matched, &seen, header.as_deref(), &said, notices),
        (None, _) => {}
    }
    if !line.begun {
        return;
    }
    if let Some((affine, what)) = turned_or_shifted(matched, line, told) {
        matched.affine = Some(affine);
        let apart = apart(line);
        matched.evidence.push(format!("{what}, by trial: {said}, means apart by {apart:.4}"));
        notices.push(format!("column {:?}: {what}, by trial ({said})", matched.column));
        return;
    }
    size(matched, line, near && !is_told, &said, notices);
}

/// Takes the unit of measurement that was seen for an output of which nothing says one.
fn take_unit(
    matched: &mut Match,
    line: Line,
    own: Affine,
    seen: Seen,
    said: &str,
    notices: &mut Vec<String>,
) {
    let Seen { unit, found, slope, .. } = seen;
    let mut why = format!("in {unit}, by trial: {said}, offset {:.4}", line.offset);
    if !is_unit(slope) {
        why += &format!(
            "; numbers in {unit}, the nearest usual unit, would be {slope:.2} times what the model says: look at this"
        );
        notices.push(format!("column {:?}: {why}", matched.column));
    }
    matched.evidence.push(why);
    matched.unit = Some(unit);
    let sign = own.scale.signum() * line.slope.signum();
    if sign < 0.0 || matched.affine.is_some() {
        matched.affine = Some(Affine { scale: sign * found.scale, offset: found.offset });
    }
}

/// What is said of the size of an output whose sign fits; where a unit comes `near` that it isn't, the slope.
fn size(matched: &mut Match, line: Line, near: bool, said: &str, notices: &mut Vec<String>) {
    if (line.slope.abs() - 1.0).abs() < IMPORT.unit.1 {
        matched.evidence.push(format!("sign and size fit: {said}"));
        return;
    }
    matched.evidence.push(format!("the sign fits, the size does not: look at the unit: {said}"));
    if near {
        notices.push(format!(
            "column {:?}: its numbers are {} times what the model says (correlation {:.2}), which no usual unit of measurement explains: \
             look at its unit, at those of the inputs, and at what the model lacks",
            matched.column,
            in_short(line.slope),
            line.correlation
        ));
    }
}

/// A number with three decimals, or with an exponent where it has too many digits before them.
pub(super) fn in_short(value: f64) -> String {
    if value.abs() < IMPORT.written { format!("{value:.3}") } else { format!("{value:.2e}") }
}

/// How far the means of model and log are apart once the sign is the model's.
fn apart(line: Line) -> f64 {
    line.mean.1 - line.slope.signum() * line.mean.0
}

/// The conversion of an output whose sign is turned or whose offset is large, and what was done. No offset is taken out where a start says as well why
/// it lies apart: the log itself gives it where the output shows it, and another may be off.
fn turned_or_shifted(matched: &mut Match, line: Line, told: &Told<'_>) -> Option<(Affine, String)> {
    let (own, sign) = (converted(matched, told.description), line.slope.signum());
    // a slope that isn't one has an offset of its own
    let mut far = line.fits()
        && starts::find(told.starts, matched.variable).is_none()
        && apart(line).abs() > IMPORT.offset * line.spread;
    let other = other_zero(line, own, &told.description.variables[matched.variable], told.description);
    if let Some((unit, affine)) = other.filter(|_| far && sign > 0.0) {
        return Some((affine, format!("in {unit}, whatever its header says")));
    }
    if let Some(start) = far.then(|| (told.shifted_by)(matched)).flatten() {
        far = false;
        matched.evidence.push(format!(
            "no offset taken out, though means are apart by {:.4}: the machine may have begun elsewhere than where {start} starts the model",
            apart(line)
        ));
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

/// A unit of measurement that explains a slope.
struct Seen {
    unit: String,
    found: Affine,
    /// The power of ten that explains it as well: a gain, or a prefix.
    beside: Option<f64>,
    /// The slope that is left with this unit.
    slope: f64,
}

/// Whether a slope that is left with a unit says that it is the log's: it may be off by no more than a few per cent.
fn is_unit(slope: f64) -> bool {
    slope.ln().abs() < IMPORT.unit_is
}

/// The unit of measurement that explains a slope best, other than the one that it was converted from by `own`; where that one is `known`
/// another of the same size is none.
fn unit_of(
    line: Line,
    own: Affine,
    known: bool,
    (variable, description): (&Variable, &Description),
) -> Option<Seen> {
    let its = variable.unit.as_deref().filter(|unit| !unit.is_empty())?;
    if line.correlation.abs() < IMPORT.unit.0 {
        return None;
    }
    let seen = |unit: &str| {
        let found = measure::conversion(unit, variable, description).ok()?;
        let ratio = found.scale / own.scale;
        // measured = slope · model + offset is ratio · (measured - own offset) + shift = model
        let shifted = found.offset != 0.0;
        let apart = (ratio * (line.offset - own.offset) + found.offset).abs();
        let zero = !shifted || apart < 0.2 * found.offset.abs();
        let other = shifted && !known || (ratio.abs() - 1.0).abs() > ROUNDING;
        let slope = (ratio * line.slope).abs();
        let near = (slope - 1.0).abs() < IMPORT.unit.1;
        (other && near && zero).then(|| (slope.log10().abs(), unit.to_owned(), found, slope))
    };
    let all = USUAL.into_iter().chain([its]).filter_map(seen);
    let (off, unit, found, slope) = all.min_by(|one, other| one.0.total_cmp(&other.0))?;
    let decades = line.slope.abs().log10();
    let is_nearer = (decades - decades.round()).abs() < off - ROUNDING;
    Some(Seen { unit, found, beside: is_nearer.then(|| libm::exp10(decades.round())), slope })
}

/// Tells what a slope says of the unit of measurement where nothing is changed by it: the header says another, or a power of ten is as good.
/// Whether it says anything.
fn tell(
    matched: &mut Match,
    seen: &Seen,
    header: Option<&str>,
    said: &str,
    notices: &mut Vec<String>,
) -> bool {
    let Seen { unit, beside, slope, .. } = seen;
    let told = match (header, beside) {
        (Some(header), None) if is_unit(*slope) => format!(
            "its header says {header}, and its numbers are what the model says in {unit} ({said}): written as the header says; if it is wrong, \
             write unit = {unit:?}"
        ),
        (None, Some(ten)) => format!(
            "in {unit}, or {ten} times as large for another reason ({said}): no unit is written; if it is in {unit}, write unit = {unit:?}"
        ),
        _ => return false,
    };
    notices.push(format!("column {:?}: {told}", matched.column));
    matched.evidence.push(told);
    true
}
