//! The camera's part: at the measured motion, or with the pose free where none was measured.

use super::*;
use crate::candidates::Side;
use crate::gap::led;
use crate::residual::chain::Chain;
use crate::residual::image::{ImageCut, Pose};
use crate::selection::lacking;

#[allow(clippy::too_many_arguments)] // one stage of one workflow: a struct would only rename its locals
pub(super) fn camera_part(
    data: &DataSet,
    model: &Model,
    list: &Arc<Vec<Candidate>>,
    motions: Option<(Vec<Logged>, f64)>,
    options: &Options,
    point: &mut Vec<f64>,
    parts: &mut Vec<Part>,
    notices: &mut Vec<Notice>,
    tell: &mut dyn FnMut(&str),
) -> Result<(), Error> {
    let pose = match motions {
        Some((motions, sigma)) => Pose::Logged(motions, sigma),
        None => Pose::Free,
    };
    let chained = matches!(pose, Pose::Free);
    let mut chain = if chained { Chain::new(data, model, list.clone())? } else { None };
    let mut image = match chain {
        Some(_) => None,
        None => ImageCut::new(data, model, list.clone(), pose, options.frames)?,
    };
    if chain.is_some() || image.is_some() {
        tell("camera: frames rendered again at the measured pose");
    }
    let parted = match (&mut chain, &mut image) {
        (Some(chain), _) => with_noise(chain, |chain| &chain.image, list, point, tell),
        (_, Some(image)) => with_noise(image, |image| image, list, point, tell),
        _ => return Ok(()),
    };
    match parted {
        Ok(part) => {
            *point = part.study.last.point.clone();
            parts.push(part);
            Ok(())
        }
        Err(error) if !parts.is_empty() => {
            notices.push(Notice {
                file: "camera.csv".into(),
                line: 0,
                message: format!("not compared: {error}"),
            });
            Ok(())
        }
        Err(error) => Err(error),
    }
}

/// The part, with the sensor's noise as the scatter tells it. Where the scatter isn't the nominal sensor's, it is put right
/// and all is looked at anew, since noise moves the mean of what a threshold sees and may have been taken for a blur.
fn with_noise<C: Cut>(
    cut: &mut C,
    image: impl Fn(&C) -> &ImageCut,
    list: &[Candidate],
    point: &[f64],
    tell: &mut dyn FnMut(&str),
) -> Result<Part, Error> {
    let clear = |noise: &Option<Noise>| noise.is_some_and(|noise| noise.clear);
    let noise = |cut: &mut C, point: &[f64]| {
        // fits of alternatives have left the frames elsewhere
        cut.back();
        cut.linearise(point, &[], true)?;
        image(cut).noise(point)
    };
    let mut plain = part(cut, list, point, &[], false, tell)?;
    // a torque that lacks is no sensor's, and where more than noise is left a sensor's isn't named
    if led(&plain.signals) && lacking(&plain.study.last, &plain.study.folds, plain.study.explained, true) {
        return Ok(plain);
    }
    plain.noise = noise(cut, &plain.study.last.point)?;
    let Some(sensor) = list.iter().position(|candidate| candidate.side == Side::Scatter) else {
        return Ok(plain);
    };
    // a blur scatters too, and would hide a part of the noise that it imitates
    let mut sharp = plain.study.last.point.clone();
    let blurs: Vec<usize> =
        plain.study.active.iter().copied().filter(|index| list[*index].is_discrete()).collect();
    blurs.iter().for_each(|index| sharp[*index] = list[*index].off);
    let guess = if blurs.is_empty() { plain.noise } else { noise(cut, &sharp)? };
    // one blur that explains picture and scatter alike is the whole story
    let imitated = clear(&guess) && plain.study.active.len() > 1;
    let Some(guess) = guess.filter(|_| clear(&plain.noise) || imitated) else { return Ok(plain) };
    let mut start = point.to_vec();
    start[sensor] = guess.value;
    cut.afresh();
    let mut noisy = part(cut, list, &start, &[], false, tell)?;
    let mut then = noisy.study.last.point.clone();
    then[sensor] = list[sensor].off;
    noisy.noise = noise(cut, &then)?;
    let simpler = noisy.study.active.len() < plain.study.active.len();
    if clear(&noisy.noise) && (simpler || clear(&plain.noise)) {
        noisy.study.last.point[sensor] = noisy.noise.map_or(guess.value, |noise| noise.value);
        return Ok(noisy);
    }
    // a scatter that one story needs and the other doesn't is no proof
    plain.noise = plain.noise.map(|noise| Noise { clear: false, ..noise });
    Ok(plain)
}
