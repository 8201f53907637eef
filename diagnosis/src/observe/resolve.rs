//! From the keys of the file to a [`Problem`]: names become variables, columns become series.

use super::log::Log;
use super::raw::{self, File};
use super::{
    Affine, Channel, Hold, InputEffect, Nominal, OutputEffect, Ports, Problem, Reading, Role, Run, Series,
    State, VariableId,
};
use super::{candidates, clock, measure, nominal, run_files, unlogged};
use crate::error::{Error, Notice};
use orchestrator::fmu::{Causality, Initial, Variability, Variable};
use orchestrator::{Isolation, Kind, UnitPath, nearest};
use std::path::Path;
use toml::Spanned;

/// Reads everything that the file names.
pub(super) fn problem(
    folder: &Path,
    file: &File,
    units: &UnitPath,
    isolation: Option<&Isolation>,
) -> Result<Problem, Error> {
    let mut model = nominal::load(folder, file, units)?;
    // before any unit is run
    model.isolate(isolation);
    let mut notices = Vec::new();
    super::own::take(&mut model, &mut notices);
    notices.extend(nominal::repeated_names(&model));
    let channels = channels(&model, file)?;
    nominal::refuse_fed(&model, &channels, file)?;
    let runs = runs(folder, file, &channels, &mut notices)?;
    if file.raw.fmu.is_some() {
        nominal::pace(&mut model, runs.iter().flat_map(|run| &run.series));
    }
    let unlogged = unlogged::unlogged(&model, &channels, &mut notices)?;
    let states = states(&model, &channels, file, &mut notices)?;
    let candidates = candidates::resolve(&model, &states, file, &mut notices)?;
    let ports = ports(&file.raw.ports, file)?;
    let reading = Reading::After;
    Ok(Problem {
        path: folder.to_owned(),
        model,
        channels,
        unlogged,
        states,
        candidates,
        ports,
        runs,
        reading,
        deadline: None,
        budget: None,
        late: false,
        whole: false,
        notices,
    })
}

/// A variable by the name at a place of the file.
pub(super) fn variable(model: &Nominal, name: &Spanned<String>, file: &File) -> Result<VariableId, Error> {
    nominal::find(&model.scenario, &model.fmus, name.get_ref())
        .map_err(|problem| file.wrong(&name.span(), problem))
}

fn channels(model: &Nominal, file: &File) -> Result<Vec<Channel>, Error> {
    let mut channels: Vec<Channel> = Vec::new();
    for entry in &file.raw.channel {
        let channel = channel(model, file, entry)?;
        if let Some(first) = channels.iter().find(|known| known.variable == channel.variable) {
            let problem =
                format!("a second channel for {}, the first is at line {}", channel.name, first.line);
            return Err(file.wrong(&entry.get_ref().variable.span(), problem));
        }
        channels.push(channel);
    }
    if !channels.iter().any(|channel| channel.role == Role::Compared) {
        let known = model.fmus.iter().zip(&model.scenario.units).flat_map(|(fmu, unit)| {
            let outputs = fmu.description().variables.iter().filter(|v| v.causality == Causality::Output);
            outputs.map(|output| format!("{}.{}", unit.name, output.name))
        });
        let known: Vec<String> = known.take(8).collect();
        let problem =
            format!("no [[channel]] of an output: nothing can be compared (outputs: {})", known.join(", "));
        return Err(file.wrong(&(0..0), problem));
    }
    Ok(channels)
}

