//! Where a sensor's lag begins: what its state was when the log did.

use super::assemble::Assembly;
use super::lag::Lag;
use super::linearise::RunAt;
use crate::infer::Linearised;
use crate::infer::linearised::Follows;
use crate::statistics::levels::CERTAIN;

impl Assembly<'_> {
    /// Where a lag begins, and how far from there it may: a sensor that was on before the log began is behind by what its output moves
    /// in its lag, so that one that forgets within a row is as likely as none. One whose first value says that it was switched on with the
    /// log may have begun anywhere.
    pub(super) fn begins(&self, run: &Linearised, lag: &Lag, values: &[f64]) -> (Option<Follows>, f64) {
        let RunAt { engine, grid, schedule, .. } = self.about;
        let (n, first, sensor) = (engine.machine.order(), values[0], engine.sensors[lag.channel]);
        let rms = |squares: &mut dyn Iterator<Item = f64>, count: usize| {
            (squares.sum::<f64>() / count.max(1) as f64).sqrt()
        };
        let rates = values.windows(2).zip(run.time.windows(2)).map(|(y, t)| (y[1] - y[0]) / (t[1] - t[0]));
        let behind = lag.time * rms(&mut rates.map(|rate| rate * rate), values.len() - 1);
        let effect = self.effects[lag.channel];
        let own = run.values(0).find(|value| run.measured[*value].channel == lag.channel);
        let off = own.map_or(0.0, |value| {
            let shown = effect.shown(first, run.measured[value].time - grid.origin);
            (grid.samples[schedule.placed[value].sample].value - shown).abs()
        });
        if off > CERTAIN * (effect.gain.abs() * behind + sensor) {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let motion = rms(&mut values.iter().map(|v| (v - mean) * (v - mean)), values.len());
            return (None, motion.max(sensor));
        }
        let here = &self.parts[0].states;
        let by = here.iter().map(|column| column[n + lag.channel]).collect();
        let direct = (0..self.columns()).map(|place| self.column(0, place, n + lag.channel)).collect();
        (Some(Follows { state: run.start.0.len(), by, direct }), behind)
    }
}
