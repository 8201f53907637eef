//! Sliders for the five coefficients of the lens, on the page of Figures 4 to 8.
//!
//! By (3) to (8) a displacement is the sum of one field for each coefficient, times the coefficient. So the page holds the five
//! fields on a grid, by the equations that C4 holds the camera unit's frames against, and its script only adds: that is exact.

use crate::Error;
use crate::composite;
use crate::lens::{DISTORTIONS, Lens};
use maud::html;
use report::Page;
use serde::Serialize;

/// The study on whose page they stand.
pub(super) const STUDY: &str = "figures-4-8";

/// Points of the grid along an axis, and how far out they reach.
const POINTS: usize = 25;
const REACH: f64 = 0.95;
/// Largest coefficient that can be chosen: beyond, the picture folds.
const MOST: f64 = 0.3;
/// Pixels of an image unit: the picture is 512 wide.
const PIXELS: f64 = 256.0;

const SCRIPT: &str = include_str!("../../assets/lens.js");

/// What the script needs.
#[derive(Serialize)]
struct Data {
    points: usize,
    reach: f64,
    most: f64,
    pixels: f64,
    /// Name, and the columns with its displacements along u and v for a coefficient of 1, row by row.
    fields: Vec<(&'static str, usize, usize)>,
    /// Lenses that a button chooses: its words and the five coefficients.
    lenses: Vec<(String, [f64; 5])>,
}

/// Adds them.
pub(super) fn sliders(page: &mut Page) -> Result<(), Error> {
    let mut fields = Vec::new();
    for name in DISTORTIONS {
        let lens = Lens::with(name, 1.0);
        let [u, v] = [0, 1].map(|axis| grid().map(|at| lens.displacement(at)[axis]).collect::<Vec<f64>>());
        fields.push((name, page.column(&u)?, page.column(&v)?));
    }
    let single =
        |(figure, name): (u32, &'static str)| (format!("Figure {figure}"), values(Lens::with(name, 0.1)));
    let mut lenses: Vec<(String, [f64; 5])> = (4..).zip(DISTORTIONS).map(single).collect();
    lenses.push(("Figure 18's lens".to_owned(), values(composite::LENS)));
    let data = Data { points: POINTS, reach: REACH, most: MOST, pixels: PIXELS, fields, lenses };
    let json = serde_json::to_string(&data).map_err(|why| report::Error::Data { why: why.to_string() })?;
    page.heading("Turn the coefficients yourself");
    page.text(
        "Grey: the grid as a perfect lens shows it. Coloured: as this lens shows it, to scale, with an arrow from each second point. \
         The page adds the fields of (3) to (8), which are linear in their coefficients.",
    );
    page.push(
        html! { div #lens { noscript { p { "The sliders need scripts; the five fields stand below." } } } },
    );
    page.scripted("lens-data", json, &[SCRIPT], "");
    Ok(())
}

fn values(Lens { k1, p1, p2, s1, s2 }: Lens) -> [f64; 5] {
    [k1, p1, p2, s1, s2]
}

fn grid() -> impl Iterator<Item = [f64; 2]> {
    let place = |index: usize| REACH * (2.0 * index as f64 / (POINTS - 1) as f64 - 1.0);
    (0..POINTS).flat_map(move |row| (0..POINTS).map(move |column| [place(column), place(row)]))
}

#[cfg(test)]
mod tests {
    use super::{grid, values};
    use crate::composite;
    use crate::lens::{DISTORTIONS, Lens};

    #[test]
    fn law_the_fields_add_up_to_the_lens() {
        for at in grid() {
            let whole = composite::LENS.displacement(at);
            let mut sum = [0.0; 2];
            for (name, value) in DISTORTIONS.into_iter().zip(values(composite::LENS)) {
                let [u, v] = Lens::with(name, 1.0).displacement(at);
                sum = [sum[0] + value * u, sum[1] + value * v];
            }
            // Sums of five terms of at most 1, in another order.
            assert!((whole[0] - sum[0]).abs() < 1e-15 && (whole[1] - sum[1]).abs() < 1e-15, "{at:?}");
        }
    }
}
