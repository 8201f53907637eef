//! Figure 12: the error that the lattice of pixels and the grey levels leave when nothing distorts.

use crate::walk::{self, Walk, small, worse};
use crate::{Bench, Claim, Error, Outcome, Study};

/// This study.
pub const STUDY: Study =
    Study { id: "figure-12", title: "Figure 12: estimation error with no distortion", claims: &["C17"], run };

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let walks = Walk::all(bench, &[vec![], vec![("threshold", 127.5)]])?;
    let [usual, half] = [0, 1].map(|index| &walks[index]);
    let mut outcome = Outcome::default();
    outcome.claims.push(Claim::new(
        ["C17", "quantisation error without distortion", "a figure without legible values"],
        format!("rms {}, largest {} rad", small(usual.rms()), small(usual.largest())),
        "rms ≤ 6e-4, largest ≤ 1.8e-3 rad: 1.5 times an independent implementation's 3.9e-4 and 1.2e-3, since the \
         lattice of pixels meets other poses",
        worse(usual.rms()) <= 6e-4 && worse(usual.largest()) <= 1.8e-3 && usual.lost() == 0,
        format!(
            "the paper's values can't be told from its text; with a threshold at half of the contrast rms {}, largest {}",
            small(half.rms()),
            small(half.largest())
        ),
    ));
    let title = "No distortion";
    let graph = walk::error_graph(title, &usual.errors());
    outcome.graph(graph, "Figure 12: q₁ solid, q₂ dashed; from rendered frames.")?;
    Ok(outcome)
}
