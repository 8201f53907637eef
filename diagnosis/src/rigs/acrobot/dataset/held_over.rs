//! Readings that were late and held over: now and then a row repeats the one before, digit by digit, in a log whose noise leaves no two rows
//! alike. Such a row says again what the one before said, at the wrong time.

use super::Run;
use crate::error::Notice;
use crate::nuisance::held_over;

/// Makes such readings not measured.
pub fn exclude(run: &mut Run, notices: &mut Vec<Notice>) {
    let Some(plant) = &mut run.plant else { return };
    for angle in ["q1", "q2"] {
        let Some(rows) = plant.column(angle).and_then(held_over) else { continue };
        let message = format!(
            "{angle} repeats the row before in {} of {} rows, this is the first, and its noise leaves no two alike by chance: readings that \
             were held over, taken as not measured",
            rows.len(),
            plant.len()
        );
        notices.push(Notice { file: format!("{}/plant.csv", run.name), line: plant.line[rows[0]], message });
        if let Some(values) = plant.column_mut(angle) {
            rows.iter().for_each(|row| values[*row] = f64::NAN);
        }
    }
}
