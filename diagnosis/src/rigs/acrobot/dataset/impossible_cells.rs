//! Cells that no such machine can have measured: a torque that no motor of this size gives, a circle outside the image. They are
//! taken as not measured, so that one cell spoils no fit.

use super::{Nominal, Run};
use crate::error::Notice;
use crate::rigs::acrobot::channels::{CHANNELS, File, Measures};
use crate::rigs::acrobot::dataset::policy::LOGS;
use crate::text::brief;

/// The most that a column can hold, the reason for people, and whether a column full of more is taken out, too. Where it isn't,
/// most rows are beyond the limit by a mistake in the units, which the plausibility checks tell.
fn limit(measures: Measures, nominal: &Nominal) -> Option<(f64, String, bool)> {
    let Nominal { gravity, image: (width, height), .. } = *nominal;
    let torque = || format!("gravity pulls with {gravity:.3} N·m at most");
    let image = || format!("the image is {width} px by {height} px");
    Some(match measures {
        Measures::Command if gravity > 0.0 => (LOGS.absurd * gravity, torque(), true),
        Measures::AppliedTorque if gravity > 0.0 => (LOGS.absurd * gravity, torque(), false),
        Measures::Rate => {
            let most = nominal.falling[0].max(nominal.falling[1]);
            (LOGS.absurd * most, format!("gravity gives a link some {} rad/s", brief(most)), false)
        }
        // counted from its middle or from a corner: a whole image further off it is outside either way
        Measures::Centroid => (LOGS.outside * width.max(height), image(), false),
        Measures::Area => (width * height, image(), false),
        _ => return None,
    })
}

/// Takes such cells out of all logs of a run.
pub fn exclude(run: &mut Run, nominal: &Nominal, notices: &mut Vec<Notice>) {
    for channel in CHANNELS {
        let (log, file) = match channel.file {
            File::Camera => (&mut run.camera, "camera.csv"),
            File::Controller => (&mut run.controller, "controller.csv"),
            File::Plant => (&mut run.plant, "plant.csv"),
        };
        let Some((most, why, also_all)) = limit(channel.measures, nominal) else { continue };
        let Some(log) = log else { continue };
        let Some(values) = log.column_mut(channel.column) else { continue };
        let beyond =
            |most: f64| -> Vec<usize> { (0..values.len()).filter(|row| values[*row].abs() > most).collect() };
        let mut rows = beyond(most);
        if !also_all && rows.len() as f64 > LOGS.few_impossible * values.len() as f64 {
            // no unit is so small
            rows = beyond(LOGS.absurd * LOGS.absurd * most);
        }
        let Some(first) = rows.first().copied() else { continue };
        let message = format!(
            "{} = {:e} {}, where {why} ({} such rows, this is the first): taken as not measured",
            channel.column,
            values[first],
            channel.unit,
            rows.len()
        );
        rows.iter().for_each(|row| values[*row] = f64::NAN);
        notices.push(Notice { file: format!("{}/{file}", run.name), line: log.line[first], message });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::dataset::Table;

    const NOMINAL: Nominal = Nominal {
        gravity: 1.0,
        falling: [8.0, 9.0],
        image: (640.0, 480.0),
        interval: 0.04,
        ground: None,
        links: [150.0, 180.0],
    };

    /// A run whose logs hold a column each, and the cells of the same column after the check.
    fn after(file: File, column: &str, values: Vec<f64>) -> (Vec<f64>, Vec<Notice>) {
        let times = (0..values.len()).map(|row| row as f64 * 0.1).collect();
        let table = Some(Table::new(times, vec![(column.to_owned(), values)]));
        let mut run = Run { name: "run-01".into(), camera: None, controller: None, plant: None };
        *match file {
            File::Camera => &mut run.camera,
            File::Controller => &mut run.controller,
            File::Plant => &mut run.plant,
        } = table;
        let mut notices = Vec::new();
        exclude(&mut run, &NOMINAL, &mut notices);
        let log = [run.camera, run.controller, run.plant].into_iter().flatten().next();
        (log.and_then(|log| log.column(column).map(<[f64]>::to_vec)).unwrap_or_default(), notices)
    }

    #[test]
    fn one_cell_beyond_all_sizes_is_not_measured_and_told_with_its_line() {
        for (file, column, most) in [
            (File::Camera, "u1", LOGS.outside * 640.0),
            (File::Camera, "area3", 640.0 * 480.0),
            (File::Plant, "dq2", LOGS.absurd * 9.0),
            (File::Plant, "tau_applied", LOGS.absurd),
            (File::Controller, "tau", LOGS.absurd),
        ] {
            let mut values = vec![0.5; 40];
            (values[6], values[7]) = (-most, -1.01 * most);
            let (values, notices) = after(file, column, values);
            let bare: Vec<usize> = (0..values.len()).filter(|row| values[*row].is_nan()).collect();
            assert_eq!(bare, [7], "{column}");
            assert_eq!(notices.len(), 1, "{column}");
            assert_eq!(notices[0].line, 9, "{column}: {}", notices[0].message);
        }
    }

    #[test]
    fn a_column_in_other_units_stays_for_the_checks_of_units() {
        for (share, stays) in [(0.9 * LOGS.few_impossible, false), (1.1 * LOGS.few_impossible, true)] {
            let many = (share * 1000.0) as usize;
            let values = (0..1000).map(|row| if row < many { 1e7 } else { 0.0 }).collect();
            let (values, notices) = after(File::Camera, "v2", values);
            assert_eq!((values[0] == 1e7, notices.is_empty()), (stays, stays));
        }
        // but what no unit makes of a place in an image goes from every row
        let (values, notices) = after(File::Camera, "v2", vec![1e300; 40]);
        assert!(values.iter().all(|value| value.is_nan()) && notices.len() == 1);
    }
}
