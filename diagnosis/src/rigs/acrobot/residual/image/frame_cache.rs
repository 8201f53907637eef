//! Frames that were made lately: a search comes back to where it was, and what moves the arm alone leaves a camera as it is.

use crate::error::Error;
use crate::rigs::acrobot::bench::Setting;
use crate::rigs::acrobot::residual::image::policy::IMAGES;
use crate::rigs::acrobot::residual::studio::{Seen, Shot};
use std::collections::VecDeque;
use std::sync::Arc;

/// Frames, with what they were made from.
pub(super) struct MadeFrames {
    pub(super) settings: Vec<Setting>,
    pub(super) shots: Vec<Shot>,
    pub(super) seen: Vec<Option<Seen>>,
}

/// The last frames, the newest at the end.
#[derive(Clone, Default)]
pub(super) struct FrameCache(VecDeque<Arc<MadeFrames>>);

impl FrameCache {
    /// The frames of a camera at some poses, which `make` makes unless they are kept.
    pub(super) fn frames(
        &mut self,
        settings: Vec<Setting>,
        shots: Vec<Shot>,
        make: impl FnOnce(&[Setting], &[Shot]) -> Result<Vec<Option<Seen>>, Error>,
    ) -> Result<Arc<MadeFrames>, Error> {
        let known = self.0.iter().find(|made| made.settings == settings && made.shots == shots);
        if let Some(known) = known {
            return Ok(known.clone());
        }
        let seen = make(&settings, &shots)?;
        let made = Arc::new(MadeFrames { settings, shots, seen });
        // what stands beside the poses in all rounds, and as much again
        if self.0.len() >= 4 * IMAGES.more_rounds as usize {
            self.0.pop_front();
        }
        self.0.push_back(made.clone());
        Ok(made)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_frame_is_made_once_until_fifty_others_were() {
        let mut cache = FrameCache::default();
        let mut made = 0;
        let mut ask = |odd: bool, q1: f64| {
            let shot = Shot { before: [q1; 4], end: [q1; 4], odd };
            let seen = cache.frames(Vec::new(), vec![shot], |_, shots| {
                made += 1;
                let seen: Seen = std::array::from_fn(|_| shots[0].end[0]);
                Ok(vec![Some(seen)])
            });
            (seen.expect("made").seen[0].map(|seen| seen[0]), made)
        };
        assert_eq!(ask(false, 1.0), (Some(1.0), 1));
        assert_eq!(ask(false, 1.0), (Some(1.0), 1));
        assert_eq!(ask(true, 1.0), (Some(1.0), 2));
        let others: Vec<_> = (0..50).map(|k| ask(false, f64::from(k) + 2.0)).collect();
        assert_eq!(others.last(), Some(&(Some(51.0), 52)));
        assert_eq!(ask(false, 51.0), (Some(51.0), 52));
        assert_eq!(ask(false, 1.0), (Some(1.0), 53));
    }
}
