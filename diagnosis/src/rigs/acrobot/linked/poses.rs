//! Poses that were read off images in the place of a plant's log, where no encoder was logged.

use crate::rigs::acrobot::candidates::{Attribute, Candidate, name, place};
use crate::rigs::acrobot::dataset::{DataSet, Table};
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::residual::image::pose_shift;
use crate::rigs::acrobot::selection::Study;

/// The data with what a study's frames show as each run's log of angles: at the frames' times less the camera's delay.
pub fn poses_as_log(data: &DataSet, model: &Model, list: &[Candidate], study: &Study) -> DataSet {
    let delay = place(list, Attribute::ImageDelay).map(|index| study.last.point[index]);
    let delay = delay.or(model.number(name(Attribute::ImageDelay))).unwrap_or(0.0);
    let mut seen = data.clone();
    seen.manifest.noise.retain(|name, _| !name.starts_with("plant."));
    for (index, run) in seen.runs.iter_mut().enumerate() {
        let (mut time, mut angles) = (Vec::new(), [Vec::new(), Vec::new()]);
        let blocks = study.last.blocks.iter().filter(|block| block.run == index);
        // frames are drawn, windows of the plant are not
        let frames = blocks.flat_map(|block| &block.cells).filter(|cell| !cell.drawn.is_empty());
        // two angles are a pose
        for cell in frames.filter(|cell| cell.hard.ncols() == 2) {
            let Some((shift, _)) = pose_shift(cell) else { continue };
            let (Some(at), &[q1, q2, ..]) = (cell.time.first(), cell.state.as_slice()) else { continue };
            time.push(at - delay);
            angles[0].push(q1 + shift[0]);
            angles[1].push(q2 + shift[1]);
        }
        let columns = ["q1", "q2"].map(str::to_owned).into_iter().zip(angles).collect();
        run.plant = (!time.is_empty()).then(|| Table::new(time, columns));
    }
    seen
}
