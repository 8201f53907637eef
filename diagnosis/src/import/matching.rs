//! Which column is which variable: by name and unit of measurement.

use super::heads::Header;
use super::policy::IMPORT;
use super::sheet::Sheet;
use super::{Match, instance};
use crate::error::Error;
use crate::observe::{Affine, measure};
use orchestrator::fmu::{Causality, Description, Variable};
use orchestrator::{Fmu, Kind};

/// Matches the columns of a log with inputs, outputs and local variables, the likeliest pair first.
pub(super) fn match_columns(
    fmu: &Fmu,
    sheet: &Sheet,
    time: usize,
    notices: &mut Vec<String>,
) -> Result<Vec<Match>, Error> {
    let description = fmu.description();
    let (mut taken, mut matches): (Vec<usize>, Vec<Match>) = (Vec::new(), Vec::new());
    for (_, column, place, why) in likely_pairs(fmu, sheet, time) {
        if taken.contains(&column) || matches.iter().any(|known| known.variable == place) {
            continue;
        }
        taken.push(column);
        let head = &sheet.columns[column];
        let si = as_si(head, &description.variables[place]);
        let mut evidence = vec![why];
        if let Some(told) = either(head, &description.variables[place]) {
            notices.push(format!("column {:?}: {told}", head.text));
            evidence.push(told);
        }
        evidence.extend(si.map(|_| "the description gives it no unit: converted to SI".to_owned()));
        matches.push(Match {
            variable: place,
            column: head.text.clone(),
            unit: head.unit.clone(),
            affine: si,
            evidence,
            fed: description.variables[place].causality == Causality::Input,
            hold: None,
        });
    }
    matches.sort_by_key(|known| (!known.fed, known.variable));
    let left = (0..sheet.columns.len()).filter(|column| *column != time && !taken.contains(column));
    let is_free = |place: usize| matches.iter().all(|known| known.variable != place);
    if let Some(problem) = left
        .clone()
        .find_map(|column| misnamed(&sheet.columns[column], description, &instance(fmu), &is_free))
    {
        return Err(Error::Manifest { path: sheet.path.clone(), line: sheet.lines.0, problem });
    }
    notices.extend(left.map(|column| {
        format!("column {:?} fits no variable of {}: left out", sheet.columns[column].text, instance(fmu))
    }));
    notices.extend(unfed_inputs(description, &matches));
    if matches.iter().all(|known| known.fed) {
        return Err(no_output(fmu, sheet, time));
    }
    check_units(description, sheet, &matches)?;
    Ok(matches)
}

/// An error for a unit of measurement that doesn't convert to that of the column's variable.
fn check_units(description: &Description, sheet: &Sheet, matches: &[Match]) -> Result<(), Error> {
    for matched in matches.iter().filter(|one| one.affine.is_none()) {
        let variable = &description.variables[matched.variable];
        let (Some(unit), Some(_)) = (&matched.unit, &variable.unit) else { continue };
        if let Err(why) = measure::conversion(unit, variable, description) {
            let problem = format!(
                "column {:?}: {why}{} Write the unit that was meant into the log's head; without one, numbers are taken as they are",
                matched.column,
                if why.ends_with('?') { "" } else { "." }
            );
            return Err(Error::Manifest { path: sheet.path.clone(), line: sheet.lines.0, problem });
        }
    }
    Ok(())
}

/// What is wrong with a column that is left over since its unit measures something else than the input or output of the very same name that is still
/// free: nobody means to leave that at its start value.
fn misnamed(
    head: &Header,
    description: &Description,
    instance: &str,
    is_free: &dyn Fn(usize) -> bool,
) -> Option<String> {
    let unit = head.unit.as_deref().filter(|unit| measure::named(unit).is_some())?;
    // a letter after an underscore may be an index
    let is_called = |variable: &Variable| {
        let own = format!("{instance}.{}", variable.name);
        (head.name == variable.name || head.name == own) && head.text != format!("{}_{unit}", head.name)
    };
    let is_port = |variable: &Variable| matches!(variable.causality, Causality::Input | Causality::Output);
    let mut all = description.variables.iter().enumerate();
    let (_, variable) = all.find(|(place, one)| is_port(one) && is_called(one) && is_free(*place))?;
    let own = variable.unit.as_deref().filter(|own| !own.is_empty())?;
    measure::conversion(unit, variable, description).err()?;
    let what = if variable.causality == Causality::Input { "input" } else { "output" };
    Some(format!(
        "column {:?} is called like the {what} {}, which is in {own}, and {unit} measures something else: write the unit that was meant into the log's \
         head, or give a column that is something else another name",
        head.text, variable.name
    ))
}

