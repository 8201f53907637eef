//! Which experiment is best, and what is said about it.

use super::Question;
use super::catalogue::Experiment;
use super::separation::Losses;
use crate::diagnosis::Separation;
use crate::rigs::acrobot::experiment::policy::DESIGN;

/// An experiment of the catalogue with what simulating it gave.
pub struct Tried {
    /// Which.
    pub entry: &'static Experiment,
    /// Losses between members.
    pub losses: Losses,
    /// How many times as long as before is recorded.
    pub times: f64,
}

impl Tried {
    /// Asks for longer records where these tell what is not told otherwise: losses grow with the rows.
    pub fn lengthen(&mut self) {
        let count = self.losses.len();
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
        let hopeful =
            pairs.map(|(a, b)| self.pair(a, b)).filter(|loss| loss * DESIGN.longest >= DESIGN.enough);
        let times = (DESIGN.enough / hopeful.fold(DESIGN.enough, f64::min)).ceil();
        self.losses.iter_mut().flatten().for_each(|loss| *loss *= times);
        self.times *= times;
    }

    /// Its name, and how long it takes.
    pub fn name(&self) -> String {
        let times = self.times;
        if times > 1.0 {
            format!("{}, {times} times as long", self.entry.name)
        } else {
            self.entry.name.to_owned()
        }
    }

    /// What is to be done.
    pub fn order(&self) -> String {
        let (what, times) = (self.entry.what, self.times);
        if times > 1.0 {
            format!("{what} Record {times} times as long as before, in more runs.")
        } else {
            what.to_owned()
        }
    }

    /// Loss of a pair, whichever of the two is true.
    pub fn pair(&self, a: usize, b: usize) -> f64 {
        self.losses[a][b].min(self.losses[b][a])
    }

    /// The pair that comes out worst.
    pub fn worst(&self) -> (usize, usize, f64) {
        let count = self.losses.len();
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
        let pairs = pairs.map(|(a, b)| (a, b, self.pair(a, b)));
        pairs.min_by(|a, b| a.2.total_cmp(&b.2)).unwrap_or((0, 0, 0.0))
    }

    /// Probability that the truth is expected to have after the experiment, over the members by their weights.
    pub fn certainty(&self, weights: &[f64]) -> f64 {
        let all: f64 = weights.iter().sum();
        let after = |a: usize| {
            let rivals = self.losses[a].iter().map(|loss| libm::exp(-0.5 * loss / DESIGN.caution));
            1.0 / rivals.sum::<f64>()
        };
        weights.iter().enumerate().map(|(a, weight)| weight * after(a)).sum::<f64>() / all
    }

    /// Better first: by certainty in whole steps, then the cheaper, then the larger loss of the worst pair.
    pub fn rank(&self, weights: &[f64]) -> (i64, i64, f64) {
        let steps = (self.certainty(weights) / DESIGN.equal).round() as i64;
        (-steps, i64::from(self.entry.cost) + i64::from(self.times > 1.0), -self.worst().2)
    }

    /// Makes the losses smaller where simulating the runs at hand predicts more than their data gave: a pair that
    /// they did not tell apart loses no more than `most` there.
    pub fn discount(&mut self, same: &Losses, most: f64) {
        for (row, same) in self.losses.iter_mut().zip(same) {
            for (loss, same) in row.iter_mut().zip(same) {
                *loss *= if *same > most { most / same } else { 1.0 };
            }
        }
    }

    /// Groups of members that are not told apart, by their places.
    pub fn groups(&self) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for member in 0..self.losses.len() {
            let near = |group: &Vec<usize>| group.iter().any(|other| self.pair(member, *other) < DESIGN.told);
            let (mut joined, apart): (Vec<Vec<usize>>, Vec<Vec<usize>>) = groups.into_iter().partition(near);
            let mut group: Vec<usize> = joined.drain(..).flatten().collect();
            group.push(member);
            groups = apart;
            groups.push(group);
        }
        groups
    }
}

/// Sorts, best first. The order in the catalogue decides what is left.
pub fn sort(tried: &mut [Tried], weights: &[f64]) {
    tried.sort_by(|a, b| {
        let (a, b) = (a.rank(weights), b.rank(weights));
        (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2))
    });
}

/// The best experiment in words. Names of parameters stay out of it: they stand beside.
pub fn words(best: &Tried) -> String {
    let told = best.groups();
    if told.len() == best.losses.len() {
        return best.order();
    }
    let all = if told.len() > 1 { "all of them" } else { "them" };
    format!("Nothing in the catalogue tells {all} apart for sure. Nearest comes: {}", best.order())
}

/// A line of the table of experiments.
pub fn line(tried: &Tried, question: &Question<'_>) -> Separation {
    let (a, b, loss) = tried.worst();
    let name = |place: usize| question.name(place);
    Separation {
        experiment: tried.name(),
        loss: Some(loss),
        pair: vec![name(a), name(b)],
        certainty: Some(tried.certainty(&question.weights())),
        problem: None,
    }
}
