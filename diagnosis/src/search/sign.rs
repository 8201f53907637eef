//! Whether an unlisted input does what an input would whose column has its sign turned. Nothing else that a machine lacks is against an input
//! and about as large, and beside a turned sign every name is wrong.

use super::Search;
use super::nearest::{Column, columns, dot};
use crate::dynamics::machine::Role;
use crate::error::Error;
use crate::infer::Fit;
use crate::observe::InputEffect;
use crate::statistics::levels::{HALF, SEVERAL};

impl Search<'_> {
    /// Whether it is so, which is then told as a doubt.
    ///
    /// # Errors
    /// A unit failed.
    pub fn finds_a_turned_sign(&mut self, fit: &Fit) -> Result<bool, Error> {
        let is_gain = |parameter: &usize| {
            let role = self.engine.machine.parameters[*parameter].role;
            matches!(role, Role::Input(_, InputEffect::Gain))
        };
        let gains: Vec<usize> = self.others(&[]).into_iter().filter(is_gain).collect();
        let Some(course) = columns(self.engine, fit, &gains)? else { return Ok(false) };
        let Some((gain, share)) = turned(&course.columns, &course.values) else { return Ok(false) };
        let machine = &self.engine.machine;
        let Role::Input(input, _) = machine.parameters[gain].role else { return Ok(false) };
        let name = &machine.inputs[input].name;
        self.doubts.push(format!(
            "with its sign turned {name} would do {:.0} % of what the unlisted input did: look at the sign of its column",
            100.0 * share
        ));
        Ok(true)
    }
}

/// The gain that alone does most of a course, from about -1 on, and the share that it does.
fn turned(columns: &[Column], course: &[f64]) -> Option<(usize, f64)> {
    let does = |column: &Column| {
        let (along, square) = (dot(&column.values, course), dot(&column.values, &column.values));
        let share = along * along / (square * dot(course, course));
        let gain = column.value(along / square);
        let is_about = (-SEVERAL..=-SEVERAL.recip()).contains(&gain);
        (share >= HALF && is_about).then_some((column.chord.parameter, share))
    };
    columns.iter().filter_map(does).max_by(|one, other| one.1.total_cmp(&other.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::linearise::Chord;

    /// Two inputs, the second of which is like the first for the most part, each at a gain of 1.
    fn inputs() -> [Column; 2] {
        let of = |parameter: usize, by: f64| {
            let chord = Chord { parameter, to: 1.5, per: 0.5 };
            Column::new(chord, 1.0, (0..200).map(|row| first(row) + by * other(row)).collect())
        };
        [of(0, 0.0), of(1, 0.5)]
    }

    fn first(row: i32) -> f64 {
        libm::sin(0.1 * f64::from(row))
    }

    fn other(row: i32) -> f64 {
        libm::cos(2.3 * f64::from(row))
    }

    #[test]
    fn value_what_is_against_an_input_and_about_as_large_is_its_sign() {
        // an amount of the input, and of what is none of its
        let is = |amount: f64, by: f64| {
            let course: Vec<f64> = (0..200).map(|row| amount * first(row) + by * other(row)).collect();
            turned(&inputs()[..1], &course).is_some()
        };
        assert!(is(-2.0, 0.0) && is(-2.0, 1.8) && !is(-2.0, 2.2), "half of it at least");
        // a gain of -0.4 and of -2.9, and not of -0.3 and of -3.1
        assert!(is(-1.4, 0.0) && is(-3.9, 0.0) && !is(-1.3, 0.0) && !is(-4.1, 0.0));
        assert!(!is(2.0, 0.0));
    }

    #[test]
    fn law_of_several_inputs_that_is_told_which_does_most() {
        let told = |place: usize| {
            let course: Vec<f64> = inputs()[place].values.iter().map(|value| -2.0 * value).collect();
            turned(&inputs(), &course).map(|(parameter, _)| parameter)
        };
        assert_eq!((told(0), told(1)), (Some(0), Some(1)));
        assert_eq!(turned(&inputs(), &[0.0; 200]), None, "a course of nothing");
    }
}
