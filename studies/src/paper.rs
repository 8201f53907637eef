//! The paper's figures: their captions as printed, what a reader should look for in ours, and which statements each shows.

/// A figure of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Printed {
    /// Its number.
    pub number: u32,
    /// Its caption as printed.
    pub caption: &'static str,
    /// What to look for.
    pub look: &'static str,
    /// The statements that it shows.
    pub claims: &'static [&'static str],
}

const SIGN: &str = "Where one curve of the pair is symmetric about q₂ = 0 and where it is antisymmetric: that is the mark of this distortion.";
const STEADY: &str = "The distance between z and the dashed line once the transient is over: a lens that nobody corrects leaves a steady error.";

/// All of them.
pub const FIGURES: &[Printed] = &[
    of(
        1,
        "Dual-loop visual servo.",
        "The inner loop has its own sensors: the camera's delay moves the set point only.",
        &["F1-2.errors", "F1-2.delay"],
    ),
    of(
        2,
        "Direct visual servo.",
        "The camera closes the only loop: each error of an estimate becomes one of the state.",
        &["F1-2.errors", "F1-2.delay"],
    ),
    of(
        3,
        "Pinhole lens with associated coordinate systems.",
        "Lines through the pinhole meet the crosses, which the camera unit found in its own frame.",
        &["F3"],
    ),
    of(
        4,
        "Vector field distortions from a positive k_1.",
        "All arrows point away from the axis, and grow with the cube of the distance.",
        &["C1", "C4", "F4-8"],
    ),
    of(
        5,
        "Vector field of distortions from a positive p_1.",
        "The field is its own mirror image top to bottom; −p1 mirrors it left to right.",
        &["C2", "C4", "F4-8"],
    ),
    of(
        6,
        "Vector field of distortions from a positive p_2.",
        "Figure 5 turned by a quarter: −p2 mirrors it top to bottom.",
        &["C2", "C4", "F4-8"],
    ),
    of(
        7,
        "Vector field of distortions from a positive s_1.",
        "All arrows are parallel to u; −s1 turns each of them round.",
        &["C3", "C4", "F4-8"],
    ),
    of(
        8,
        "Vector field of distortions from a positive s_2.",
        "All arrows are parallel to v; −s2 turns each of them round.",
        &["C3", "C4", "F4-8"],
    ),
    of(
        9,
        "Mask for discrete convolution in defocus simulation.",
        "The nine weights add up to one: a pass keeps the light.",
        &["C6"],
    ),
    of(
        10,
        "The free-standing acrobot.",
        "Angles count from the upright; the crosses lie on the drum's centre, the joint and the tip.",
        &["F10"],
    ),
    of(
        11,
        "Equilibrium manifold for the acrobot.",
        "q₁ turns back beyond q₂ = π/2: it does not tell the place, q₂ does.",
        &["C10"],
    ),
    of(
        12,
        "Error in visual state estimation with no distortions.",
        "Nothing but the lattice of pixels: thousandths of a radian.",
        &["C17"],
    ),
    of(13, "State estimation error (q_1 solid, q_2 dashed) under radial distortion (k_1 = 0.1).", SIGN, LENS),
    of(
        14,
        "State estimation error (q_1 solid, q_2 dashed) under decentering distortion (p_1 = 0.1).",
        SIGN,
        LENS,
    ),
    of(
        15,
        "State estimation error (q_1 solid, q_2 dashed) under decentering distortion (p_2 = 0.1).",
        SIGN,
        LENS,
    ),
    of(
        16,
        "State estimation error (q_1 solid, q_2 dashed) under thin prism distortion (s_1 = 0.1).",
        SIGN,
        LENS,
    ),
    of(
        17,
        "State estimation error (q_1 solid, q_2 dashed) under thin prism distortion (s_2 = 0.1).",
        SIGN,
        LENS,
    ),
    of(
        18,
        "State estimation error (q_1 solid, q_2 dashed) under all aberrations.",
        "The largest error, of the order of 0.05 rad, and the noise on top of the lens's smooth curve.",
        &["C35"],
    ),
    of(
        19,
        "Visual servo of the acrobot with no distortions (see text).",
        "z follows its reference; the torque chatters, which it does not in Figure 20.",
        &["C37", "C38", "C39", "F19"],
    ),
    of(
        20,
        "Rolling acrobot under full state feedback control (see text).",
        "The same course as Figure 19 without chatter of the torque.",
        &["C38", "C39", "F20"],
    ),
    of(21, "Visual servo with k_1 = 0.1 (see text).", STEADY, &["C45", "C46", "C47", "C50"]),
    of(22, "Visual servo with k_1 = -0.1 (see text).", STEADY, &["C45", "C46", "C47", "C50"]),
    of(23, "Visual servo with p_1 = 0.015 (see text).", STEADY, &["C45", "C48", "C49", "C50"]),
    of(24, "Visual servo with p_1 = -0.015 (see text).", STEADY, &["C45", "C48", "C49", "C50"]),
    of(25, "Visual servo with p_2 = 0.015 (see text).", STEADY, &["C45", "C52"]),
    of(26, "Visual servo with s_1 = 0.0125 (see text).", STEADY, &["C45", "C49", "C51", "C52"]),
    of(27, "Visual servo with s_2 = 0.025 (see text).", STEADY, &["C45", "C52"]),
];

/// What Figures 13 to 17 are held against.
const LENS: &[&str] = &["C26", "C27", "C28", "C29", "C30", "C31", "C32", "C33", "C34", "F13-17"];

const fn of(
    number: u32,
    caption: &'static str,
    look: &'static str,
    claims: &'static [&'static str],
) -> Printed {
    Printed { number, caption, look, claims }
}

/// The figure of the paper that a caption of ours begins with.
pub fn beside(caption: &str) -> Option<&'static Printed> {
    let rest = caption.strip_prefix("Figure ")?;
    let digits = &rest[..rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len())];
    let number: u32 = digits.parse().ok()?;
    FIGURES.iter().find(|figure| figure.number == number)
}

/// The figures that show a statement.
pub fn showing(claim: &str) -> impl Iterator<Item = &'static Printed> {
    FIGURES.iter().filter(move |figure| figure.claims.contains(&claim))
}

#[cfg(test)]
mod tests {
    use super::{FIGURES, beside};
    use crate::STUDIES;

    #[test]
    fn law_figures_name_claims_of_one_study() {
        let known: Vec<(&str, &str)> =
            STUDIES.iter().flat_map(|study| study.claims.iter().map(|claim| (*claim, study.id))).collect();
        for figure in FIGURES {
            let studies: Vec<&str> = (figure.claims.iter())
                .map(|claim| {
                    known
                        .iter()
                        .find(|(name, _)| name == claim)
                        .unwrap_or_else(|| panic!("no claim {claim}"))
                        .1
                })
                .collect();
            assert!(
                studies.windows(2).all(|pair| pair[0] == pair[1]),
                "Figure {}: {studies:?}",
                figure.number
            );
        }
        assert_eq!(
            FIGURES.iter().map(|figure| figure.number).collect::<Vec<_>>(),
            (1..=27).collect::<Vec<u32>>()
        );
    }

    #[test]
    fn value_a_caption_tells_its_figure() {
        assert_eq!(beside("Figure 13: k1 = 0.1").map(|figure| figure.number), Some(13));
        assert_eq!(beside("Figure 1 of the paper, x").map(|figure| figure.number), Some(1));
        assert!(beside("Beside Figure 13: the other sign").is_none() && beside("Figure 99").is_none());
    }
}
