//! What logs are wrong by is no part of the machine: a noise that is stated too small, clocks and zeros of encoders that are off. Each is
//! corrected in the logs before anything is named, and all is compared again.

use super::Rig;
use super::compare::{Compared, compare};
use super::encoder_zeros::{Zeros, effects_in_all};
use super::log_clocks::{Clocks, is_the_actuators};
use super::prepare::{believe_clocks, trust_no_clock};
use super::understated_noise::forget_understated;
use crate::error::{Error, Notice};
use crate::rigs::acrobot::candidates::{Candidate, Side};
use crate::rigs::acrobot::residual::image::Laws;
use crate::watch::Watch;
use std::sync::Arc;

/// What is compared, again with the noise that rows show where the stated one is too small.
pub(super) fn correct_noise(
    rig: &mut Rig<'_>,
    compared: Compared,
    notices: &mut Vec<Notice>,
    watch: &mut Watch<'_>,
) -> Result<Compared, Error> {
    if !forget_understated(rig, &compared.parts, notices) {
        return Ok(compared);
    }
    watch.stage("compared again with the noise that rows show");
    compare(rig, &Laws::default(), watch)
}

/// Sets the plant's logs back to the other logs' clock, and compares again, until none is late any more.
pub(super) fn correct_clocks(
    rig: &mut Rig<'_>,
    mut compared: Compared,
    watch: &mut Watch<'_>,
) -> Result<(Clocks, Compared), Error> {
    let mut clocks = Clocks::new(&rig.data);
    while let Some(late) = clocks
        .find_late(&rig.list, &compared)
        .filter(|_| !watch.is_over("the search for clocks that are off"))
    {
        watch.stage("plant: the log's clock is put right");
        late.iter().for_each(|(run, late)| rig.data.set_back(*run, *late));
        if clocks.differ_by_run() {
            rig.data.clocks_apart = true;
            trust_no_clock(Arc::<Vec<Candidate>>::make_mut(&mut rig.list));
        }
        compared = compare(rig, &Laws::default(), watch)?;
    }
    // a clock that nothing tells of was set by the motion, and an image that is late with it
    let is_doubted = rig.data.clocks_apart || !is_the_actuators(&rig.list, &compared);
    if !is_doubted && !watch.is_over("the search for an actuator that is late") {
        believe_clocks(Arc::<Vec<Candidate>>::make_mut(&mut rig.list), rig.data.late_by_hand);
        compared = compare(rig, &Laws::default(), watch)?;
    }
    Ok((clocks, compared))
}

/// Turns the plant's logs back by what pictures say their zeros are off, and compares all again: kept if so the machine lacks no more
/// than before, else no zero is in question.
pub(super) fn correct_zeros(
    rig: &mut Rig<'_>,
    mut compared: Compared,
    watch: &mut Watch<'_>,
) -> Result<(Zeros, Compared), Error> {
    let mut zeros = Zeros::default();
    while let Some(off) = zeros
        .seen_in_images(&rig.list, &compared)
        .filter(|_| !watch.is_over("the search for zeros that are off"))
    {
        watch.stage("plant: the log's angles are turned to where images have them");
        zeros.turn_back(&mut rig.data, off);
        let again = compare(rig, &Laws::default(), watch)?;
        if effects_in_all(&again, &rig.list) <= effects_in_all(&compared, &rig.list) {
            compared = again;
            continue;
        }
        zeros.turn_back(&mut rig.data, off.map(|off| -off));
        Arc::<Vec<Candidate>>::make_mut(&mut rig.list).retain(|candidate| candidate.side != Side::Zero);
        compared = compare(rig, &Laws::default(), watch)?;
    }
    Ok((zeros, compared))
}
