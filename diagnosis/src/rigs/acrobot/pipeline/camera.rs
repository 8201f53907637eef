//! The camera's part: at the measured motion, or with the pose free where none was measured.

use super::averages::averaged;
use super::sensor::with_noise;
use super::*;
use crate::rigs::acrobot::residual::chain::Chain;
use crate::rigs::acrobot::residual::image::{ImageCut, Laws, Pose};

#[allow(clippy::too_many_arguments)] // one stage of one workflow: a struct would only rename its locals
pub(super) fn camera_part(
    data: &DataSet,
    model: &Model,
    list: &Arc<Vec<Candidate>>,
    motions: Option<(Vec<Logged>, f64)>,
    options: &Options,
    laws: &Laws,
    point: &mut Vec<f64>,
    parts: &mut Vec<Part>,
    notices: &mut Vec<Notice>,
    watch: &mut Watch<'_>,
) -> Result<(), Error> {
    let pictured = |index: &usize| matches!(list[*index].side, Side::Camera | Side::Timestamps);
    let led = motions.is_none();
    if !led && watch.known().is_some_and(|known| !known.active.iter().any(pictured)) {
        return Ok(());
    }
    let pose = match motions {
        Some((motions, sigma)) => Pose::Logged(motions, sigma),
        None => Pose::Free,
    };
    let chained = matches!(pose, Pose::Free);
    let mut chain = if chained { Chain::new(data, model, list.clone())?.map(Tracked::new) } else { None };
    let mut image = match chain {
        Some(_) => None,
        None => ImageCut::new(data, model, list.clone(), pose, options.frames)?.map(Tracked::new),
    };
    if let Some(pictures) = pictures(&mut chain, &mut image) {
        pictures.know(laws);
        pictures.doubt_zeros(zeros::doubted(parts, list, point).filter(|_| watch.known().is_none()));
        watch.stage("camera: frames rendered again at the measured pose");
    }
    let parted = match (&mut chain, &mut image) {
        (Some(chain), _) => {
            with_noise(chain, |chain| &mut chain.image, list, point, watch).and_then(|mut part| {
                if watch.known().is_none() {
                    averaged(chain, list, &mut part)?;
                }
                Ok(part)
            })
        }
        (_, Some(image)) => with_noise(image, |image| image, list, point, watch),
        _ => return Ok(()),
    };
    match parted {
        Ok(mut part) => {
            part.laws.extend(pictures(&mut chain, &mut image).map(|pictures| pictures.laws()));
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

/// The images of what is compared.
fn pictures<'a>(
    chain: &'a mut Option<Tracked<Chain>>,
    image: &'a mut Option<Tracked<ImageCut>>,
) -> Option<&'a mut ImageCut> {
    match (chain, image) {
        (Some(chain), _) => Some(&mut chain.image),
        (_, Some(image)) => Some(image),
        _ => None,
    }
}
