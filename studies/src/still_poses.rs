//! The camera by itself, looking at poses that stand still: its estimation error along the manifold.

use crate::{Bench, Error};
use mechanics::Theta;
use orchestrator::Scenario;

/// A pose and how the camera saw it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// q₁, q₂ as they are, rad.
    pub pose: [f64; 2],
    /// q₁, q₂ as estimated, rad.
    pub estimate: [f64; 2],
}

impl Sight {
    /// q_actual − q_estimated, as the paper's figures have it.
    pub fn error(&self) -> [f64; 2] {
        [0, 1].map(|i| self.pose[i] - self.estimate[i])
    }
}

/// Poses between the upright and the end of an arm.
const STEPS: i32 = 230;
/// Between neighbouring poses, rad.
const STEP: f64 = 0.01;

/// Looks along the manifold, from q₂ = −2.3 to 2.3 rad, through a lens with some `camera` variables changed. Poses in
/// which the camera doesn't find its circles are left out.
pub fn along_the_manifold(bench: &Bench, set: &[(&str, f64)]) -> Result<Vec<Sight>, Error> {
    // Up one arm, back, and down the other: the camera follows its circles from pose to pose.
    let path: Vec<i32> = (0..=STEPS).chain((-STEPS..STEPS).rev()).collect();
    let mut poses = Vec::with_capacity(path.len());
    for place in path {
        let q2 = f64::from(place) * STEP;
        let q1 = Theta::TABLE_2.manifold_q1(q2).map_err(|error| Error::Mechanics(error.to_string()))?;
        poses.push([q1, q2]);
    }
    let mut scenario = Scenario::parse(&text(&poses), "still poses")?;
    for (variable, value) in set {
        scenario.set(variable, &value.to_string())?;
    }
    let results = bench.run(&scenario)?;
    let series = |name: &str| results.series(name);
    let (q1, q2, valid) = (series("camera.q1_est")?, series("camera.q2_est")?, series("camera.valid")?);
    // Frame k, at row 2k, shows pose k − 1; frame 0 the first pose too.
    let mut sights: Vec<Sight> = (poses.iter().enumerate())
        .filter_map(|(index, pose)| {
            let row = 2 * (index + 1);
            let seen = valid.get(row).is_some_and(|valid| *valid > 0.5);
            seen.then(|| Sight { pose: *pose, estimate: [q1[row], q2[row]] })
        })
        .collect();
    sights.sort_by(|a, b| a.pose[1].total_cmp(&b.pose[1]));
    sights.dedup_by(|a, b| a.pose == b.pose);
    Ok(sights)
}

/// A scenario that shows each pose to the camera for one frame. A pose changes a quarter of a period after a frame,
/// and its rates are 0, so that nothing moves while the shutter is open.
fn text(poses: &[[f64; 2]]) -> String {
    let table = |which: usize| {
        let entry = |(index, pose): (usize, &[f64; 2])| {
            let time = if index == 0 { 0.0 } else { (index as f64 + 0.25) / 30.0 };
            format!("[{time:?}, {:?}]", pose[which])
        };
        poses.iter().enumerate().map(entry).collect::<Vec<_>>().join(", ")
    };
    let source = |name: &str, which: usize| {
        format!("[[sources]]\nto = \"camera.{name}\"\nkind = \"hold\"\npoints = [{}]\n", table(which))
    };
    format!(
        "format = 1\n[experiment]\nstop = \"{}/30\"\n[[units]]\nname = \"camera\"\nfmu = \"acrobot_camera.fmu\"\n\
         interval = \"1/60\"\n{}{}",
        poses.len(),
        source("q1", 0),
        source("q2", 1)
    )
}