/// Columns and variables that may be one, the likeliest pair first: likeness, places of both, and why.
fn likely_pairs(fmu: &Fmu, sheet: &Sheet, time: usize) -> Vec<(f64, usize, usize, String)> {
    let description = fmu.description();
    let mut pairs = Vec::new();
    for (column, header) in sheet.columns.iter().enumerate().filter(|(column, _)| *column != time) {
        for (place, variable) in description.variables.iter().enumerate() {
            let Some(rank) = rank(variable) else { continue };
            let alike = likeness(header, variable, description, &instance(fmu));
            let alike = alike.or_else(|| only(header, variable, sheet, time, fmu));
            let Some((score, why)) = alike else { continue };
            pairs.push((score + rank, column, place, why));
        }
    }
    pairs.sort_by(|one, other| other.0.total_cmp(&one.0));
    pairs
}

/// What to say of inputs that are in no column.
fn unfed_inputs<'a>(description: &'a Description, matches: &'a [Match]) -> impl Iterator<Item = String> + 'a {
    let is_fed = |name: &str| matches.iter().any(|known| description.variables[known.variable].name == name);
    let inputs = description.variables.iter().filter(|v| v.causality == Causality::Input);
    inputs.filter(move |input| !is_fed(&input.name)).map(|input| {
        let start = input.start.as_ref().map_or("nothing".to_owned(), ToString::to_string);
        format!("input {} is in no column: it stays at its start value, {start}", input.name)
    })
}

/// No column is an output of the unit.
fn no_output(fmu: &Fmu, sheet: &Sheet, time: usize) -> Error {
    let outputs = fmu.description().variables.iter().filter(|v| v.causality == Causality::Output);
    let outputs: Vec<&str> = outputs.map(|variable| variable.name.as_str()).take(8).collect();
    let columns = sheet.columns.iter().enumerate().filter(|(column, _)| *column != time);
    let columns: Vec<String> = columns.map(|(_, head)| format!("{:?}", head.text)).collect();
    let problem = format!(
        "no column ({}) is an output of {} ({}): name a column after the variable that it measures",
        columns.join(", "),
        instance(fmu),
        outputs.join(", ")
    );
    Error::Manifest { path: sheet.path.clone(), line: 1, problem }
}

/// What to say of a unit that means one thing or another, of a variable whose description names none.
fn either(head: &Header, variable: &Variable) -> Option<String> {
    let unit = head.unit.as_deref()?;
    let (one, other) = (measure::named(unit)?, measure::otherwise_named(unit)?);
    let told = format!(
        "{unit} is {} kg or {} m/s2, and the description gives {} no unit: numbers are taken as they are; write scale = {} or scale = {}",
        one.factor, other.factor, variable.name, one.factor, other.factor
    );
    variable.unit.is_none().then_some(told)
}

/// The way to SI for a variable whose description names no unit; nothing where the unit may mean one thing or another.
fn as_si(head: &Header, variable: &Variable) -> Option<Affine> {
    let unit = head.unit.as_deref()?;
    let base = measure::named(unit).filter(|_| measure::otherwise_named(unit).is_none())?;
    let (scale, offset) = (base.factor, base.offset);
    (variable.unit.is_none() && (scale, offset) != (1.0, 0.0)).then_some(Affine { scale, offset })
}

/// What may be measured, and of equal names what first.
fn rank(variable: &Variable) -> Option<f64> {
    match (variable.kind, variable.causality) {
        (Kind::String, _) => None,
        (_, Causality::Input | Causality::Output) => Some(0.02),
        (_, Causality::Local) => Some(0.0),
        _ => None,
    }
}

/// Whether a name is, but for case and marks, that of something that may be measured.
pub(super) fn is_measurable(description: &Description, name: &str) -> bool {
    let is_so = |one: &Variable| rank(one).is_some() && words(&one.name).concat() == words(name).concat();
    name.contains(char::is_alphanumeric) && description.variables.iter().any(is_so)
}

/// Whether a column and a variable are the only ones of what they measure, in a log and among a unit's inputs and outputs, and why.
fn only(
    header: &Header,
    variable: &Variable,
    sheet: &Sheet,
    time: usize,
    fmu: &Fmu,
) -> Option<(f64, String)> {
    let description = fmu.description();
    let is_one = |head: &Header, variable: &Variable| {
        let port = matches!(variable.causality, Causality::Input | Causality::Output);
        let base = head.unit.as_deref().and_then(measure::named);
        // shares and counts measure anything
        let measures = base.is_some_and(|base| base.exponents.iter().any(|exponent| *exponent != 0));
        let converts = |unit| measure::conversion(unit, variable, description).is_ok();
        port && variable.kind == Kind::Real && measures && head.unit.as_deref().is_some_and(converts)
    };
    let columns = sheet.columns.iter().enumerate().filter(|(column, _)| *column != time);
    let alone = is_one(header, variable)
        && columns.filter(|(_, other)| is_one(other, variable)).count() == 1
        && description.variables.iter().filter(|other| is_one(header, other)).count() == 1;
    let (unit, own) = (header.unit.as_deref()?, variable.unit.as_deref()?);
    let why = format!(
        "column {:?} is the only one in a unit that converts to {own}, and no other input or output is in {unit}",
        header.text
    );
    alone.then_some((IMPORT.alike, why))
}

