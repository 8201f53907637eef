//! Newton's method for algebraic loops at the start that fixed-point iteration does not solve, such as y = 0.9 u + 3 with
//! u = y: unknown are the values of the connected real inputs of the loop.
//!
//! x ← x - J⁻¹ F(x), F(x) = g(x) - x, where g is what the units answer to x; J by forward differences; a step is halved until
//! F gets smaller.

/// Steps after which a loop is given up; from a fair start Newton's method needs fewer than ten.
const STEPS: u32 = 50;

/// Halvings of a step after which it is given up.
const HALVINGS: u32 = 20;

/// Solves g(x) = x from a start, to `settled` relative to the larger of x and one; tells the steps that it took, and `None`
/// where it finds no solution. `g` answers to values, or that it can't.
pub(crate) fn solve<E>(
    x: &mut Vec<f64>,
    settled: f64,
    mut g: impl FnMut(&[f64]) -> Result<Vec<f64>, E>,
) -> Result<Option<u32>, E> {
    let mut residual = residual_of(x, &g(x)?);
    for step in 1..=STEPS {
        let scale = |x: f64| x.abs().max(1.0);
        let mut jacobian = Vec::with_capacity(x.len());
        for i in 0..x.len() {
            let before = x[i];
            // The root of the rounding error balances it against the curvature; what is added is exactly representable.
            x[i] += scale(before) * f64::EPSILON.sqrt();
            let moved = x[i] - before;
            let column = residual_of(x, &g(x)?);
            x[i] = before;
            jacobian.push(column.iter().zip(&residual).map(|(a, b)| (a - b) / moved).collect::<Vec<f64>>());
        }
        let Some(change) = solved(jacobian, residual.clone()) else { return Ok(None) };
        let mut share = 1.0;
        let mut tried = 0;
        loop {
            let next: Vec<f64> = x.iter().zip(&change).map(|(x, change)| x - share * change).collect();
            let left = residual_of(&next, &g(&next)?);
            let better = norm(&left) < norm(&residual);
            let small = (next.iter().zip(&change)).all(|(x, change)| change.abs() <= settled * scale(*x));
            let solved = (next.iter().zip(&left)).all(|(x, left)| left.abs() <= settled * scale(*x));
            if solved || better || small && left.iter().all(|left| left.is_finite()) {
                (*x, residual) = (next, left);
                if solved || small {
                    // The units have last seen the solution.
                    return Ok(Some(step));
                }
                break;
            }
            tried += 1;
            share /= 2.0;
            if tried > HALVINGS {
                return Ok(None);
            }
        }
    }
    Ok(None)
}

fn residual_of(x: &[f64], answer: &[f64]) -> Vec<f64> {
    answer.iter().zip(x).map(|(answer, x)| answer - x).collect()
}

/// The largest; infinite where one is no number.
fn norm(values: &[f64]) -> f64 {
    values
        .iter()
        .fold(0.0, |most, value| if value.is_finite() { value.abs().max(most) } else { f64::INFINITY })
}

