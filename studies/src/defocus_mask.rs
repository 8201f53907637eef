//! Section 2.2: Figure 9's mask and the exposure factor, as the camera unit declares them.

use crate::{Bench, Claim, Error, Outcome, Study};
use report::{Cell, Table};

/// This study.
pub const STUDY: Study = Study {
    id: "figure-9",
    title: "Figure 9: the mask of the defocus, and the exposure factor",
    claims: &["C6", "C7"],
    run,
};

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let mut unit = bench.unit("acrobot_camera")?;
    unit.start(0.0, &[])?;
    let mut start = |name: &str| unit.get(name);
    let (f0, f1, f2, exposure) = (start("f0")?, start("f1")?, start("f2")?, start("E_t")?);
    let sum = f0 + 4.0 * f1 + 4.0 * f2;
    let mut outcome = Outcome::default();
    outcome.claims.push(
        Claim::new(
            ["C6", "mask of the defocus", "f0, f1, f2 = 5/9, 2/27, 1/27"],
            format!("{f0:.6}, {f1:.6}, {f2:.6}; sum of the nine {sum}"),
            "1e-15: one rounding; a sum of 1 keeps the brightness",
            (sum - 1.0).abs() <= 1e-15
                && [f0 - 5.0 / 9.0, f1 - 2.0 / 27.0, f2 - 1.0 / 27.0].iter().all(|off| off.abs() <= 1e-15),
            "",
        )
        .definition(),
    );
    outcome.claims.push(
        Claim::new(
            [
                "C7",
                "exposure factor where nothing else is said",
                "1.0 by default (2.2); on the order of 0.01 (4)",
            ],
            format!("E_t = {exposure}"),
            "exact",
            exposure == 0.01,
            "the paper says both; Section 4, whose figures these are, decides",
        )
        .definition(),
    );
    let number = |value: f64| Cell::Number(format!("{value:.4}"));
    let rows = [[f2, f1, f2], [f1, f0, f1], [f2, f1, f2]];
    let table =
        Table { head: vec![String::new(); 3], rows: rows.map(|row| row.map(number).to_vec()).to_vec() };
    outcome.tables.push(("Figure 9".to_owned(), table));
    Ok(outcome)
}
