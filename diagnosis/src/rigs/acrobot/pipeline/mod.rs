//! The workflow from a folder to a [`Diagnosis`]: plant first, then image, then what both say together.
//!
//! [`diagnose`] goes the whole way, a file for each step: `prepare.rs` reads, `compare.rs` searches each cut of the loop
//! (`compare_plant.rs`, `compare_images.rs`), `clear_logs.rs` corrects what logs are wrong by and compares again, `conclude.rs` says
//! what all parts show, and `held_out.rs` repeats the search for the gap.

mod averaged_values;
mod clear_logs;
mod clock_ticks;
mod compare;
mod compare_images;
mod compare_plant;
mod conclude;
mod detectable;
mod effects;
mod encoder_zeros;
mod fit_correction;
mod held_out;
mod integer_interval;
mod intervals;
mod log_clocks;
mod noise_and_losses;
mod policy;
mod prepare;
mod replace_effect;
mod saturations;
mod sensor_noise;
mod tell_held_out;
mod torque_scale;
mod understated_noise;
mod unseen_circles;

use crate::diagnosis::{Diagnosis, Verdict};
use crate::error::{Error, Notice};
use crate::options::Options;
use crate::rigs::acrobot::candidates::{Candidate, LIST};
use crate::rigs::acrobot::dataset::DataSet;
use crate::rigs::acrobot::gap;
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::residual::image::Laws;
use crate::rigs::acrobot::residual::plant::PlantCut;
use crate::rigs::acrobot::residual::weak::Weak;
use crate::rigs::acrobot::selection::Alternative;
use crate::watch::{Listener, Watch};
use clear_logs::{correct_clocks, correct_noise, correct_zeros};
use compare::{Compared, Part, compare};
use conclude::conclude;
use held_out::{FirstSearch, hold_out};
use orchestrator::UnitPath;
use orchestrator::suggest::nearest;
use prepare::{plausible, prepare};
use std::path::Path;
use std::sync::Arc;
use tell_held_out::tell_held_out;
use unseen_circles::frames_without_circles;

/// The logs, the model that they are compared with, and all that it may lack.
struct Rig<'a> {
    data: DataSet,
    model: &'a Model,
    /// The candidates.
    list: Arc<Vec<Candidate>>,
    /// Where units are found.
    units: &'a UnitPath,
    options: &'a Options,
}

impl Rig<'_> {
    /// The plant followed in windows of its logs; `None` where these hold no motion with its torque.
    fn plant_cut(&self) -> Result<Option<Tracked<PlantCut>>, Error> {
        Ok(PlantCut::new(&self.data, self.model, self.list.clone())?.map(Tracked::new))
    }

    /// The torques that the plant lacks at the logged states; `None` where logs tell none.
    fn torque_cut(&self) -> Result<Option<Tracked<Weak>>, Error> {
        Ok(Weak::new(&self.data, self.model, self.list.clone())?.map(Tracked::new))
    }

    /// Coordinates of all candidates at the nominal model.
    fn nominal_point(&self) -> Vec<f64> {
        self.list.iter().map(|candidate| candidate.off).collect()
    }

    /// Whether any run holds images.
    fn has_images(&self) -> bool {
        self.data.runs.iter().any(|run| run.camera.is_some())
    }
}

