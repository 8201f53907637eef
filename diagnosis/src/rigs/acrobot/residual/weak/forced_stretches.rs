//! Torques along a stretch, through the plant unit's own sensitivity at each state.

use super::{PUSH, Weak};
use crate::error::Error;
use crate::rigs::acrobot::bench::Setting;
use crate::rigs::acrobot::candidates::Side;
use crate::rigs::acrobot::residual::Nuisances;
use crate::rigs::acrobot::residual::forced_torques::{Forced, Pair};
use crate::rigs::acrobot::residual::settings::settings;
use crate::rigs::acrobot::residual::trajectory::State;
use nalgebra::{DMatrix, Matrix2, Vector2};
use rayon::prelude::*;

impl Weak {
    /// Accelerations per torque on link 1 and on link 2, at each state: the unit is linear in them.
    fn sensitivities(&self, settings: &[Setting], states: &[State]) -> Result<Vec<Matrix2<f64>>, Error> {
        let reference = |name: &str| self.bench.reference(name);
        let starts = [reference("q1_0")?, reference("q2_0")?, reference("dq1_0")?, reference("dq2_0")?];
        let external = [reference("tau_1")?, reference("tau_2")?];
        let failed = |error: orchestrator::Error| Error::Model(error.to_string());
        self.bench.initialising(&self.with_open_limit(settings), |instance| {
            let mut all = Vec::with_capacity(states.len());
            for state in states {
                instance.set_real(&starts, state).map_err(failed)?;
                let mut given = [[0.0; 2]; 3];
                for (found, pair) in given.iter_mut().zip([[0.0; 2], [PUSH, 0.0], [0.0, PUSH]]) {
                    instance.set_real(&external, &pair).map_err(failed)?;
                    instance.get_real(&self.outputs, found).map_err(failed)?;
                }
                let [still, one, two] = given;
                let by = |moved: [f64; 2], axis: usize| (moved[axis] - still[axis]) / PUSH;
                all.push(Matrix2::new(by(one, 0), by(two, 0), by(one, 1), by(two, 1)));
            }
            Ok(all)
        })
    }
}

impl Forced for Weak {
    fn states(&mut self, _point: &[f64], _at: &Nuisances) -> Result<Vec<Vec<State>>, Error> {
        Ok(self
            .stretches
            .iter()
            .map(|stretch| stretch.nodes.iter().map(|node| self.nodes[*node].state).collect())
            .collect())
    }

    fn pushed(
        &mut self,
        point: &[f64],
        _at: &Nuisances,
        torques: &[Vec<Vec<Pair>>],
    ) -> Result<Vec<DMatrix<f64>>, Error> {
        let settings = settings(&self.bench, &self.candidates, Side::Plant, point, None)?;
        self.stretches
            .par_iter()
            .zip(torques)
            .map(|(stretch, torques)| {
                let states: Vec<State> = stretch.nodes.iter().map(|node| self.nodes[*node].state).collect();
                let sensitivities = self.sensitivities(&settings, &states)?;
                let mut columns = DMatrix::zeros(2, torques.len());
                for (place, torque) in torques.iter().enumerate() {
                    let mut sum = Vector2::zeros();
                    for ((pair, weight), sensitivity) in
                        torque.iter().zip(&stretch.weights).zip(&sensitivities)
                    {
                        sum += sensitivity * Vector2::new(pair[0] - pair[1], pair[1]) * *weight;
                    }
                    columns.set_column(place, &(stretch.inertia * sum));
                }
                Ok(columns)
            })
            .collect()
    }
}
