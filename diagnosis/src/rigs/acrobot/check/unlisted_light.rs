//! Light that is not the same all over the image: areas of circles that grow along u or along v, beside what all differ by and beside the
//! effects that are on; or the area of one circle alone, which such a law is mostly a difference from.

use super::beside::{Laws, surest};
use super::torque_shape::{nearest, square};
use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::residual::image::IMAGES;
use crate::rigs::acrobot::residual::studio::{AREAS, circle_of};
use crate::rigs::acrobot::selection::Evaluation;
use crate::statistics::levels::{CERTAIN, DOUBTED};
use crate::statistics::linear::Cell;
use nalgebra::DMatrix;
use std::ops::Range;

/// Directions of growth, with what depends on them.
const ALONG: [&str; 2] = ["u", "v"];
/// Places of the laws: growth of all circles along u and v; what all differ by; what one circle differs by, and its own growth.
const ALL: Range<usize> = 0..ALONG.len();
const LEVEL: Range<usize> = ALL.end..ALL.end + 1;
const OWN: Range<usize> = LEVEL.end..LEVEL.end + 1 + ALL.end;

/// Such a light, where nothing else has no name.
pub(super) fn doubt(found: &Found<'_>, so_far: Option<&Unknown>) -> Judgement {
    if so_far.is_some() || found.torque {
        return Judgement::Keep;
    }
    let areas = Areas { at: &found.study.last, active: &found.study.active, signals: found.signals };
    areas.told().map(|told| told.unknown(found)).into()
}

/// What areas do that has no name: the signal, what it depends on, and words.
#[derive(Debug, PartialEq)]
struct Told {
    signal: usize,
    depends_on: Option<&'static str>,
    shape: String,
}

impl Told {
    fn unknown(self, found: &Found<'_>) -> Unknown {
        Unknown {
            signal: found.signals[self.signal].name.clone(),
            depends_on: self.depends_on.into_iter().map(Into::into).collect(),
            shape: self.shape,
            nearest: nearest(found.study, found.list),
            ..Unknown::default()
        }
    }
}

/// What a model leaves of areas.
struct Areas<'a> {
    at: &'a Evaluation,
    /// The effects that are on.
    active: &'a [usize],
    signals: &'a [Signal],
}

impl Areas<'_> {
    /// What they do, if that is more than right renderers differ by.
    fn told(&self) -> Option<Told> {
        let law = self.surest(AREAS.start, ALL, LEVEL);
        let grows = law.filter(|(_, deviations)| deviations.abs() > CERTAIN);
        let by = level(self.at).filter(|by| by.abs() > IMAGES.unlit);
        if grows.is_none() && by.is_none() {
            return None;
        }
        let alike = || by.map(|by| self.all_alike(by + by.signum() * IMAGES.level));
        let law = law.map_or(0.0, |(_, deviations)| deviations);
        self.alone(law).or_else(alike).or_else(|| grows.map(|grows| self.growing(grows)))
    }

    /// The surest of some laws, where `area`'s own are the last three.
    fn surest(&self, area: usize, asked: Range<usize>, free: Range<usize>) -> Option<(usize, f64)> {
        let count = asked.end.max(free.end);
        let columns = |cell: &Cell| columns(cell, area).columns(0, count).into_owned();
        surest(self.at, self.active, self.signals, &Laws { columns: &columns, asked, free })
    }

    /// The one circle that is off: told far more surely than any growth of all, and without it there is no such growth.
    fn alone(&self, law: f64) -> Option<Told> {
        let own = |area: usize| Some((area, self.surest(area, OWN, LEVEL)?));
        let most = |one: &(usize, (usize, f64)), other: &(usize, (usize, f64))| {
            one.1.1.abs().total_cmp(&other.1.1.abs())
        };
        let (area, (own, deviations)) = AREAS.filter_map(own).max_by(most)?;
        let others = self.surest(area, ALL, LEVEL.start..OWN.end).map_or(0.0, |(_, deviations)| deviations);
        let clear = deviations * deviations - law * law > CERTAIN * CERTAIN;
        if !clear || others.abs() > CERTAIN {
            return None;
        }
        let direction = (own - OWN.start).checked_sub(1).map(|place| ALONG[place]);
        let how = match direction {
            Some(along) => format!("{} along {along}", grows(deviations)),
            None if deviations < 0.0 => "is smaller than the others say".into(),
            None => "is larger than the others say".into(),
        };
        let shape = format!(
            "the area of circle {} alone {how} ({:.1} standard deviations): light or sensitivity that isn't even, or its marker",
            circle_of(area) + 1,
            deviations.abs()
        );
        Some(Told { signal: area, depends_on: direction, shape })
    }

    /// Areas that grow along u or v, all of them where each says so by itself.
    fn growing(&self, (law, deviations): (usize, f64)) -> Told {
        let own = OWN.start + 1 + law;
        let by_itself = |area: usize| self.surest(area, own..own + 1, LEVEL.start..OWN.start + 1);
        let says = |area: usize| {
            by_itself(area).is_some_and(|(_, own)| own.abs() > DOUBTED && (own < 0.0) == (deviations < 0.0))
        };
        let mut areas = AREAS;
        let what = if areas.all(says) { "the area of every circle" } else { "the area of circles" };
        let shape = format!(
            "{what} {} along {} ({:.1} standard deviations): light or sensitivity that isn't even",
            grows(deviations),
            ALONG[law],
            deviations.abs()
        );
        Told { signal: self.largest(), depends_on: Some(ALONG[law]), shape }
    }

    /// Circles that are all larger or smaller by so much, px.
    fn all_alike(&self, by: f64) -> Told {
        let than = if by < 0.0 { "smaller" } else { "larger" };
        let shape = format!(
            "constant: all circles are {:.1} px {than} than the model has them: another light, threshold or size of the markers",
            by.abs()
        );
        Told { signal: self.largest(), depends_on: None, shape }
    }

    /// The area of which most is left.
    fn largest(&self) -> usize {
        let most = |one: &usize, other: &usize| square(self.at, *one).total_cmp(&square(self.at, *other));
        AREAS.max_by(most).unwrap_or(AREAS.start)
    }
}

