//! The studies of Sections 2 to 4.1: what must hold does, what can't is shown as such, and the bytes don't depend on
//! the number of threads. The packed units must be there: `cargo xtask pack`.

use rayon::ThreadPoolBuilder;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;
use studies::lens::{DISTORTIONS, Lens};
use studies::walk::{self, Walk};
use studies::{Bench, Claim, Outcome, STUDIES, Study};

/// The studies that this file is about.
const OURS: [&str; 13] = [
    "figures-4-8",
    "figure-9",
    "tables-1-2",
    "figure-11",
    "section-3.2",
    "figure-12",
    "section-4.1.1-blur",
    "section-4.1.1",
    "figures-13-17",
    "table-3",
    "figure-18",
    "section-4.2.2-values",
    "section-5-compensation",
];

/// Statements that an honest implementation meets, and what the paper lays down.
const HOLD: [&str; 34] = [
    "C1", "C2", "C3", "C4", "C5", "C6", "C7", "C8", "C10", "C11", "C12", "C13", "C14", "C15", "C16", "C17",
    "C18", "C19", "C21", "C22", "C23", "C24", "C25", "C26", "C27", "C28", "C29", "C30", "C31", "C32", "C33",
    "C34", "C35", "C36",
];
/// Those that it can't meet.
const DO_NOT_HOLD: [&str; 3] = ["C9", "C20", "C27.worded"];

fn bench() -> Bench {
    Bench::new(scenarios::unit_path())
}

fn ours() -> impl Iterator<Item = &'static Study> {
    STUDIES.iter().filter(|study| OURS.contains(&study.id))
}

/// Every study once, for all tests of this file.
fn outcomes() -> &'static [(&'static Study, Outcome)] {
    static OUTCOMES: OnceLock<Vec<(&'static Study, Outcome)>> = OnceLock::new();
    OUTCOMES.get_or_init(|| {
        ours().map(|study| (study, (study.run)(&bench()).expect("the packed units are there"))).collect()
    })
}

fn claims() -> BTreeMap<&'static str, &'static Claim> {
    outcomes()
        .iter()
        .flat_map(|(_, outcome)| &outcome.claims)
        .map(|claim| (claim.id.as_str(), claim))
        .collect()
}

#[test]
fn paper_every_row_that_can_hold_does() {
    let claims = claims();
    for id in HOLD {
        let claim = claims.get(id).unwrap_or_else(|| panic!("no study says what became of {id}"));
        assert!(
            claim.holds,
            "{id}: {} - ours: {} - tolerance: {}",
            claim.quantity, claim.ours, claim.tolerance
        );
    }
}

#[test]
fn paper_what_cannot_hold_is_shown_with_its_reason() {
    let claims = claims();
    for id in DO_NOT_HOLD {
        let claim = claims.get(id).unwrap_or_else(|| panic!("no study says what became of {id}"));
        assert!(!claim.holds, "{id} is said to hold: {}", claim.ours);
        assert!(claim.note.len() > 40, "{id} doesn't say why: {:?}", claim.note);
    }
}

#[test]
fn paper_nothing_else_fails() {
    let failing = claims().into_values().filter(|claim| !claim.holds).map(|claim| claim.id.as_str());
    let others: Vec<&str> = failing.filter(|id| !DO_NOT_HOLD.contains(id)).collect();
    assert!(others.is_empty(), "{others:?}");
}

#[test]
fn every_study_returns_the_claims_that_it_names() {
    assert_eq!(outcomes().len(), OURS.len(), "a study is not in the list");
    for (study, outcome) in outcomes() {
        let mut returned: Vec<&str> = outcome.claims.iter().map(|claim| claim.id.as_str()).collect();
        let mut named = study.claims.to_vec();
        returned.sort_unstable();
        named.sort_unstable();
        assert_eq!(returned, named, "{}", study.id);
        assert!(study.claims.iter().all(|claim| study.answers_to(claim)));
        for claim in &outcome.claims {
            assert!(!claim.ours.is_empty() && !claim.tolerance.is_empty(), "{} says nothing", claim.id);
            assert!(!claim.ours.contains("NaN"), "{}: {}", claim.id, claim.ours);
        }
    }
}

#[test]
fn paper_every_figure_and_table_is_there() {
    let figures = |id: &str| {
        let found = outcomes().iter().find(|(study, _)| study.id == id);
        found.map_or(0, |(_, outcome)| outcome.figures.len())
    };
    // Figures 4 to 8; 13 to 17, each with the other sign beside it.
    assert_eq!((figures("figures-4-8"), figures("figures-13-17")), (5, 10));
    for id in ["figure-11", "figure-12", "figure-18"] {
        assert_eq!(figures(id), 1, "{id}");
    }
    for id in ["figure-9", "tables-1-2", "table-3"] {
        let (_, outcome) = outcomes().iter().find(|(study, _)| study.id == id).expect("listed in OURS");
        assert!(!outcome.tables.is_empty(), "{id}");
    }
}

#[test]
fn law_same_bytes_on_any_number_of_threads() {
    let ids = OURS.map(str::to_owned);
    let written = |threads: usize| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let reproduction =
                studies::reproduce(&ids, &bench(), &|_| ()).expect("the packed units are there");
            reproduction
                .write(folder.path(), &report::Provenance::default())
                .expect("the folder can be written");
        });
        let read = |name: &str| std::fs::read(Path::new(folder.path()).join(name)).expect("just written");
        (read("claims.json"), read("index.html"))
    };
    let (one, two) = (written(1), written(2));
    assert!(one.0 == two.0, "claims.json differs");
    assert!(one.1 == two.1, "index.html differs");
    let text = String::from_utf8(one.0).expect("JSON is UTF-8");
    assert!(text.contains("\"id\": \"C25\"") && text.contains("\"holds\": true"));
}