/// Whether all that was chosen can be.
fn check_options(options: &Options) -> Result<(), Error> {
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
    check_options(options)?;
    let (watch, began) = (&mut Watch::by(options.now, listener, None), (options.now)());
    watch.stage("the logs are read");
    let data = DataSet::load(path)?;
    if let Some(until) = options.budget.end(began, data.runs.len()) {
        watch.end_at(until);
    }
    let model = Model::load(&data, units)?;
    let rig = prepare(data, &model, units, options)?;
    let mut rig = plausible(rig, path, watch)?;
    let mut notices = rig.data.notices.clone();
    notices.extend(model.notices(&rig.data));

    let first = compare(&rig, &Laws::default(), watch)?;
    let compared = correct_noise(&mut rig, first, &mut notices, watch)?;
    let (mut clocks, compared) = correct_clocks(&mut rig, compared, watch)?;
    let (zeros, mut compared) = correct_zeros(&mut rig, compared, watch)?;
    notices.append(&mut compared.notices);
    if compared.parts.is_empty() {
        return Err(Error::NothingUsable { path: path.to_owned(), notices });
    }
    notices.extend(clocks.remove_from_effects(&model, &rig.list, &mut compared));
    notices.extend(zeros.remove_from_effects(&rig.list, &mut compared));

    let known = weigh_earlier(options, &rig.list, &mut compared.parts);
    let (mut diagnosis, measures) = conclude(&rig, &compared, notices, watch)?;
    diagnosis.story.splice(0..0, clocks.story());
    diagnosis.story.extend(known);
    judge_held_out(&rig, &compared, &measures, &mut diagnosis, watch);
    remove_gaps_without_effect(&mut diagnosis, &compared.parts, &rig.list);
    if let Some(unseen) = frames_without_circles(&rig)? {
        diagnosis.unknown.get_or_insert(unseen);
        diagnosis.verdict = Verdict::Unknown;
    }
    tell_early_end(&mut diagnosis, &rig, watch);
    Ok(diagnosis)
}

/// Repeats the search without a part of the runs, where one found anything, and puts the gap of the runs left out into the diagnosis.
fn judge_held_out(
    rig: &Rig<'_>,
    compared: &Compared,
    measures: &[gap::Measure],
    diagnosis: &mut Diagnosis,
    watch: &mut Watch<'_>,
) {
    let found = compared.parts.iter().any(|part| !part.study.active.is_empty());
    let beside = compared.parts.iter().any(|part| part.has_circle_beside(&rig.list));
    if beside || !found && diagnosis.correction.is_none() {
        return;
    }
    let correction = diagnosis.correction.as_ref();
    let first = FirstSearch { compared, measures, correction, gaps: &diagnosis.cross_validation };
    match hold_out(rig, &first, watch) {
        Ok(Some(held_out)) => tell_held_out(diagnosis, held_out),
        Ok(None) => {}
        // a part of the runs may be too little for a search; what was found with all of them stands
        Err(error) => diagnosis.notices.push(Notice {
            file: "dataset.toml".into(),
            line: 0,
            message: format!("the gap is told by cross-validation, since no search can be repeated: {error}"),
        }),
    }
}

/// Says which searches ended early, since time was up.
fn tell_early_end(diagnosis: &mut Diagnosis, rig: &Rig<'_>, watch: &Watch<'_>) {
    diagnosis.ended_early = watch.ended().to_vec();
    if !diagnosis.ended_early.is_empty() {
        let ended = diagnosis.ended_early.join("; ");
        let budget = rig.options.budget.seconds(rig.data.runs.len());
        diagnosis.story.push(format!("Time was up after {budget:.0} s: {ended} ended with what was there."));
    }
}

/// Takes away from a gap what no effect that is told closes: clocks that were put right, which a repeated search finds again as delays.
fn remove_gaps_without_effect(diagnosis: &mut Diagnosis, parts: &[Part], list: &[Candidate]) {
    let effects: Vec<&str> = diagnosis.effects.iter().map(|effect| effect.name.as_str()).collect();
    for (part, gap) in parts.iter().zip(&mut diagnosis.gaps) {
        let own: Vec<&str> = part.study.active.iter().map(|index| list[*index].name).collect();
        let signals: Vec<&str> = part.signals.iter().map(|signal| signal.name.as_str()).collect();
        let corrected = part.torque && diagnosis.correction.is_some();
        if !corrected && !gap::is_closed_by(&effects, &own, &signals) {
            *gap = gap::without_effects(gap.clone());
        }
    }
    if let Some(widest) =
        diagnosis.gaps.iter().max_by(|a, b| gap::above_floor(a).total_cmp(&gap::above_floor(b)))
    {
        diagnosis.gap = widest.clone();
    }
}

/// Weighs all classes with what an earlier diagnosis left open; in sentences for the story.
fn weigh_earlier(options: &Options, list: &[Candidate], parts: &mut [Part]) -> Vec<String> {
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
