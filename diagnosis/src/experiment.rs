//! What a lab could do to tell the members of an open class apart.
//!
//! The catalogue goes by where the members act. It does not yet simulate each experiment with each member, so it
//! names a sensible experiment and not the best one.

use crate::candidates::{Candidate, Side};
use crate::diagnosis::{Effect, NextExperiment};

/// An experiment for the first class that is open.
pub fn next(list: &[Candidate], effects: &[Effect], encoders: bool) -> Option<NextExperiment> {
    let open = effects.iter().find(|effect| effect.class.len() > 1)?;
    let side =
        |name: &String| list.iter().find(|candidate| candidate.name == *name).map(|candidate| candidate.side);
    let camera = open.class.iter().filter(|name| side(name) == Some(Side::Camera)).count();
    let what = if camera < open.class.len() && !encoders {
        "Log both angles by encoders (or motion capture) beside the picture and repeat the runs: what acts before the \
         motion and what acts after it come apart."
    } else if camera == open.class.len() {
        "Turn the camera by 90 degrees about its axis (camera.roll = pi/2), repeat the same motion, and let the arm \
         visit the whole picture: what belongs to the lens turns with it, what belongs to the mount does not."
    } else {
        "Excite more: steps of z_desired twice as fast and as large as the machine bears, and a run with the arm \
         hanging down, so that torque, speed and angle vary independently."
    };
    Some(NextExperiment { what: what.into(), separates: open.class.clone(), scenario: None })
}