#[test]
fn law_an_unknown_id_is_the_users_to_mend() {
    let error = studies::choose(&["C999".to_owned()]).err().expect("there is no such claim");
    assert!(error.is_input() && error.to_string().contains("table-3"), "{error}");
    let by_claim = studies::choose(&["c25".to_owned()]).expect("C25 is decided by Table 3");
    assert_eq!(by_claim.iter().map(|study| study.id).collect::<Vec<_>>(), ["table-3"]);
}

/// (K_q1, K_q2) of an independent implementation, docs/claims.md, T3: geometric, and from rendered 8-bit frames.
const INDEPENDENT: [([f64; 2], [f64; 2]); 5] = [
    ([0.189, 0.115], [0.210, 0.119]),
    ([0.780, 0.528], [0.789, 0.536]),
    ([1.028, 0.816], [1.026, 0.818]),
    ([0.780, 0.528], [0.791, 0.535]),
    ([0.266, 0.408], [0.274, 0.415]),
];

#[test]
fn value_table_3_is_that_of_an_independent_implementation() {
    for (name, (geometric, rendered)) in DISTORTIONS.into_iter().zip(INDEPENDENT) {
        let lens = Lens::with(name, 0.1);
        let equations = walk::largest(&walk::by_equations(lens));
        let frames = Walk::new(&bench(), &walk::through(lens)).expect("the packed units are there").largest();
        for link in [0, 1] {
            // Between implementations 0.003, and 0.02 for frames, whose lattice of pixels meets other poses.
            let (ideal, seen) = (10.0 * equations[link], 10.0 * frames[link]);
            assert!((ideal - geometric[link]).abs() <= 0.003, "{name}, link {link}: {ideal}");
            assert!((seen - rendered[link]).abs() <= 0.02, "{name}, link {link}: {seen}");
        }
    }
}

#[test]
fn law_a_perfect_lens_shows_the_state() {
    for q2 in [-2.35, -1.0, 0.0, 0.3, 2.0] {
        let error = Lens::default().error(q2);
        // Rounding of an arc tangent.
        assert!(error.iter().all(|error| error.abs() < 1e-15), "{error:?} at {q2}");
    }
}