/// How alike a column and a variable are, and why; `None` where they can't be one.
fn likeness(
    header: &Header,
    variable: &Variable,
    description: &Description,
    instance: &str,
) -> Option<(f64, String)> {
    let own = variable.unit.as_deref().filter(|unit| !unit.is_empty());
    let fits = match (header.unit.as_deref(), own) {
        (Some(unit), Some(_)) => Some(measure::conversion(unit, variable, description).is_ok()),
        _ => None,
    };
    // a unit that is known and measures something else
    if fits == Some(false) && header.unit.as_deref().is_some_and(|unit| measure::named(unit).is_some()) {
        return None;
    }
    let names = [variable.name.clone(), format!("{instance}.{}", variable.name)];
    let written = [header.name.as_str(), header.text.as_str()];
    let alike = |one: &str, other: &str| same(&words(one), &words(other));
    let by_name =
        names.iter().flat_map(|name| written.iter().map(move |text| alike(name, text))).fold(0.0, f64::max);
    let by_text = 0.7 * same(&words(&header.name), &words(&variable.description));
    let by_unit = if fits == Some(true) { numbered(&header.name, &variable.name) } else { 0.0 };
    let (best, why) =
        [(by_name, "name"), (by_text, "description"), (by_unit, "unit of measurement and number")]
            .into_iter()
            .reduce(|best, one| if one.0 > best.0 { one } else { best })?;
    if best < IMPORT.alike {
        return None;
    }
    let exact = if best >= 1.0 || by_unit == best { "the same" } else { "a similar" };
    let unit = match (fits, header.unit.as_deref(), own) {
        (Some(true), Some(unit), Some(own)) if unit == own => format!(", and in {own} as the model"),
        (Some(true), Some(unit), Some(own)) => format!(", and {unit} converts to {own}"),
        _ => String::new(),
    };
    Some((scored(best, fits == Some(true)), format!("column {:?} by {exact} {why}{unit}", header.text)))
}

/// A likeness with what a fitting unit of measurement adds: the same name goes before any that is similar.
fn scored(alike: f64, fits: bool) -> f64 {
    let same = if alike >= 1.0 { 1.0 } else { 0.0 };
    alike + same + if fits { IMPORT.fitting_unit } else { 0.0 }
}

/// Lower-case words of a name: `phi_cmd`, `motorSpeed`, `T box`.
pub(super) fn words(text: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before = ' ';
    for letter in text.chars() {
        let new = !letter.is_alphanumeric() || letter.is_uppercase() && before.is_lowercase();
        if new {
            words.push(String::new());
        }
        if letter.is_alphanumeric() {
            words.last_mut().into_iter().for_each(|word| word.extend(letter.to_lowercase()));
        }
        before = letter;
    }
    words.retain(|word| !word.is_empty());
    words
}

/// 1 for the same words, less for some of them: what two lists share of the shorter, weighed with what they share of the longer.
fn same(one: &[String], other: &[String]) -> f64 {
    if one.is_empty() || other.is_empty() {
        return 0.0;
    }
    if one.concat() == other.concat() {
        return 1.0;
    }
    let (short, long) = if one.len() <= other.len() { (one, other) } else { (other, one) };
    let shared = short.iter().filter(|word| long.contains(word)).count() as f64;
    0.8 * shared / short.len() as f64 + 0.1 * shared / long.len() as f64
}

/// How alike two names are that have the same number: more where one begins a word of the other (`T1`, `Temperature 1`).
fn numbered(column: &str, variable: &str) -> f64 {
    let split = |text: &str| -> (Vec<String>, Vec<String>) {
        let runs = words(text).join(" ");
        let spaced: String = runs
            .chars()
            .scan(' ', |before, letter| {
                let new = before.is_alphanumeric() && before.is_ascii_digit() != letter.is_ascii_digit();
                *before = letter;
                Some(if new { format!(" {letter}") } else { letter.to_string() })
            })
            .collect();
        spaced
            .split_whitespace()
            .map(ToOwned::to_owned)
            .partition(|word| !word.starts_with(|c: char| c.is_ascii_digit()))
    };
    let ((one, number), (other, same)) = (split(column), split(variable));
    if number.is_empty() || number != same {
        return 0.0;
    }
    let begins = |word: &String| one.iter().any(|long| long.starts_with(word.as_str()));
    if other.iter().any(begins) { IMPORT.alike + IMPORT.same_initial } else { IMPORT.alike }
}

