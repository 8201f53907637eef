//! Units of measurement: how a number in the log's unit becomes one in the variable's.
//!
//! By FMI's own rules (FMI 2.0, section 2.2.2): a unit's `BaseUnit` gives value in base units = factor · value +
//! offset, a `DisplayUnit` gives shown = factor · value + offset. Units that a description doesn't define are read by
//! name, in Modelica's notation: `N.m`, `km/h`, `kg.m2/s`, `mV`, `degC`.

use super::Affine;
use orchestrator::fmu::{BaseUnit, Description, Variable};
use orchestrator::nearest;

/// Exponents of kg, m, s, A, K, mol, cd, rad, and the factor to base units.
type Named = (&'static str, [i32; 8], f64);

const RAD: [i32; 8] = [0, 0, 0, 0, 0, 0, 0, 1];
const NONE: [i32; 8] = [0; 8];
const LENGTH: [i32; 8] = [0, 1, 0, 0, 0, 0, 0, 0];
const TIME: [i32; 8] = [0, 0, 1, 0, 0, 0, 0, 0];
const ACCELERATION: [i32; 8] = [0, 1, -2, 0, 0, 0, 0, 0];
const MASS: [i32; 8] = [1, 0, 0, 0, 0, 0, 0, 0];
const FORCE: [i32; 8] = [1, 1, -2, 0, 0, 0, 0, 0];
const ENERGY: [i32; 8] = [1, 2, -2, 0, 0, 0, 0, 0];
const POWER: [i32; 8] = [1, 2, -3, 0, 0, 0, 0, 0];
const PRESSURE: [i32; 8] = [1, -1, -2, 0, 0, 0, 0, 0];
const FREQUENCY: [i32; 8] = [0, 0, -1, 0, 0, 0, 0, 0];

/// Units that take SI prefixes. The gram stands for the kilogram.
const PREFIXED: &[Named] = &[
    ("m", LENGTH, 1.0),
    ("s", TIME, 1.0),
    ("g", MASS, 1e-3),
    ("A", [0, 0, 0, 1, 0, 0, 0, 0], 1.0),
    ("K", [0, 0, 0, 0, 1, 0, 0, 0], 1.0),
    ("mol", [0, 0, 0, 0, 0, 1, 0, 0], 1.0),
    ("cd", [0, 0, 0, 0, 0, 0, 1, 0], 1.0),
    ("rad", RAD, 1.0),
    ("N", FORCE, 1.0),
    ("J", ENERGY, 1.0),
    ("W", POWER, 1.0),
    ("Pa", PRESSURE, 1.0),
    ("bar", PRESSURE, 1e5),
    ("Hz", FREQUENCY, 1.0),
    ("V", [1, 2, -3, -1, 0, 0, 0, 0], 1.0),
    ("Ohm", [1, 2, -3, -2, 0, 0, 0, 0], 1.0),
    ("F", [-1, -2, 4, 2, 0, 0, 0, 0], 1.0),
    ("H", [1, 2, -2, -2, 0, 0, 0, 0], 1.0),
    ("C", [0, 0, 1, 1, 0, 0, 0, 0], 1.0),
    ("T", [1, 0, -2, -1, 0, 0, 0, 0], 1.0),
    ("Wb", [1, 2, -2, -1, 0, 0, 0, 0], 1.0),
    ("Wh", ENERGY, 3600.0),
    ("Ah", [0, 0, 1, 1, 0, 0, 0, 0], 3600.0),
    ("l", [0, 3, 0, 0, 0, 0, 0, 0], 1e-3),
];

/// Units that take none.
const BARE: &[Named] = &[
    ("1", NONE, 1.0),
    ("%", NONE, 1e-2),
    ("deg", RAD, std::f64::consts::PI / 180.0),
    ("rev", RAD, std::f64::consts::TAU),
    ("rpm", [0, 0, -1, 0, 0, 0, 0, 1], std::f64::consts::TAU / 60.0),
    ("min", TIME, 60.0),
    ("h", TIME, 3600.0),
    ("d", TIME, 86_400.0),
    ("t", MASS, 1e3),
    ("atm", PRESSURE, 101_325.0),
    ("inch", LENGTH, 0.0254),
    ("ft", LENGTH, 0.3048),
    ("mile", LENGTH, 1609.344),
    ("kn", [0, 1, -1, 0, 0, 0, 0, 0], 1852.0 / 3600.0),
    ("lb", MASS, 0.453_592_37),
    ("lbf", FORCE, 4.448_221_615_260_5),
    ("psi", PRESSURE, 6_894.757_293_168),
];

/// What a name means beside what it means above, where the variable measures that: accelerometers count in standard gravities (exact by
/// definition: 3rd CGPM, 1901).
const OTHERWISE: &[Named] = &[("g", ACCELERATION, 9.806_65), ("mg", ACCELERATION, 9.806_65e-3)];

/// Temperatures that don't begin at 0 K: only by themselves, never within a product.
const SHIFTED: &[(&str, f64, f64)] = &[("degC", 1.0, 273.15), ("degF", 5.0 / 9.0, 459.67 * 5.0 / 9.0)];

const PREFIXES: &[(&str, f64)] = &[
    ("da", 1e1),
    ("G", 1e9),
    ("M", 1e6),
    ("k", 1e3),
    ("h", 1e2),
    ("d", 1e-1),
    ("c", 1e-2),
    ("m", 1e-3),
    ("u", 1e-6),
    ("n", 1e-9),
    ("p", 1e-12),
];

/// Other spellings: what people and spreadsheets write.
const SPELLED: &[(&str, &str)] = &[
    ("°C", "degC"),
    ("℃", "degC"),
    ("celsius", "degC"),
    ("°F", "degF"),
    ("kelvin", "K"),
    ("°", "deg"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("Ω", "Ohm"),
    ("ohm", "Ohm"),
    ("sec", "s"),
    ("seconds", "s"),
    ("r/min", "rpm"),
    ("RPM", "rpm"),
    ("1/min", "rpm"),
    ("kph", "km/h"),
    ("L", "l"),
    ("mps", "m/s"),
    ("in", "inch"),
    ("-", "1"),
];

/// A unit's name as it is spelled here.
fn plain(name: &str) -> String {
    let name = name.trim().replace(['µ', 'μ'], "u").replace(['·', '*'], ".").replace('^', "");
    // an ordinal and a ring above look like a degree, and stand on more keyboards
    let name = name.replace(['º', '˚'], "°").replace('⁻', "-").replace('¹', "1").replace(" / ", "/");
    name.replace('²', "2").replace('³', "3")
}

/// A unit by its name alone.
pub fn named(name: &str) -> Option<BaseUnit> {
    let name = plain(name);
    let name = spelled(&name).unwrap_or(&name);
    if let Some((_, factor, offset)) = SHIFTED.iter().find(|(known, ..)| *known == name) {
        return Some(BaseUnit { exponents: [0, 0, 0, 0, 1, 0, 0, 0], factor: *factor, offset: *offset });
    }
    let (exponents, factor) = product(name)?;
    Some(BaseUnit { exponents, factor, offset: 0.0 })
}

/// The usual spelling of another one.
fn spelled(text: &str) -> Option<&'static str> {
    SPELLED.iter().find(|(other, _)| *other == text).map(|(_, usual)| *usual)
}

/// `N.m/(rad.s)`: a slash divides by the one factor, or the parenthesis, that follows.
fn product(text: &str) -> Option<([i32; 8], f64)> {
    let (mut exponents, mut factor) = (NONE, 1.0);
    let (mut rest, mut sign) = (text, 1);
    while !rest.is_empty() {
        let (part, after) = match rest.strip_prefix('(') {
            Some(inner) => {
                let end = inner.find(')')?;
                (product(&inner[..end])?, &inner[end + 1..])
            }
            None => {
                let end = rest.find(['.', '/', ' ']).unwrap_or(rest.len());
                (power(&rest[..end])?, &rest[end..])
            }
        };
        exponents.iter_mut().zip(part.0).for_each(|(sum, power)| *sum += sign * power);
        factor *= part.1.powi(sign);
        sign = if after.starts_with('/') { -1 } else { 1 };
        rest = after.strip_prefix(['.', '/', ' ']).unwrap_or(after);
        if rest.is_empty() && !after.is_empty() {
            return None;
        }
    }
    (!text.is_empty()).then_some((exponents, factor))
}

/// `m2`, `s-1`, `kg`.
fn power(text: &str) -> Option<([i32; 8], f64)> {
    if text == "1" {
        return Some((NONE, 1.0));
    }
    // within a product, too: `°/s`, `Nm/rad`
    if let Some(usual) = spelled(text) {
        return product(usual);
    }
    if let Some(torque) = torque(text) {
        return Some(torque);
    }
    let digits = text.find(|letter: char| letter == '-' || letter.is_ascii_digit()).unwrap_or(text.len());
    let power: i32 = if digits < text.len() { text[digits..].parse().ok()? } else { 1 };
    let (exponents, factor) = single(&text[..digits])?;
    Some((exponents.map(|exponent| exponent * power), factor.powi(power)))
}

/// `kNm`, `Ncm`: force times length as people write it, without a point between them.
fn torque(text: &str) -> Option<([i32; 8], f64)> {
    let (force, length) = text.split_at(text.find('N')? + 1);
    let of =
        |part: &str, wanted: [i32; 8]| single(part).filter(|found| found.0 == wanted).map(|found| found.1);
    let length = length.ends_with('m').then(|| of(length, LENGTH))?;
    Some((ENERGY, of(force, FORCE)? * length?))
}

fn single(text: &str) -> Option<([i32; 8], f64)> {
    let text = spelled(text).unwrap_or(text);
    listed(BARE, text).or_else(|| listed(PREFIXED, text)).or_else(|| {
        PREFIXES.iter().find_map(|(prefix, times)| {
            let (exponents, factor) = listed(PREFIXED, text.strip_prefix(prefix)?)?;
            Some((exponents, factor * times))
        })
    })
}

fn listed(list: &[Named], text: &str) -> Option<([i32; 8], f64)> {
    list.iter().find(|(name, ..)| *name == text).map(|(_, exponents, factor)| (*exponents, *factor))
}

/// What a unit means beside what [`named`] says, if anything: `g` is a standard gravity, too.
pub fn otherwise_named(name: &str) -> Option<BaseUnit> {
    let (exponents, factor) = listed(OTHERWISE, &plain(name))?;
    Some(BaseUnit { exponents, factor, offset: 0.0 })
}

/// How numbers in `unit` become values of a variable; an error is what is wrong and what would be right.
///
/// # Errors
/// The unit is unknown, measures another quantity, or the variable has none.
pub fn conversion(unit: &str, variable: &Variable, description: &Description) -> Result<Affine, String> {
    let Some(own) = variable.unit.as_deref().filter(|own| !own.is_empty()) else {
        let si = named(unit).map(|base| (base.factor, base.offset));
        let (scale, offset) = si.unwrap_or((1.0, 0.0));
        return Err(format!(
            "unit = {unit:?}: {} has no unit in its description; write `scale` and `offset` (model = scale * log + offset; \
             for a model in SI units scale = {scale}, offset = {offset})",
            variable.name
        ));
    };
    let whole = |scale: f64, offset: f64| Affine {
        scale,
        // no zero with a sign
        offset: if variable.relative_quantity { 0.0 } else { offset + 0.0 },
    };
    if unit == own {
        return Ok(Affine::SAME);
    }
    let definition = description.unit(own);
    let shown = definition.and_then(|definition| definition.display.iter().find(|(name, ..)| name == unit));
    if let Some((_, factor, offset)) = shown {
        return Ok(whole(1.0 / factor, -offset / factor));
    }
    let base = |name: &str| description.unit(name).and_then(|unit| unit.base).or_else(|| named(name));
    let Some(from) = base(unit) else { return Err(unknown_unit(unit, own, description)) };
    let Some(to) = base(own) else {
        return Err(format!(
            "unit = {unit:?}: the description gives {own:?}, the unit of {}, no BaseUnit; write `scale` and `offset` \
             (model = scale * log + offset)",
            variable.name
        ));
    };
    let measures_the_same = |from: &BaseUnit| from.exponents == to.exponents;
    let from =
        Some(from).filter(measures_the_same).or_else(|| otherwise_named(unit).filter(measures_the_same));
    let Some(from) = from else {
        return Err(format!(
            "unit = {unit:?} doesn't measure the same quantity as {own:?}, the unit of {}",
            variable.name
        ));
    };
    Ok(whole(from.factor / to.factor, (from.offset - to.offset) / to.factor))
}

/// Whether two variables, each with its description, are in units of different quantities. A turn counts as none beside another quantity (1/s and
/// rad/s), and what is in no unit or in 1 may be anything.
pub(crate) fn are_unlike(one: (&Variable, &Description), other: (&Variable, &Description)) -> bool {
    let base = |(variable, description): (&Variable, &Description)| {
        let own = variable.unit.as_deref().filter(|own| !own.is_empty())?;
        let base = description.unit(own).and_then(|unit| unit.base).or_else(|| named(own))?;
        (base.exponents != NONE).then_some(base.exponents)
    };
    let is_turn = |place: &usize| RAD[*place] != 0;
    let differ = |(one, other): ([i32; 8], [i32; 8])| {
        (0..one.len()).filter(|place| !is_turn(place)).any(|place| one[place] != other[place])
    };
    base(one).zip(base(other)).is_some_and(differ)
}

/// Whether a variable counts something per second.
pub fn is_rate(variable: &Variable, description: &Description) -> bool {
    let own = variable.unit.as_deref().filter(|own| !own.is_empty());
    let base = own.and_then(|own| description.unit(own).and_then(|unit| unit.base).or_else(|| named(own)));
    base.is_some_and(|base| TIME.iter().zip(base.exponents).all(|(time, own)| *time == 0 || own == -time))
}

/// What to say of a unit that nobody knows, for a variable in `own`.
fn unknown_unit(unit: &str, own: &str, description: &Description) -> String {
    let base = |name: &str| description.unit(name).and_then(|unit| unit.base).or_else(|| named(name));
    let known = description.units.iter().flat_map(|definition| {
        std::iter::once(definition.name.as_str())
            .chain(definition.display.iter().map(|(name, ..)| name.as_str()))
    });
    let usual =
        BARE.iter().chain(PREFIXED).map(|(name, ..)| *name).chain(SHIFTED.iter().map(|(name, ..)| *name));
    let prefixed: Vec<String> = PREFIXES.iter().map(|(prefix, _)| format!("{prefix}{own}")).collect();
    let prefixed = prefixed.iter().map(String::as_str).filter(|name| named(name).is_some());
    let known: Vec<&str> = known.chain(prefixed).chain(usual).collect();
    let own = base(own).map(|own| own.exponents);
    let fits = known.iter().copied().filter(|name| base(name).map(|base| base.exponents) == own);
    let near = nearest(unit, fits);
    if near.starts_with("did you mean") {
        return format!("unit = {unit:?} is unknown: {near}");
    }
    format!("unit = {unit:?} is unknown: {}", nearest(unit, known.into_iter()))
}

/// Seconds in a unit of time.
///
/// # Errors
/// It is none.
pub fn seconds(unit: &str) -> Result<f64, String> {
    let known = || nearest(unit, ["s", "ms", "us", "ns", "min", "h", "d"].into_iter());
    match named(unit) {
        Some(base) if base.exponents == TIME => Ok(base.factor),
        _ => Err(format!("unit = {unit:?} is no unit of time: {}", known())),
    }
}

#[cfg(test)]
mod tests;
