//! What moving a candidate, or the arm, does to the picture: secants over steps of some pixels, smooth over poses.

use super::surface::{Surface, Terms};
use super::*;
use crate::residual::trajectory::State;
use crate::statistics::random::Random;

/// Angle over which the picture's change with pose is taken: two pixels at the joint.
const TURN: f64 = 0.012;
/// How far a pose is moved (rad) before a candidate's column is taken there: half a pixel at circle 1 and more at the
/// others, twice, to either side. At the pose itself, residual and column would share the lattice's error of the very
/// frame that both are differences from, and whatever blurs or dims would seem to be there (regression dilution,
/// upside down: Fuller, *Measurement Error Models*, Wiley 1987, section 1.1).
const DITHER: [f64; 2] = [0.02, 0.01];
const DITHER_SEED: u64 = 0x0ac0_d17e;
/// Rounds of such poses for a short exposure, whose blur is little beside the lattice's error.
const SHORT_ROUNDS: u64 = 8;
/// Step of E_t from which its blur is more than that.
const BLURRING: f64 = 0.2;

impl ImageCut {
    /// Change of the picture with each angle.
    pub(super) fn turned(
        &self,
        settings: &[Setting],
        shots: &[Shot],
    ) -> Result<Vec<[Option<Seen>; 2]>, Error> {
        let mut sides = Vec::with_capacity(2);
        for angle in 0..2 {
            let moved = |by: f64| -> Vec<Shot> {
                let turn = |state: &State| {
                    let mut turned = *state;
                    turned[angle] += by;
                    turned
                };
                shots.iter().map(|shot| Shot { before: turn(&shot.before), end: turn(&shot.end) }).collect()
            };
            let (up, down) =
                (self.studio.take(settings, &moved(TURN))?, self.studio.take(settings, &moved(-TURN))?);
            let raw = slopes(&up, &down, 2.0 * TURN);
            let samples: Vec<(State, Seen)> =
                shots.iter().zip(&raw).filter_map(|(shot, seen)| Some((shot.end, (*seen)?))).collect();
            let surface = Surface::fit(&samples, Terms::Poses);
            sides.push(
                (0..raw.len()).map(|place| surface.or(raw[place], &shots[place].end)).collect::<Vec<_>>(),
            );
        }
        let second = sides.pop().unwrap_or_default();
        let first = sides.pop().unwrap_or_default();
        Ok(first.into_iter().zip(second).map(|(a, b)| [a, b]).collect())
    }

    /// What an exposure that is longer by one interval would do by its earlier middle alone.
    fn late(&self, place: usize) -> Option<Seen> {
        let frame = &self.frames[place];
        let (one, two) = match self.turns.as_deref()?.get(place)? {
            [Some(one), Some(two)] => (one, two),
            _ => return None,
        };
        let earlier = 0.5 * self.interval();
        let [.., dq1, dq2] = frame.shot.end;
        Some(std::array::from_fn(|s| -earlier * (one[s] * dq1 + two[s] * dq2)))
    }

    /// Shots a little beside the frames' poses.
    fn beside(&self, round: u64, side: f64) -> Vec<Shot> {
        let moved = |state: &State, by: &[f64; 2]| {
            [state[0] + side * by[0], state[1] + side * by[1], state[2], state[3]]
        };
        let mut random = Random::new(DITHER_SEED + round);
        self.frames
            .iter()
            .map(|frame| {
                let by = DITHER.map(|most| most * (2.0 * random.uniform() - 1.0));
                Shot { before: moved(&frame.shot.before, &by), end: moved(&frame.shot.end, &by) }
            })
            .collect()
    }

    /// Change of the picture per unit of a candidate.
    pub(super) fn column(&mut self, point: &[f64], probe: Probe) -> Result<Vec<Option<Seen>>, Error> {
        let key = (probe.candidate, probe.by.to_bits());
        if let Some(kept) = self.kept.get(&key) {
            return Ok(kept.clone());
        }
        let blurs = Some(probe.candidate) == self.exposure;
        let late = |cut: &Self, place: usize| if blurs { cut.late(place) } else { Some([0.0; 9]) };
        let (moved, still) = (self.settings(point, Some(probe))?, self.settings(point, None)?);
        let mut samples: Vec<(State, Seen)> = Vec::new();
        let mut first = Vec::new();
        let rounds = if blurs && probe.by.abs() < BLURRING { SHORT_ROUNDS } else { 1 };
        for (round, side) in (0..rounds).flat_map(|round| [(round, 1.0), (round, -1.0)]) {
            let shots = self.beside(round, side);
            let here = self.here(&still, &shots)?;
            let column = slopes(&self.studio.take(&moved, &shots)?, &here, probe.by);
            for (place, (shot, seen)) in shots.iter().zip(&column).enumerate() {
                if let (Some(seen), Some(late)) = (seen, late(self, place)) {
                    samples.push((shot.end, std::array::from_fn(|s| seen[s] - late[s])));
                }
            }
            if first.is_empty() {
                first = column;
            }
        }
        let surface = Surface::fit(&samples, if blurs { Terms::Motions } else { Terms::Poses });
        let column: Vec<Option<Seen>> = (0..first.len())
            .map(|place| {
                let smooth = surface.at(&self.frames[place].shot.end);
                let (smooth, late) = (smooth.zip(first[place]).map(|(smooth, _)| smooth), late(self, place));
                match (smooth, late) {
                    (Some(smooth), Some(late)) => Some(std::array::from_fn(|s| smooth[s] + late[s])),
                    _ => first[place],
                }
            })
            .collect();
        self.kept.insert(key, column.clone());
        Ok(column)
    }

    /// Frames without a candidate moved, made once for all columns.
    fn here(&mut self, still: &[Setting], shots: &[Shot]) -> Result<Vec<Option<Seen>>, Error> {
        if let Some(known) = self.still.iter().find(|known| known.0 == still && known.1 == shots) {
            return Ok(known.2.clone());
        }
        let here = self.studio.take(still, shots)?;
        self.still.retain(|known| known.0 == still);
        self.still.push((still.to_vec(), shots.to_vec(), here.clone()));
        Ok(here)
    }
}

fn slopes(moved: &[Option<Seen>], base: &[Option<Seen>], by: f64) -> Vec<Option<Seen>> {
    moved
        .iter()
        .zip(base)
        .map(|(moved, base)| {
            let (moved, base) = (moved.as_ref()?, base.as_ref()?);
            Some(std::array::from_fn(|s| (moved[s] - base[s]) / by))
        })
        .collect()
}
