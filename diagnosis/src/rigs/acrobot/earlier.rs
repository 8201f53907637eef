//! What an earlier diagnosis said of our own rig's candidates.

use crate::earlier::Earlier;
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Candidate, LIST};
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::selection::{Alternative, CLASS};

impl Earlier {
    /// Refuses one of another machine than our own rig.
    ///
    /// # Errors
    /// Says of what it is.
    pub fn fits_our_rig(&self) -> Result<(), Error> {
        let is_ours = |name: &str| LIST.iter().any(|candidate| candidate.name == name);
        self.fits("our own rig (format = 1)", is_ours)
    }

    /// Weighs the alternatives of an effect (best first, by their losses) with what was known of it. Answers the class that was
    /// known, where it is one.
    pub fn weigh(&self, list: &[Candidate], alternatives: &mut [Alternative]) -> Option<Vec<String>> {
        let named = |other: &Alternative| (list[other.candidate].name, other.loss);
        let others: Vec<(&str, f64)> = alternatives.iter().map(named).collect();
        let (losses, known) = self.weighed(&others, CLASS, POLICY.excluded)?;
        alternatives.iter_mut().zip(losses).for_each(|(other, loss)| other.loss = loss);
        alternatives.sort_by(|a, b| a.loss.total_cmp(&b.loss));
        Some(known)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::candidates::{Motion, Side};

    fn candidate(name: &'static str) -> Candidate {
        let motion = Motion::Real { steps: &[1.0], range: (-1.0, 1.0) };
        let (side, phrase, off, steps, range) = (Side::Camera, "", 0.0, vec![1.0], (-1.0, 1.0));
        Candidate { name, side, phrase, motion, off, steps, range, nonlinear: false, attributes: &[] }
    }

    fn open(list: &[Candidate], all: &[Alternative]) -> Vec<&'static str> {
        all.iter().filter(|other| other.loss < CLASS).map(|other| list[other.candidate].name).collect()
    }

    #[test]
    fn bad_input_a_diagnosis_without_a_name_of_our_rig_is_refused() {
        let found =
            |name: &str| Earlier { effects: vec![[(name.to_owned(), 0.9)].into()], ..Earlier::default() };
        let told = found("motor.b").fits_our_rig().expect_err("a motor's").to_string();
        assert!(told.contains("found motor.b, of which our own rig"), "{told}");
        assert!(found("camera.k1").fits_our_rig().is_ok() && found("plant.b_joint").fits_our_rig().is_ok());
    }

    #[test]
    fn every_class_is_what_fits_both() {
        let list = ["camera.pan", "camera.tilt", "camera.u0", "camera.v0"].map(candidate);
        let known =
            |names: [(&str, f64); 2]| names.into_iter().map(|(name, p)| (name.to_owned(), p)).collect();
        let earlier = Earlier {
            effects: vec![
                known([("camera.u0", 0.4), ("camera.pan", 0.6)]),
                known([("camera.v0", 0.5), ("camera.scale", 0.5)]),
            ],
            ..Earlier::default()
        };
        let found = |losses: [f64; 4]| {
            let other = |(candidate, loss)| Alternative { candidate, x: 0.1, loss };
            let mut all: Vec<Alternative> = losses.into_iter().enumerate().map(other).collect();
            all.sort_by(|a, b| a.loss.total_cmp(&b.loss));
            all
        };
        // with the mount turned u0 looks like a tilt
        let mut all = found([40.0, 0.0, 1.0, 50.0]);
        assert!(earlier.weigh(&list, &mut all).is_some());
        assert_eq!(open(&list, &all), ["camera.u0"]);
        // an effect that nothing was known of
        let mut all = found([40.0, 0.0, 50.0, 50.0]);
        assert_eq!(earlier.weigh(&list, &mut all), None);
        assert_eq!(open(&list, &all), ["camera.tilt"]);
        // both data sets leave both open, and lean to one
        let mut all = found([0.0, 40.0, 1.0, 50.0]);
        assert_eq!(earlier.weigh(&list, &mut all), Some(vec!["camera.pan".into(), "camera.u0".into()]));
        assert_eq!(open(&list, &all), ["camera.pan", "camera.u0"]);
        // of losses 0 and 1, and 2 ln(0.6/0.4)
        assert!((all[1].loss - (1.0 + 2.0 * libm::log(1.5))).abs() < 1e-12);
    }
}