fn channel(model: &Nominal, file: &File, entry: &Spanned<raw::Channel>) -> Result<Channel, Error> {
    let raw = entry.get_ref();
    let id = variable(model, &raw.variable, file)?;
    let (name, described) = (model.name(id), model.variable(id));
    let at = |problem: String| file.wrong(&raw.variable.span(), problem);
    if described.kind == Kind::String {
        return Err(at(format!("{name} is a text: only numbers can be compared")));
    }
    let role = match described.causality {
        Causality::Input => Role::Fed(hold(raw, described, file)?),
        Causality::Output | Causality::Local => Role::Compared,
        other => {
            let what = if other == Causality::Independent { "the time" } else { "a parameter" };
            return Err(at(format!(
                "{name} is {what}: a channel is an input, an output or a local variable"
            )));
        }
    };
    if let (Some(hold), Role::Compared) = (&raw.hold, role) {
        return Err(file.wrong(&hold.span(), format!("`hold` is for inputs; {name} is compared")));
    }
    let conversion = conversion(model, raw, id, file)?;
    let noise = match &raw.noise {
        Some(noise) if noise.get_ref().is_finite() && *noise.get_ref() > 0.0 => {
            Some(noise.get_ref() * conversion.scale.abs())
        }
        Some(noise) => {
            let problem = format!("noise = {}: a standard deviation, larger than 0", noise.get_ref());
            return Err(file.wrong(&noise.span(), problem));
        }
        None => None,
    };
    let column =
        raw.column.as_ref().map_or_else(|| described.name.clone(), |column| column.get_ref().clone());
    let (hold_is_said, line) = (raw.hold.is_some(), file.line(&entry.span()));
    Ok(Channel { name, variable: id, role, noise, column, conversion, line, hold_is_said })
}

fn hold(raw: &raw::Channel, variable: &Variable, file: &File) -> Result<Hold, Error> {
    let Some(given) = &raw.hold else { return Ok(Hold::Zero) };
    match given.get_ref().as_str() {
        "zero" => Ok(Hold::Zero),
        "linear" if variable.kind == Kind::Real => Ok(Hold::Linear),
        "linear" => Err(file.wrong(
            &given.span(),
            format!("hold = \"linear\": {} is of type {}", variable.name, variable.kind),
        )),
        other => {
            let known = nearest(other, ["zero", "linear"].into_iter());
            Err(file.wrong(&given.span(), format!("hold = {other:?}: {known}")))
        }
    }
}

fn conversion(model: &Nominal, raw: &raw::Channel, id: VariableId, file: &File) -> Result<Affine, Error> {
    let finite = |given: &Option<Spanned<f64>>, key: &str, default: f64| match given {
        None => Ok(default),
        Some(value) if value.get_ref().is_finite() && (key != "scale" || *value.get_ref() != 0.0) => {
            Ok(*value.get_ref())
        }
        Some(value) => {
            let wanted = if key == "scale" { "a finite number other than 0" } else { "a finite number" };
            Err(file.wrong(&value.span(), format!("{key} = {}: {wanted}", value.get_ref())))
        }
    };
    let own =
        Affine { scale: finite(&raw.scale, "scale", 1.0)?, offset: finite(&raw.offset, "offset", 0.0)? };
    match &raw.unit {
        None => Ok(own),
        Some(unit) if raw.scale.is_some() || raw.offset.is_some() => {
            let problem =
                "`unit` and `scale` or `offset` both: one of them says how the log's numbers are converted";
            Err(file.wrong(&unit.span(), problem))
        }
        Some(unit) => measure::conversion(unit.get_ref(), model.variable(id), model.description(id.instance))
            .map_err(|problem| file.wrong(&unit.span(), problem)),
    }
}

fn runs(
    folder: &Path,
    file: &File,
    channels: &[Channel],
    notices: &mut Vec<Notice>,
) -> Result<Vec<Run>, Error> {
    if file.raw.run.is_empty() {
        return Err(file.wrong(&(0..0), "no [[run]] with `file = \"run-01.csv\"`"));
    }
    let mut runs = Vec::new();
    for entry in &file.raw.run {
        let raw = entry.get_ref();
        let run = run(folder, file, raw, channels, notices)?;
        if let Some(problem) = run_files::again(&runs, &run) {
            return Err(file.wrong(&raw.file.span(), problem));
        }
        runs.push(run);
    }
    for (place, channel) in channels.iter().enumerate() {
        if runs.iter().all(|run: &Run| run.series[place].time.is_empty()) {
            let problem = format!("{}: column {:?} holds no number in any run", channel.name, channel.column);
            return Err(Error::Manifest { path: file.path.clone(), line: channel.line, problem });
        }
    }
    Ok(runs)
}

