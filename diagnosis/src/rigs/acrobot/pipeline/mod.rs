//! The workflow from a folder to a [`Diagnosis`]: plant first, then image, then what both say together.

mod averages;
mod blind;
mod camera;
mod clock;
mod conclude;
mod correct;
mod counted;
mod detectable;
mod effects;
mod even;
mod interval;
mod left_out;
mod noise;
mod plant;
mod policy;
mod saturations;
mod scale;
mod seats;
mod sensor;
mod whole;
mod zeros;

use crate::diagnosis::{Diagnosis, Verdict};
use crate::error::{Error, Notice};
use crate::options::Options;
use crate::rigs::acrobot::candidates::{Attribute, Candidate, LIST, Side, candidates};
use crate::rigs::acrobot::dataset::{DataSet, Run};
use crate::rigs::acrobot::gap;
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::parameters;
use crate::rigs::acrobot::pipeline::policy::PIPELINE;
use crate::rigs::acrobot::plausibility;
use crate::rigs::acrobot::residual::image::{Laws, Noise};
use crate::rigs::acrobot::residual::plant::jitter::unevenness;
use crate::rigs::acrobot::residual::trajectory::Motion as Logged;
use crate::rigs::acrobot::residual::{Cut, Signal, Tracked};
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::rigs::acrobot::selection::{Alternative, CLASS, Study, alternatives, study};
use crate::watch::{Listener, Watch};
use camera::camera_part;
use clock::{Clocks, doubts};
use conclude::conclude;
use left_out::{First, left_out, told};
use orchestrator::UnitPath;
use orchestrator::suggest::nearest;
use plant::plant_part;
use saturations::saturations;
use seats::seat;
use std::path::Path;
use std::sync::Arc;
use zeros::Zeros;

/// Whether all that was chosen can be.
fn check(options: &Options) -> Result<(), Error> {
    let general = |option, given: String, what: &str| {
        let problem = format!("{what} for data sets of `format = 2`; this one is of `format = 1`");
        Err(Error::Option { option, given, problem })
    };
    if let Some(given) = options.fit.first() {
        return general("--fit", given.clone(), "parameters are fitted");
    }
    if let Some(isolation) = &options.isolation {
        let limit = format!("({} s a call)", isolation.step_limit.as_secs_f64());
        return general("--isolate", limit, "units run in processes of their own");
    }
    let known = || LIST.iter().filter(|entry| !entry.side.is_of_log()).map(|entry| entry.name);
    match options.without.iter().find(|given| known().all(|name| name != given.as_str())) {
        None => Ok(()),
        Some(given) => {
            let problem = format!("no candidate has this name; {}", nearest(given, known()));
            Err(Error::Option { option: "--without", given: given.clone(), problem })
        }
    }
}

/// One cut with all that was found on it.
struct Part {
    study: Study,
    signals: Vec<Signal>,
    classes: Vec<(usize, Vec<Alternative>)>,
    torque: bool,
    /// What torques found before the plant could follow the log.
    coarse: Vec<usize>,
    /// What the scatter of the image says of the sensor.
    noise: Option<Noise>,
    /// By how much some values differ from one linearisation to the next.
    rough: Vec<(usize, f64)>,
    /// What moving candidates does to the image.
    laws: Laws,
    /// What is known of whole numbers.
    whole: Vec<whole::Whole>,
    /// What zeros of encoders explain as well.
    shared: Vec<zeros::Shared>,
}

