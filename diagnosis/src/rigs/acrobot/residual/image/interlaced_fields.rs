//! Which fields of an interlaced camera have the odd rows.
//!
//! Fields alternate, so that within a run timestamps tell them apart; which come first, no log says. Centroids sit elsewhere on
//! the lattice in a field of even rows than in one of odd ones, by tenths of a pixel along v, and from one field to the next
//! that changes its sign: nothing smooth does, whatever effect is in it. But only where the model has the image on the right
//! place of the lattice: the question is put at every linearisation.

use super::ImageCut;
use crate::error::Error;
use crate::rigs::acrobot::residual::studio::{CENTROIDS, Seen, Shot};
use std::collections::BTreeMap;

impl ImageCut {
    /// Finds out, run by run: of both orders the one that leaves less from field to field.
    pub(super) fn order(&mut self, point: &[f64]) -> Result<(), Error> {
        let settings = self.settings(point, None)?;
        // counted from one to the next: a camera of 59.94 Hz that is said to have 60 is a field off after 17 s
        let mut before: Option<(usize, f64, bool)> = None;
        for frame in &mut self.frames {
            let known = before.filter(|(run, ..)| *run == frame.run);
            frame.shot.odd = known.is_some_and(|(_, time, odd)| {
                let fields = ((frame.time - time) / self.studio.interval()).round();
                odd ^ (fields as i64 % 2 != 0)
            });
            before = Some((frame.run, frame.time, frame.shot.odd));
        }
        let shots: Vec<Shot> = self.frames.iter().map(|frame| frame.shot).collect();
        let turned: Vec<Shot> = shots.iter().map(|shot| Shot { odd: !shot.odd, ..*shot }).collect();
        let (one, other) = (
            self.jumps(&self.studio.take(&settings, &shots)?),
            self.jumps(&self.studio.take(&settings, &turned)?),
        );
        for frame in &mut self.frames {
            let less = |jumps: &BTreeMap<usize, f64>| jumps.get(&frame.run).copied().unwrap_or(0.0);
            frame.shot.odd ^= less(&other) < less(&one);
        }
        Ok(())
    }

    /// For each run the sum of squares by which what is left along v changes from one field to the next of the other kind.
    fn jumps(&self, made: &[Option<Seen>]) -> BTreeMap<usize, f64> {
        let mut sums = BTreeMap::new();
        for place in 1..made.len() {
            let (Some(one), Some(two)) = (made[place - 1], made[place]) else { continue };
            let [before, frame] = [&self.frames[place - 1], &self.frames[place]];
            if before.run != frame.run || before.shot.odd == frame.shot.odd {
                continue;
            }
            let jump = |s: usize| (frame.seen[s] - two[s]) - (before.seen[s] - one[s]);
            let along_v = CENTROIDS.skip(1).step_by(2);
            *sums.entry(frame.run).or_insert(0.0) +=
                along_v.map(jump).filter(|jump| jump.is_finite()).map(|jump| jump * jump).sum::<f64>();
        }
        sums
    }
}
