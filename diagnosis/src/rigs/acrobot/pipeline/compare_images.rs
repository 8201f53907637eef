//! The images compared: at the measured motion, or with the pose free where none was measured.

use super::Rig;
use super::averaged_values::average_values;
use super::compare::{Compared, Part};
use super::compare_plant::Motions;
use super::encoder_zeros::doubted_zeros;
use super::sensor_noise::search_with_noise;
use crate::error::{Error, Notice};
use crate::rigs::acrobot::candidates::{Candidate, Side};
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::residual::chain::Chain;
use crate::rigs::acrobot::residual::image::{ImageCut, Laws, Pose};
use crate::watch::Watch;

/// Adds the part of the images, where there are any. A repeated search that found nothing of the camera leaves out what is compared at
/// measured motions.
pub(super) fn compare_images(
    rig: &Rig<'_>,
    motions: Option<Motions>,
    laws: &Laws,
    compared: &mut Compared,
    watch: &mut Watch<'_>,
) -> Result<(), Error> {
    let pictured = |index: &usize| matches!(rig.list[*index].side, Side::Camera | Side::Timestamps);
    if motions.is_some() && watch.known().is_some_and(|known| !known.active.iter().any(pictured)) {
        return Ok(());
    }
    let Some(mut images) = Images::new(rig, motions)? else { return Ok(()) };
    let zeros = doubted_zeros(&compared.parts, &rig.list, &compared.point);
    let image = images.cut();
    image.know(laws);
    image.doubt_zeros(zeros.filter(|_| watch.known().is_none()));
    watch.stage("camera: frames rendered again at the measured pose");
    match images.search(&rig.list, &compared.point, watch) {
        Ok(mut part) => {
            part.laws.extend(Some(images.cut().laws()));
            compared.add(part);
            Ok(())
        }
        Err(error) if !compared.parts.is_empty() => {
            let message = format!("not compared: {error}");
            compared.notices.push(Notice { file: "camera.csv".into(), line: 0, message });
            Ok(())
        }
        Err(error) => Err(error),
    }
}

/// The cut that images are compared on.
pub(super) enum Images {
    /// Commanded torque in, image out: no encoder was logged.
    Chained(Box<Tracked<Chain>>),
    /// Motion in, image out, or each frame at a free pose.
    Posed(Box<Tracked<ImageCut>>),
}

impl Images {
    /// At these motions; where there are none, by the commanded torque if that is known, else with free poses. `None` where no images can
    /// be compared.
    pub(super) fn new(rig: &Rig<'_>, motions: Option<Motions>) -> Result<Option<Self>, Error> {
        let pose = match motions {
            Some(Motions { runs, sigma }) => Pose::Logged(runs, sigma),
            None => Pose::Free,
        };
        if matches!(pose, Pose::Free)
            && let Some(chain) = Chain::new(&rig.data, rig.model, rig.list.clone())?
        {
            return Ok(Some(Self::Chained(Box::new(Tracked::new(chain)))));
        }
        let image = ImageCut::new(&rig.data, rig.model, rig.list.clone(), pose, rig.options.frames)?;
        Ok(image.map(|image| Self::Posed(Box::new(Tracked::new(image)))))
    }

    /// The cut, whichever it is.
    pub(super) fn tracked(&mut self) -> &mut Tracked {
        match self {
            Self::Chained(chain) => chain.as_mut(),
            Self::Posed(image) => image.as_mut(),
        }
    }

    /// The images of what is compared.
    fn cut(&mut self) -> &mut ImageCut {
        match self {
            Self::Chained(chain) => &mut chain.image,
            Self::Posed(image) => image,
        }
    }

    /// Searches the images; values of the plant that they alone tell are averaged, unless the search is a repeated one.
    fn search(&mut self, list: &[Candidate], point: &[f64], watch: &mut Watch<'_>) -> Result<Part, Error> {
        match self {
            Self::Chained(chain) => {
                let mut part = search_with_noise(chain, |chain| &mut chain.image, list, point, watch)?;
                if watch.known().is_none() {
                    average_values(chain.as_mut(), list, &mut part)?;
                }
                Ok(part)
            }
            Self::Posed(image) => search_with_noise(image, |image| image, list, point, watch),
        }
    }
}