fn run(
    folder: &Path,
    file: &File,
    raw: &raw::Run,
    channels: &[Channel],
    notices: &mut Vec<Notice>,
) -> Result<Run, Error> {
    let name = raw.file.get_ref().clone();
    let path = run_files::find(folder, &name).map_err(|problem| file.wrong(&raw.file.span(), problem))?;
    let log = Log::read(&path)?;
    let times = times(&log, raw, file, &name, notices)?;
    let mut series = Vec::new();
    for channel in channels {
        let Some(place) = log.place(&channel.column).or_else(|| log.place(&channel.name)) else {
            let missing =
                |problem: String| Error::Manifest { path: file.path.clone(), line: channel.line, problem };
            return Err(missing(format!("{}: {}", channel.name, log.lacks(&channel.column))));
        };
        let mut measured = log.series(place, &times)?;
        measured.values.iter_mut().for_each(|value| *value = channel.conversion.apply(*value));
        if let (Role::Fed(_), true) = (channel.role, measured.time.is_empty()) {
            let problem =
                format!("{}: column {:?} of {name} holds no number to feed", channel.name, channel.column);
            return Err(Error::Manifest { path: file.path.clone(), line: channel.line, problem });
        }
        series.push(measured);
    }
    let compared =
        |(series, channel): (&Series, &Channel)| channel.role == Role::Compared && series.time.len() > 1;
    if !series.iter().zip(channels).any(compared) {
        return Err(file.wrong(&raw.file.span(), format!("{name}: fewer than two rows hold an output")));
    }
    let line = file.line(&raw.file.span());
    Ok(Run { name, line, seconds: seconds(raw, file)?, series })
}

fn times(
    log: &Log,
    raw: &raw::Run,
    file: &File,
    name: &str,
    notices: &mut Vec<Notice>,
) -> Result<super::log::Times, Error> {
    let time = raw.time.as_ref();
    let seconds = seconds(raw, file)?;
    let place = match time.and_then(|time| time.column.as_ref()) {
        Some(column) => log
            .place(column.get_ref())
            .ok_or_else(|| file.wrong(&column.span(), format!("time: {}", log.lacks(column.get_ref()))))?,
        None if log.columns.first().is_some_and(|first| first == "time") => 0,
        None => {
            let first = log.columns.first().map_or("", String::as_str);
            let problem = format!(
                "{name}: the first column is {first:?}, not \"time\"; write time = {{ column = {first:?}, unit = {:?} }}",
                clock::unit_in(first)
            );
            return Err(file.wrong(&raw.file.span(), problem));
        }
    };
    log.times(place, seconds, name, notices)
}

/// Of a unit of the time column.
fn seconds(raw: &raw::Run, file: &File) -> Result<f64, Error> {
    match raw.time.as_ref().and_then(|time| time.unit.as_ref()) {
        None => Ok(1.0),
        Some(unit) => measure::seconds(unit.get_ref()).map_err(|problem| file.wrong(&unit.span(), problem)),
    }
}

/// Variables that are states where no `[[state]]` says otherwise.
fn states_by_default(model: &Nominal) -> impl Iterator<Item = VariableId> {
    let every = (0..model.fmus.len()).flat_map(|instance| {
        let places = 0..model.description(instance).variables.len();
        places.map(move |place| VariableId { instance, place })
    });
    every.filter(|id| shows_its_start(model.variable(*id)))
}

fn states(
    model: &Nominal,
    channels: &[Channel],
    file: &File,
    notices: &mut Vec<Notice>,
) -> Result<Vec<State>, Error> {
    let measured = |shows: Option<VariableId>| {
        let shows = shows?;
        channels.iter().position(|channel| channel.variable == shows && channel.role == Role::Compared)
    };
    let entry = |start: VariableId, shows: Option<VariableId>| State {
        name: model.name(start),
        start,
        shows,
        channel: measured(shows),
    };
    if file.raw.state.is_empty() {
        return Ok(states_by_default(model).map(|id| entry(id, Some(id))).collect());
    }
    let mut states: Vec<State> = Vec::new();
    for raw in file.raw.state.iter().map(Spanned::get_ref) {
        let start = variable(model, &raw.start, file)?;
        let described = model.variable(start);
        let parameter =
            described.causality == Causality::Parameter && described.variability != Variability::Constant;
        if described.kind != Kind::Real || !(parameter || shows_its_start(described)) {
            let problem = format!(
                "{} can't be given a start value: `start` is a Real parameter, or an output or local variable of initial \
                 \"exact\"",
                model.name(start)
            );
            return Err(file.wrong(&raw.start.span(), problem));
        }
        if states.iter().any(|known| known.start == start) {
            return Err(
                file.wrong(&raw.start.span(), format!("a second [[state]] for {}", model.name(start)))
            );
        }
        let shows = raw.shows.as_ref().map(|name| shown(model, start, name, file)).transpose()?;
        states.push(entry(start, shows.or((!parameter).then_some(start))));
    }
    notices.extend(unlisted_states(model, &states, file));
    Ok(states)
}

