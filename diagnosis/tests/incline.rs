//! A rig that stands on an inclined table with all that its angles are counted from.

use crate::common::{logged_in, options, shipped, units};
use diagnosis::diagnose;

/// How far the table is inclined, rad: a floor that no builder would complain of.
const INCLINE: f64 = 0.02;

/// Made without the parameter that is looked for: of ground that is inclined against the vertical, with the camera and the encoders'
/// zeros turned by as much.
#[test]
fn recovers_a_rig_on_an_inclined_table() {
    let mut text = shipped();
    for angle in ["q1", "q2"] {
        let to = format!("to = \"camera.{angle}\"\n");
        text = text.replace(&to, &format!("{to}bias = {}\n", -INCLINE));
    }
    let folder = logged_in("incline", &text, &[("plant.slope", &INCLINE.to_string())], false);
    for run in ["run-01", "run-02"] {
        let path = folder.path().join(run).join("plant.csv");
        let log = std::fs::read_to_string(&path).expect("it was recorded");
        let turned = log.lines().enumerate().map(|(row, line)| {
            let cells: Vec<f64> = line.split(',').filter_map(|cell| cell.parse().ok()).collect();
            match cells[..] {
                [time, q1, q2] => format!("{time},{},{}", q1 - INCLINE, q2 - INCLINE),
                _ => line.to_owned() + if row == 0 { "" } else { " is no row" },
            }
        });
        std::fs::write(&path, turned.collect::<Vec<_>>().join("\n")).expect("it can be written");
    }
    let found = diagnose(folder.path(), &units(), &options(), &mut |_| {}).expect("the data is good");
    let names: Vec<&str> = found.effects.iter().map(|effect| effect.name.as_str()).collect();
    assert_eq!(names, ["plant.incline"], "{:?} {:?}", found.effects, found.unknown);
    let effect = &found.effects[0];
    // 24 s at 30 Hz: the standard error is about 3e-5, and a falling arm shows more
    assert!((effect.value - INCLINE).abs() < 2e-4, "{effect:?}");
    assert_eq!(effect.class, ["plant.incline"], "{effect:?}");
}
