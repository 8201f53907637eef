//! Where on the manifold the steady error is large: C48 with its curve, and C51.

use super::{FAR, Fine, PLACES, Stairs, UPRIGHT, opposite};
use crate::walk::Look;
use crate::{Claim, Error};
use mechanics::{Place, Theta};
use report::{Axis, Graph, Line, Style};

/// The outermost place that a lens lets both arms reach.
fn end(stairs: &Stairs) -> usize {
    let reached = |place: &usize| stairs.at(*place).is_finite() && stairs.at(opposite(*place)).is_finite();
    (UPRIGHT + 1..PLACES.len()).rev().find(reached).unwrap_or(FAR)
}

/// Errors at −z, 0, z in words.
fn sizes(stairs: &Stairs, place: usize) -> String {
    let [low, middle, high] = [opposite(place), UPRIGHT, place].map(|place| stairs.at(place));
    let z = PLACES[place];
    format!("{}: {low:.3}, {middle:.3}, {high:.3} at z = −{z}, 0, {z}", stairs.lens.label())
}

/// The same by first-order theory.
fn by_theory(stairs: &Stairs, place: usize) -> Result<String, Error> {
    let at = |place: usize| stairs.lens.theory(PLACES[place]);
    let (low, middle, high) = (at(opposite(place))?, at(UPRIGHT)?, at(place)?);
    Ok(format!("by theory {low:.4}, {middle:.4}, {high:.4}"))
}

fn grows(stairs: &Stairs, place: usize) -> bool {
    [place, opposite(place)].iter().all(|&end| stairs.at(end).abs() > stairs.at(UPRIGHT).abs())
}

const PAPER: &str = "greater in every case";
const TOLERANCE: &str = "none: the order of two averages over 4 s; they repeat to 0.002 (p1) ... 0.005 (k1)";

/// C48, and C48 for each lens.
pub(super) fn claims(stairs: &[Stairs]) -> Result<Vec<Claim>, Error> {
    let not_at_half: Vec<String> =
        stairs.iter().filter(|s| !grows(s, FAR)).map(|stairs| sizes(stairs, FAR)).collect();
    let worst = stairs.iter().map(|s| {
        let end = end(s);
        s.at(end).abs().min(s.at(opposite(end)).abs()) - s.at(UPRIGHT).abs()
    });
    let short: Vec<String> =
        stairs.iter().filter(|s| end(s) <= FAR).map(|stairs| stairs.lens.label()).collect();
    let mut claims = vec![Claim::new(
        [
            "C48",
            "steady error at large abs(z), the extremes of the manifold, against z = 0, every distortion",
            PAPER,
        ],
        format!(
            "at z = ±0.6 greater than at 0 for {} of {} lenses, by at least {:.3}; {}",
            stairs.iter().filter(|s| grows(s, end(s))).count(),
            stairs.len(),
            worst.fold(f64::INFINITY, f64::min),
            if short.is_empty() {
                "all reach it".to_owned()
            } else {
                format!("taken at ±0.5 for {}, which ±0.6 brings to the links' contact", short.join(", "))
            }
        ),
        TOLERANCE,
        stairs.iter().all(|stairs| grows(stairs, end(stairs))),
        format!(
            "shown with `damped`. \"Large\" has no number: at z = ±0.5 it fails for {}, since the error over z has the \
             shape of a W and ±0.5 lies near its bottoms, see the curve. An independent search found p1 = −0.015 failing \
             at ±0.5 in all of its 94 pole sets",
            if not_at_half.is_empty() { "none".to_owned() } else { not_at_half.join("; ") }
        ),
    )];
    for parameter in ["k1", "p1", "p2", "s1", "s2"] {
        claims.push(of_parameter(stairs, parameter)?);
    }
    Ok(claims)
}

/// C48 for the lenses that one parameter makes.
fn of_parameter(stairs: &[Stairs], parameter: &str) -> Result<Claim, Error> {
    let own: Vec<&Stairs> = stairs.iter().filter(|s| s.lens.parameter == parameter).collect();
    let text = |stairs: &&Stairs| {
        Ok(format!("{} ({})", sizes(stairs, end(stairs)), by_theory(stairs, end(stairs))?))
    };
    let note = match parameter {
        "p1" => "not at z = ±0.5: its error over z has the shape of a W, see the curve",
        _ => "",
    };
    let claim = Claim::new(
        [&format!("C48.{parameter}"), &format!("steady error grows with abs(z), {parameter}"), PAPER],
        own.iter().map(text).collect::<Result<Vec<_>, Error>>()?.join("; "),
        TOLERANCE,
        own.iter().all(|stairs| grows(stairs, end(stairs))),
        note,
    );
    Ok(claim.part())
}

/// C51: s₁'s errors against the errors of the estimates, place by place on the arm of Figure 26.
pub(super) fn against_the_estimates(s1: &Stairs, looks: &[Look]) -> Result<Claim, Error> {
    let place = Place::new(&Theta::TABLE_2).map_err(|error| Error::Mechanics(error.to_string()))?;
    // The total error of the estimates, averaged over ±0.05 rad of q₂ against the lattice of pixels.
    let total = |z: f64| {
        let q2 = place.q2(z);
        let near: Vec<[f64; 2]> = (looks.iter())
            .filter(|look| look.valid && (look.pose[1] - q2).abs() <= 0.05)
            .map(Look::error)
            .collect();
        let mean = |link: usize| near.iter().map(|error| error[link]).sum::<f64>() / near.len() as f64;
        f64::hypot(mean(0), mean(1))
    };
    let arm: Vec<(f64, f64)> = (UPRIGHT..=end(s1)).map(|place| (PLACES[place], s1.at(place).abs())).collect();
    let listed: Vec<String> = arm.iter().map(|(z, error)| format!("{error:.3} at {z}")).collect();
    let (upright, far) = (arm.first().copied(), arm.last().copied());
    let (Some((_, at_upright)), Some((end, at_end))) = (upright, far) else {
        return Err(Error::Mechanics("no run with s1".to_owned()));
    };
    let (near, away) = (total(0.0), total(end));
    let greatest = arm.iter().all(|(_, error)| *error <= at_end);
    Ok(Claim::new(
        [
            "C51",
            "s1: the error in z is greatest where z_desired is large, the estimates are better there",
            "yes",
        ],
        format!(
            "abs(z_d − z) {}; total error of the estimates {near:.4} rad at 0, {away:.4} at {end}",
            listed.join(", ")
        ),
        "none: the order of the table's own numbers, the greatest at the end of the arm; they repeat to 0.002",
        greatest && at_end > at_upright && away < near,
        "not met by our own table, with any of the three pole sets: the error grows away from the upright, but it is \
         greatest at z = 0.25, between the upright and the end. That it is greater at large z than at 0, with better \
         estimates there, holds (C48.s1)",
    ))
}

/// The size of the error over z.
pub(super) fn figure(curves: &[Fine]) -> Result<Graph, Error> {
    let mut graph = Graph::new(
        "Size of the steady error, damped poles",
        Axis::fitted("z desired"),
        Axis::over("abs(z desired − z)", 0.0, 0.08), // room for the legend
    );
    for (curve, style) in curves.iter().zip([Style::Solid, Style::Dashed]) {
        let points = curve.errors.iter().map(|(z, error)| (*z, error.abs())).collect();
        graph = graph.with(Line { label: curve.lens.label(), style, points });
    }
    Ok(graph)
}