/// The variable that a `shows` names, which measures what its start does.
fn shown(
    model: &Nominal,
    start: VariableId,
    name: &Spanned<String>,
    file: &File,
) -> Result<VariableId, Error> {
    let shows = variable(model, name, file)?;
    let of = |id: VariableId| (model.variable(id), model.description(id.instance));
    if measure::are_unlike(of(start), of(shows)) {
        let unit = |id: VariableId| model.variable(id).unit.as_deref().unwrap_or_default();
        let problem = format!(
            "{} is in {} and can't show {}, which is in {}: `shows` is the variable that has the start's value where a run begins",
            model.name(shows),
            unit(shows),
            model.name(start),
            unit(start)
        );
        return Err(file.wrong(&name.span(), problem));
    }
    Ok(shows)
}

/// What a user should know of variables that are states only where no `[[state]]` is written.
fn unlisted_states(model: &Nominal, states: &[State], file: &File) -> Option<Notice> {
    let is_listed =
        |id: &VariableId| states.iter().any(|state| state.start == *id || state.shows == Some(*id));
    let left: Vec<String> =
        states_by_default(model).filter(|id| !is_listed(id)).map(|id| model.name(id)).collect();
    let message = format!(
        "{} would be a state if no [[state]] were written, and is none now: each row begins with it where the unit starts; add a \
         [[state]] for what moves",
        left.join(", ")
    );
    let line = file.raw.state.first().map_or(0, |first| file.line(&first.span()));
    (!left.is_empty()).then(|| Notice { file: "dataset.toml".into(), line, message })
}

/// An output or local variable that is set before initialisation, and shows its value afterwards.
pub(crate) fn shows_its_start(variable: &Variable) -> bool {
    let seen = matches!(variable.causality, Causality::Output | Causality::Local);
    let moves = matches!(variable.variability, Variability::Continuous | Variability::Discrete);
    seen && moves && variable.kind == Kind::Real && variable.initial == Some(Initial::Exact)
}

fn ports(raw: &raw::Ports, file: &File) -> Result<Ports, Error> {
    let wrong = |name: &Spanned<String>, known: Vec<&str>| {
        let given = name.get_ref();
        file.wrong(
            &name.span(),
            format!("[ports] {given:?} is unknown: {}", nearest(given, known.into_iter())),
        )
    };
    let all = Ports::default();
    let inputs = raw.inputs.as_ref().map(|names| {
        let find = |name: &Spanned<String>| {
            let found = InputEffect::ALL.iter().find(|effect| effect.name() == name.get_ref()).copied();
            found.ok_or_else(|| wrong(name, InputEffect::ALL.iter().map(|effect| effect.name()).collect()))
        };
        names.iter().map(find).collect::<Result<Vec<_>, _>>()
    });
    let outputs = raw.outputs.as_ref().map(|names| {
        let find = |name: &Spanned<String>| {
            let found = OutputEffect::ALL.iter().find(|effect| effect.name() == name.get_ref()).copied();
            found.ok_or_else(|| wrong(name, OutputEffect::ALL.iter().map(|effect| effect.name()).collect()))
        };
        names.iter().map(find).collect::<Result<Vec<_>, _>>()
    });
    Ok(Ports {
        inputs: inputs.transpose()?.unwrap_or(all.inputs),
        outputs: outputs.transpose()?.unwrap_or(all.outputs),
        unknown_inputs: raw.unknown_inputs.unwrap_or(all.unknown_inputs),
    })
}