fn grows(deviations: f64) -> &'static str {
    if deviations < 0.0 { "shrinks" } else { "grows" }
}

/// By how much all areas differ from the model's alike, px, beyond what right renderers may; nothing where no area was logged.
fn level(at: &Evaluation) -> Option<f64> {
    let cells = at.blocks.iter().flat_map(|block| &block.cells);
    let rows = cells.flat_map(|cell| cell.signal.iter().zip(&cell.residual));
    let areas = rows.filter(|(signal, _)| AREAS.contains(signal));
    let (sum, count) = areas.fold((0.0, 0.0), |(sum, count), (_, by)| (sum + by, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

/// By how much each law changes the rows of a frame; the last three are those of one `area`.
fn columns(cell: &Cell, area: usize) -> DMatrix<f64> {
    let of = |row: usize| match cell.drawn.get(row) {
        Some(drawn) if AREAS.contains(&cell.signal[row]) => {
            let [u, v] = drawn.place;
            let own = if cell.signal[row] == area { 1.0 } else { 0.0 };
            [u, v, 1.0, own, own * u, own * v]
        }
        _ => [0.0; OWN.end],
    };
    DMatrix::from_fn(cell.residual.len(), OWN.end, |row, law| of(row)[law])
}

#[cfg(test)]
mod tests {
    use super::super::examples::{frames, place, signals};
    use super::*;

    /// What is told where the areas of frames are off by so much, by the signal and its circle's place, px.
    fn told(off: impl Fn(usize, [f64; 2]) -> f64) -> Option<Told> {
        let at = frames(
            |moment, signal| {
                if AREAS.contains(&signal) { off(signal, place(signal, moment.state)) } else { 0.0 }
            },
        );
        Areas { at: &at, active: &[0], signals: &signals() }.told()
    }

    /// The same with areas that grow by so much per px along u and along v, and all of them by so much.
    fn growing(along: [f64; 2], all: f64) -> Option<Told> {
        told(|_, [u, v]| all + along[0] * u + along[1] * v)
    }

    #[test]
    fn law_light_that_falls_to_one_side_is_told_with_the_side() {
        let along_u = growing([0.01, 0.0], 0.3).expect("0.6 px are told");
        assert!(along_u.shape.contains("grows along u") && along_u.depends_on == Some("u"), "{along_u:?}");
        let along_v = growing([0.0, -0.01], 0.0).expect("3 px are told");
        assert!(along_v.shape.contains("shrinks along v") && along_v.depends_on == Some("v"), "{along_v:?}");
        // the drum stays where it is, and says nothing of it
        assert!(along_v.shape.starts_with("the area of circles "), "{along_v:?}");
    }

    #[test]
    fn law_one_circle_in_another_light_is_told_alone() {
        let tip = AREAS.end - 1;
        let larger = told(|signal, _| if signal == tip { 1.2 } else { 0.0 }).expect("1.2 px are told");
        assert_eq!(larger.signal, tip);
        assert!(larger.shape.starts_with("the area of circle 3 alone is larger"), "{larger:?}");
        // stray light at one place that it comes by
        let stray = |[u, v]: [f64; 2]| 6.0 * libm::exp(-((u - 20.0).powi(2) + (v - 130.0).powi(2)) / 3200.0);
        let stray = told(|signal, at| if signal == tip { stray(at) } else { 0.0 }).expect("6 px are told");
        assert!(stray.signal == tip && stray.shape.starts_with("the area of circle 3 alone "), "{stray:?}");
        let joint = told(|signal, _| if signal == tip - 1 { -3.0 } else { 0.0 }).expect("3 px are told");
        assert!(joint.shape.starts_with("the area of circle 2 alone is smaller"), "{joint:?}");
    }

    #[test]
    fn law_all_circles_alike_are_told_as_all() {
        let all = growing([0.0; 2], 3.0).expect("3 px are told");
        assert!(all.shape.starts_with("constant: all circles are 4.0 px larger"), "{all:?}");
    }

    #[test]
    fn law_the_level_is_that_of_areas_alone() {
        let at = frames(|_, signal| if AREAS.contains(&signal) { 2.5 } else { 9.0 });
        assert!(level(&at).is_some_and(|by| (by - 2.5).abs() < 0.5), "{:?}", level(&at));
    }

    #[test]
    fn law_what_all_areas_differ_by_is_no_such_light() {
        assert_eq!(growing([0.0; 2], 0.3), None);
    }
}