/// Diagnoses a data set. `listener` hears of each stage.
///
/// # Errors
/// The data set or the nominal model can't be used, or a unit failed.
pub fn diagnose(
    path: &Path,
    units: &UnitPath,
    options: &Options,
    listener: Listener<'_>,
) -> Result<Diagnosis, Error> {
    check(options)?;
    let (watch, began) = (&mut Watch::by(options.now, listener, None), (options.now)());
    watch.stage("the logs are read");
    let mut data = DataSet::load(path)?;
    if let Some(until) = options.budget.end(began, data.runs.len()) {
        watch.end_at(until);
    }
    let model = Model::load(&data, units)?;
    if model.camera.is_none() {
        data.without_pictures(&format!(
            "the scenario `{}` has no unit `camera`",
            data.manifest.scenario.clone()
        ))?;
    }
    let contact = data.contact(model.number(parameters::LIMIT).unwrap_or(f64::INFINITY));
    let mut list = candidates(&model, &options.without, &|cuts| saturations(&data, cuts, contact));
    let seen = data.runs.iter().any(|run| run.camera.is_some());
    if !data.runs.iter().any(Run::logs_the_torque) {
        // what nobody drives has no motor that could be off; one that is told 0 may be
        list.retain(|candidate| !candidate.is(Attribute::Bias));
    }
    if data.pictures_apart {
        let delay = list.iter_mut().filter(|candidate| candidate.is(Attribute::ImageDelay));
        delay.for_each(|delay| delay.side = Side::Timestamps);
    }
    let logs = data.runs.iter().filter_map(|run| run.plant.as_ref());
    data.late_by_hand = PIPELINE.late_by_hand * logs.map(|log| unevenness(&log.time)).fold(0.0, f64::max);
    if !seen || data.pictures_apart {
        // nobody but the camera could tell a log that is stamped late from an actuator's delay: that is named, but where it is
        // within what timestamps scatter by
        let clocks = list.iter_mut().filter(|candidate| candidate.side == Side::Clock);
        clocks.for_each(|clock| clock.range.1 = clock.range.1.min(data.late_by_hand));
    }
    if data.clocks_apart {
        trust_no_clock(&mut list);
    }
    let mut list = Arc::new(list);
    watch.stage("do the logs count as the model does?");
    if let Some(finding) = plausibility::motion::counted(&data, &model, &list)? {
        return Err(Error::Implausible { path: path.to_owned(), finding: Box::new(finding) });
    }
    if let Some(even) = even::evened(&data, &model, &list) {
        watch.stage("plant: timestamps set to the ticks of their clocks");
        data = even;
    }
    let mut notices = data.notices.clone();
    notices.extend(model.notices(&data));
    let none = Laws::default();
    let mut compared = compare(&data, &model, &list, options, &none, watch)?;
    if noise::forget_understated(&mut data, &model, &list, &compared.parts, &mut notices) {
        watch.stage("compared again with the noise that rows show");
        compared = compare(&data, &model, &list, options, &none, watch)?;
    }
    let mut clocks = Clocks::new(&data);
    while let Some(late) =
        clocks.late(&list, &compared).filter(|_| !watch.is_over("the search for clocks that are off"))
    {
        watch.stage("plant: the log's clock is put right");
        late.iter().for_each(|(run, late)| data.set_back(*run, *late));
        if clocks.apart() {
            data.clocks_apart = true;
            trust_no_clock(Arc::<Vec<Candidate>>::make_mut(&mut list));
        }
        compared = compare(&data, &model, &list, options, &none, watch)?;
    }
    let zeros = zeros_cleared(&mut data, &model, &mut list, options, &mut compared, watch)?;
    let Compared { mut parts, mut point, notices: more } = compared;
    notices.extend(more);
    if parts.is_empty() {
        return Err(Error::NothingUsable { path: path.to_owned(), notices });
    }
    notices.extend(clocks.clear(&model, &list, &mut parts, &mut point));
    notices.extend(zeros.clear(&list, &mut parts, &mut point));
    let known = remembered(options, &list, &mut parts);
    let (mut diagnosis, compared) = conclude(&data, &model, &list, &parts, &point, notices, units, watch)?;
    diagnosis.story.splice(0..0, clocks.story());
    diagnosis.story.extend(known);
    if parts.iter().any(|part| !part.study.active.is_empty()) || diagnosis.correction.is_some() {
        let correction = diagnosis.correction.as_ref();
        let gaps = &diagnosis.cross_validation;
        let first = First { parts: &parts, compared: &compared, correction, gaps, point: &point };
        match left_out(&data, &model, &list, options, &first, units, watch) {
            Ok(Some(left_out)) => told(&mut diagnosis, left_out),
            Ok(None) => {}
            // a part of the runs may be too little for a search; what was found with all of them stands
            Err(error) => diagnosis.notices.push(Notice {
                file: "dataset.toml".into(),
                line: 0,
                message: format!(
                    "the gap is told by cross-validation, since no search can be repeated: {error}"
                ),
            }),
        }
    }
    no_merit(&mut diagnosis, &parts, &list);
    if let Some(blind) = blind::blind(&data, &model)? {
        diagnosis.unknown.get_or_insert(blind);
        diagnosis.verdict = Verdict::Unknown;
    }
    diagnosis.ended_early = watch.ended().to_vec();
    if !diagnosis.ended_early.is_empty() {
        let ended = diagnosis.ended_early.join("; ");
        let budget = options.budget.seconds(data.runs.len());
        diagnosis.story.push(format!("Time was up after {budget:.0} s: {ended} ended with what was there."));
    }
    Ok(diagnosis)
}

/// Takes away from a gap what no effect that is told closes: clocks that were put right, which a repeated search finds again as delays.
fn no_merit(diagnosis: &mut Diagnosis, parts: &[Part], list: &[Candidate]) {
    let effects: Vec<&str> = diagnosis.effects.iter().map(|effect| effect.name.as_str()).collect();
    for (part, gap) in parts.iter().zip(&mut diagnosis.gaps) {
        let own: Vec<&str> = part.study.active.iter().map(|index| list[*index].name).collect();
        let signals: Vec<&str> = part.signals.iter().map(|signal| signal.name.as_str()).collect();
        let corrected = part.torque && diagnosis.correction.is_some();
        if !corrected && !gap::is_closed_by(&effects, &own, &signals) {
            *gap = gap::unchanged(gap.clone());
        }
    }
    if let Some(widest) = diagnosis.gaps.iter().max_by(|a, b| gap::above(a).total_cmp(&gap::above(b))) {
        diagnosis.gap = widest.clone();
    }
}