/// Solves the linear system by elimination with pivots; `columns` of the matrix. `None` where it is singular.
fn solved(mut columns: Vec<Vec<f64>>, mut right: Vec<f64>) -> Option<Vec<f64>> {
    let n = right.len();
    let largest = columns.iter().map(|column| norm(column)).fold(0.0, f64::max);
    for at in 0..n {
        let pivot = (at..n).max_by(|&a, &b| columns[at][a].abs().total_cmp(&columns[at][b].abs()))?;
        // Differences carry half of the digits: below that a pivot is nothing but their error.
        let size = columns[at][pivot].abs();
        if size.is_nan() || size <= f64::EPSILON.sqrt() * largest {
            return None;
        }
        columns.iter_mut().for_each(|column| column.swap(at, pivot));
        right.swap(at, pivot);
        for row in at + 1..n {
            let factor = columns[at][row] / columns[at][at];
            for column in columns.iter_mut().skip(at) {
                column[row] -= factor * column[at];
            }
            right[row] -= factor * right[at];
        }
    }
    for at in (0..n).rev() {
        right[at] /= columns[at][at];
        for row in 0..at {
            right[row] -= columns[at][row] * right[at];
        }
    }
    Some(right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn found(start: &[f64], g: impl Fn(&[f64]) -> Vec<f64>) -> Option<Vec<f64>> {
        let mut x = start.to_vec();
        let steps = solve::<Infallible>(&mut x, 1e-12, |x| Ok(g(x))).expect("can't fail");
        steps.map(|_| x)
    }

    #[test]
    fn value_loops_that_iteration_does_not_solve() {
        let near = |found: Option<Vec<f64>>, expected: &[f64]| {
            let found = found.expect("solved");
            for (found, expected) in found.iter().zip(expected) {
                // The residual is 1e-12 of the value, and the slowest loop here, 0.9, enlarges it by ten.
                assert!((found - expected).abs() <= 1e-11 * expected.abs().max(1.0), "{found} {expected}");
            }
        };
        near(found(&[0.0], |x| vec![0.9 * x[0] + 3.0]), &[30.0]);
        near(found(&[0.0], |x| vec![-4.0 * x[0] + 10.0]), &[2.0]);
        // x = cos x; scipy.optimize.fixed_point gives 0.7390851332151607.
        near(found(&[100.0], |x| vec![x[0].cos()]), &[0.739_085_133_215_160_7]);
        // A ring of three whose matrix needs pivots.
        near(
            found(&[0.0; 3], |x| vec![x[1] + x[0] - 2.0, x[2] + x[1] - 3.0, 4.0 * x[0] - x[2]]),
            &[1.5, 2.0, 3.0],
        );
    }

    #[test]
    fn value_a_linear_loop_takes_one_step() {
        // Dyadic, so that differences and the solution are exact: nothing is left, and the step was no small one.
        let mut x = vec![0.0];
        assert_eq!(solve::<Infallible>(&mut x, 1e-12, |x| Ok(vec![0.5 * x[0] + 1.0])), Ok(Some(1)));
        assert_eq!(x, [2.0]);
    }

    #[test]
    fn law_a_step_that_leaves_as_much_as_before_is_halved() {
        // Newton's step from 1 leads to -1, where as much is left; half of it leads to the solution. All of it is dyadic.
        let left = |x: f64| if x >= 1.0 { 1.0 + (x - 1.0) / 2.0 } else { x };
        let mut x = vec![1.0];
        assert_eq!(solve::<Infallible>(&mut x, 1e-12, |x| Ok(vec![left(x[0]) + x[0]])), Ok(Some(1)));
        assert_eq!(x, [0.0]);
    }

    #[test]
    fn law_what_is_small_is_so_beside_large_values() {
        // A line of slope -1/2 to 2²¹, where 2⁻³⁰ are left: less than 1e-12 of it, so it is solved in one step.
        let (mut x, most) = (vec![0.0], f64::from(1 << 21));
        let left = |x: f64| if x < most { (most - x) / 2.0 } else { 2f64.powi(-30) };
        assert_eq!(solve::<Infallible>(&mut x, 1e-12, |x| Ok(vec![left(x[0]) + x[0]])), Ok(Some(1)));
        assert_eq!(x, [most]);
        // A steep line with a step near its zero: more is left there, but x can't be told more exactly.
        let mut x = vec![most + 1.0];
        let left = |x: f64| {
            let off = x - most;
            if off.abs() < 2f64.powi(-6) { 2f64.powi(-10) } else { 2f64.powi(-10) - 1024.0 * off }
        };
        assert_eq!(solve::<Infallible>(&mut x, 1e-12, |x| Ok(vec![left(x[0]) + x[0]])), Ok(Some(2)));
        assert!((x[0] - most).abs() < 1e-5, "{x:?}");
        // And a slope is none only beside others.
        assert_eq!(found(&[0.0], |x| vec![x[0] - (x[0] - 3.0) / 131_072.0]), Some(vec![3.0]));
    }

    #[test]
    fn value_no_solution_is_told() {
        assert_eq!(found(&[0.0], |x| vec![x[0] + 1.0]), None, "parallel");
        assert_eq!(found(&[1.0], |x| vec![x[0] * x[0] + x[0] + 1.0]), None, "no real root");
        assert_eq!(found(&[1.0], |_| vec![f64::NAN]), None);
    }
}