#[cfg(test)]
mod tests {
    use super::super::heads::header;
    use super::*;

    #[test]
    fn value_names_with_a_number_are_alike_by_it() {
        assert_eq!(numbered("Temperature 1", "T1"), IMPORT.alike + IMPORT.same_initial);
        assert_eq!(numbered("Set Point 1", "T1"), IMPORT.alike);
        assert_eq!(numbered("Heater 1", "Q1"), IMPORT.alike);
        assert_eq!(numbered("Heater 2", "Q1"), 0.0);
        assert_eq!(numbered("Heater", "Q"), 0.0);
    }

    #[test]
    fn bad_data_the_name_of_an_input_in_a_unit_of_something_else() {
        let text = r#"<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g"><CoSimulation modelIdentifier="m"/><ModelVariables>
            <ScalarVariable name="u" valueReference="0" causality="input"><Real unit="V"/></ScalarVariable>
            <ScalarVariable name="m" valueReference="1" causality="local"><Real unit="m"/></ScalarVariable>
            </ModelVariables><ModelStructure/></fmiModelDescription>"#;
        let description = Description::parse(text).expect("a description");
        let of = |head: &str, free: bool| misnamed(&header(head), &description, "motor", &|_| free);
        let told = of("u [kg]", true).expect("a voltage");
        assert!(
            told.starts_with("column \"u [kg]\" is called like the input u, which is in V, and kg"),
            "{told}"
        );
        assert!(of("motor.u (kg)", true).is_some());
        // taken by another column, one that fits, a local variable, an index, a unit that nobody knows
        assert_eq!(of("u [kg]", false), None);
        for head in ["u [mV]", "m [kg]", "u_s", "u [blorps]", "u"] {
            assert_eq!(of(head, true), None, "{head}");
        }
    }

    #[test]
    fn law_the_same_name_goes_before_a_similar_one_whose_unit_fits() {
        let words_of = |one: &str, other: &str| same(&words(one), &words(other));
        let (own, wall) = (words_of("box T", "box_T"), words_of("box T", "box_T_wall"));
        assert!(scored(own, false) > scored(wall, true) && scored(own, true) > scored(own, false));
        assert!(scored(wall, true) > scored(wall, false));
    }

    #[test]
    fn value_names_are_alike_by_words() {
        let alike = |one: &str, other: &str| same(&words(one), &words(other));
        assert_eq!(alike("motor.phi", "motor_phi"), 1.0);
        assert_eq!(alike("boxTemperature", "box temperature"), 1.0);
        assert!(alike("phi_cmd", "phi") > IMPORT.alike);
        // a word that stands twice is shared once: the input of the same name is nearer
        assert!(alike("valveControl", "tank.Valve.valveControl") < 1.0);
        assert!(alike("T_box", "T_wall") < IMPORT.alike && alike("phi", "psi") < IMPORT.alike);
    }

    #[test]
    fn value_what_a_number_and_a_unit_of_measurement_add_to_a_name() {
        let text = r#"<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g"><CoSimulation modelIdentifier="m"/>
            <UnitDefinitions><Unit name="K"><BaseUnit K="1"/></Unit></UnitDefinitions><ModelVariables>
            <ScalarVariable name="NAME" description="DESCRIBED" valueReference="0" causality="output" variability="continuous"><Real UNIT/></ScalarVariable>
            </ModelVariables><ModelStructure/></fmiModelDescription>"#;
        let of = |column: &str, (name, described): (&str, &str), converts: bool| {
            let text = text.replace("NAME", name).replace("DESCRIBED", described);
            let text = text.replace("UNIT", if converts { "unit=\"K\"" } else { "" });
            let description = Description::parse(&text).expect("a description");
            let header = Header { text: column.into(), name: column.into(), unit: Some("degC".into()) };
            likeness(&header, &description.variables[0], &description, "m").map_or(0.0, |one| one.0)
        };
        // what is described so and is in a fitting unit is nearer than a name with a word more and of no unit
        let column = "box temperature";
        let (described, longer) =
            (of(column, ("x3", "Box temperature"), true), of(column, ("box_temperature_in", ""), false));
        assert!(described > longer, "{described} {longer}");
        // but a fitting unit is less than a word: the name that has all of them is nearer than one that has two of three
        let column = "box wall temperature";
        let (two, all) = (of(column, ("box_wall_x", ""), true), of(column, ("box_wall", ""), false));
        assert!(two < all, "{two} {all}");
        // a number and an initial are less than all words of a name, and more than a number alone
        let words = of("Temperature 1", ("Temperature_1_out", ""), false);
        let (initial, number) = (numbered("Temperature 1", "T1"), numbered("Temperature 1", "Q1"));
        assert!(words > initial && initial > number + 0.05, "{words} {initial} {number}");
    }
}