/// Weighs all classes with what an earlier diagnosis said; in words.
fn remembered(options: &Options, list: &[Candidate], parts: &mut [Part]) -> Vec<String> {
    let classes = parts.iter_mut().flat_map(|part| &mut part.classes);
    let known = |(effect, class): &mut (usize, Vec<Alternative>)| {
        let known = options.earlier.as_ref()?.weigh(list, class)?;
        Some(format!(
            "The earlier diagnosis left {} open where {} was found here: both count.",
            known.join(" or "),
            list[*effect].name
        ))
    };
    classes.filter_map(known).collect()
}

/// Turns the plant's logs back by what pictures say their zeros are off, and compares all again: kept if so the machine lacks no more
/// than before, else no zero is in question.
fn zeros_cleared(
    data: &mut DataSet,
    model: &Model,
    list: &mut Arc<Vec<Candidate>>,
    options: &Options,
    compared: &mut Compared,
    watch: &mut Watch<'_>,
) -> Result<Zeros, Error> {
    let mut zeros = Zeros::default();
    while let Some(off) =
        zeros.seen(list, compared).filter(|_| !watch.is_over("the search for zeros that are off"))
    {
        watch.stage("plant: the log's angles are turned to where images have them");
        zeros.turn(data, off);
        let again = compare(data, model, list, options, &Laws::default(), watch)?;
        if zeros::effects(&again, list) <= zeros::effects(compared, list) {
            *compared = again;
            continue;
        }
        zeros.turn(data, off.map(|off| -off));
        Arc::<Vec<Candidate>>::make_mut(list).retain(|candidate| candidate.side != Side::Zero);
        *compared = compare(data, model, list, options, &Laws::default(), watch)?;
    }
    Ok(zeros)
}

/// Lets logs be late by as much as any other, where their clocks are known to be off.
fn trust_no_clock(list: &mut [Candidate]) {
    let clocks = list.iter_mut().filter(|candidate| candidate.side == Side::Clock);
    clocks.for_each(|clock| clock.range = (-PIPELINE.any, PIPELINE.any));
}

/// What all cuts say.
struct Compared {
    parts: Vec<Part>,
    point: Vec<f64>,
    notices: Vec<Notice>,
}

/// All cuts of a data set. What candidates do to the image is taken from `laws` where they say it.
fn compare(
    data: &DataSet,
    model: &Model,
    list: &Arc<Vec<Candidate>>,
    options: &Options,
    laws: &Laws,
    watch: &mut Watch<'_>,
) -> Result<Compared, Error> {
    let off = || list.iter().map(|candidate| candidate.off).collect();
    let mut point: Vec<f64> = watch.known().map_or_else(off, |known| known.point.clone());
    let mut parts = Vec::new();
    let mut notices = Vec::new();
    let motions = plant_part(data, model, list, &mut point, &mut parts, &mut notices, watch)?;
    camera_part(data, model, list, motions, options, laws, &mut point, &mut parts, &mut notices, watch)?;
    Ok(Compared { parts, point, notices })
}

fn part(
    cut: &mut Tracked,
    list: &[Candidate],
    point: &[f64],
    known: &[usize],
    torque: bool,
    watch: &mut Watch<'_>,
) -> Result<Part, Error> {
    // what a first search found is on, unless it is superfluous here
    let before = watch.known().into_iter().flat_map(|before| before.active.iter().copied());
    let before = before.filter(|index| cut.sees(&list[*index]) && !known.contains(index));
    let known: Vec<usize> = known.iter().copied().chain(before).collect();
    let study = study(cut, list, point, &known, watch)?;
    classed(cut, list, study, torque, watch)
}

/// What was found on a cut, with all that could stand in the place of each effect.
fn classed(
    cut: &mut Tracked,
    list: &[Candidate],
    mut study: Study,
    torque: bool,
    watch: &mut Watch<'_>,
) -> Result<Part, Error> {
    let mut classes = Vec::new();
    let named = if watch.known().is_some() { Vec::new() } else { study.active.clone() };
    for mut effect in named {
        let known = study.class.as_ref().filter(|(accepted, _)| *accepted == effect);
        let mut class = match known {
            Some((_, class)) => class.clone(),
            None => alternatives(cut, list, &study.last, &study.active, effect, &study.steps, watch)?,
        };
        seat(cut, list, &mut study, (&mut effect, &mut class), SELECTION.settled)?;
        classes.push((effect, class));
    }
    let whole = if watch.known().is_some() { Vec::new() } else { whole::whole(cut, list, &study) };
    Ok(Part {
        study,
        signals: cut.signals().to_vec(),
        classes,
        torque,
        coarse: Vec::new(),
        noise: None,
        rough: Vec::new(),
        laws: Laws::default(),
        whole,
        shared: Vec::new(),
    })
}
