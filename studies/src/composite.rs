//! Figure 18: all aberrations together, with the values of Section 4.1.3.

use crate::lens::Lens;
use crate::walk::{self, Walk, pair, worse};
use crate::{Bench, Claim, Error, Outcome, Study};

/// "On the order of those experimentally determined in [22]".
pub(crate) const LENS: Lens = Lens { k1: 0.2, p1: 0.002, p2: 0.002, s1: 0.02, s2: 0.01 };

/// This study.
pub const STUDY: Study =
    Study { id: "figure-18", title: "Figure 18: all aberrations together", claims: &["C35"], run };

/// The lens, noise and defocus of Section 4.1.3.
fn settings() -> Vec<(&'static str, f64)> {
    walk::through(LENS).into_iter().chain([("sigma", 15.0), ("N", 2.0)]).collect()
}

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let walk = Walk::new(bench, &settings())?;
    let equations = walk::by_equations(LENS);
    let (largest, ideal) = (walk.largest(), walk::largest(&equations));
    let mut outcome = Outcome::default();
    outcome.claims.push(Claim::new(
        ["C35", "estimation error with all aberrations", "on the order of 0.05 rad"],
        format!(
            "largest {}, rms {} rad from frames; largest {} by the equations of the lens alone; {} of {} places lost",
            pair(largest, 4),
            pair(walk.rms(), 4),
            pair(ideal, 4),
            walk.lost(),
            walk.looks.len()
        ),
        "largest between 0.025 and 0.1 rad: \"on the order of\"; 5 % between implementations",
        (0.025..0.1).contains(&worse(largest)) && walk.lost() == 0,
        "",
    ));
    let graph = walk::error_graph("All aberrations", &walk.errors());
    outcome.graph(graph,
        "Figure 18: (k1, p1, p2, s1, s2) = (0.2, 0.002, 0.002, 0.02, 0.01), σ = 15, N = 2; q₁ solid, q₂ dashed; from \
         rendered frames.",
    )?;
    Ok(outcome)
}
