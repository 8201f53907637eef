//! A torque that was rounded for the log, or that a converter of few bits measured. The plant is driven by what stands in the log, so that
//! the model lacks what rounding took away.

use super::Run;
use crate::error::Notice;
use crate::rigs::acrobot::dataset::policy::LOGS;
use crate::rigs::acrobot::story::brief;
use crate::statistics::levels::{FINE, ROUNDING, STEP, anywhere_in};

/// Says so where the steps are coarse beside what the torque spans.
pub fn tell(run: &Run, notices: &mut Vec<Notice>) {
    let Some(log) = &run.controller else { return };
    let Some(tau) = log.column("tau") else { return };
    let Some(grid) = grid(tau).filter(|grid| grid.quantum > FINE * grid.span) else { return };
    let message = format!(
        "tau is rounded to {} N·m: as much as that scatters is not taken for something that the model lacks",
        brief(grid.quantum)
    );
    notices.push(Notice { file: format!("{}/controller.csv", run.name), line: 0, message });
}

impl Run {
    /// Scatter (N·m, standard deviation) of what rounding takes off the mean torque over a time, s. It is another one wherever the
    /// rounded torque changes.
    pub fn rounded_torque(&self, over: f64) -> f64 {
        let Some((log, tau)) = self.controller.as_ref().and_then(|log| Some((log, log.column("tau")?)))
        else {
            return 0.0;
        };
        let Some(grid) = grid(tau) else { return 0.0 };
        let changes = tau.windows(2).filter(|pair| pair[0] != pair[1]).count() as f64;
        let apart = (log.time[log.len() - 1] - log.time[0]) / changes.max(1.0);
        anywhere_in(grid.quantum) * (apart / over).min(1.0).sqrt()
    }
}

/// What values are rounded to; 0 where they aren't.
pub fn quantum(values: &[f64]) -> f64 {
    grid(values).map_or(0.0, |grid| grid.quantum)
}

/// What values are rounded to.
struct Grid {
    /// Their steps, N·m.
    quantum: f64,
    /// From the least to the largest, N·m.
    span: f64,
}

/// The steps of values that are all multiples of the least difference between two of them. A few values are no rounded ones: a command
/// of steps holds each as it was meant.
fn grid(values: &[f64]) -> Option<Grid> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let span = sorted.last()? - sorted.first()?;
    let same = ROUNDING * span;
    sorted.dedup_by(|next, before| *next - *before <= same);
    if sorted.len() < LOGS.even_rows {
        return None;
    }
    let quantum = sorted.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let off = |value: &f64| (value / quantum - (value / quantum).round()).abs() * quantum;
    // digits that the file lacks put a value off by a share of a step for each step that it is away from 0
    let whole = sorted.iter().all(|value| off(value) <= STEP * quantum + FINE * value.abs().min(quantum));
    whole.then_some(Grid { quantum, span })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::dataset::Table;

    fn torque(time: f64) -> f64 {
        2.0 * libm::sin(3.0 * time) + 0.7 * libm::sin(17.3 * time)
    }

    fn run(round: &dyn Fn(f64) -> f64) -> Run {
        let time: Vec<f64> = (0..900).map(|row| f64::from(row) / 30.0).collect();
        let tau = time.iter().map(|time| round(torque(*time))).collect();
        let controller = Some(Table::new(time, vec![("tau".to_owned(), tau)]));
        Run { name: "run-01".into(), camera: None, controller, plant: None }
    }

    #[test]
    fn law_rounding_scatters_means_as_it_does() {
        for quantum in [0.01, 20.0 / 4096.0] {
            let round = |torque: f64| (torque / quantum).round() * quantum;
            // three rows each
            let means: Vec<f64> = (0..300)
                .map(|part| {
                    (0..3)
                        .map(|row| f64::from(3 * part + row) / 30.0)
                        .map(|at| round(torque(at)) - torque(at))
                        .sum::<f64>()
                        / 3.0
                })
                .collect();
            let scatter = (means.iter().map(|mean| mean * mean).sum::<f64>() / 300.0).sqrt();
            let told = run(&round).rounded_torque(0.1);
            assert!(
                (told / scatter - 1.0).abs() < 0.15,
                "{told} {scatter}: 300 means tell their scatter to a 25th"
            );
        }
    }

    #[test]
    fn neutral_a_torque_of_all_digits_or_of_a_few_steps_is_not_rounded() {
        assert!(run(&|torque| torque).rounded_torque(0.1) < 1e-6);
        assert_eq!(run(&|torque| 0.5 * (torque / 0.5).round()).rounded_torque(0.1), 0.0);
        let mut notices = Vec::new();
        tell(&run(&|torque| torque), &mut notices);
        assert!(notices.is_empty());
        tell(&run(&|torque| 0.01 * (torque / 0.01).round()), &mut notices);
        assert!(notices[0].message.contains("0.010 N·m"), "{}", notices[0].message);
    }
}
