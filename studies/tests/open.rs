//! The studies of what the paper asks or leaves open: each row is there, is a measurement of ours or a part, and what
//! its words say still comes out. The packed units must be there: `cargo xtask pack`.

use studies::{Bench, Claim, Kind, STUDIES, Study, Tally, reproduce};

/// The studies that this file is about, and how many figures and tables each has at least.
const OURS: [(&str, usize, usize); 8] = [
    ("figures-1-2", 4, 1),
    ("figures-3-10", 2, 0),
    ("section-2.3-interlaced", 0, 1),
    ("section-2.2-frame-rates", 1, 1),
    ("table-3-readings", 0, 1),
    ("section-4.2-causes", 0, 1),
    ("section-5-placement", 1, 1),
    ("section-6-velocities", 1, 1),
];

fn ours() -> impl Iterator<Item = (&'static Study, usize, usize)> {
    OURS.iter().map(|(id, figures, tables)| {
        let study = STUDIES.iter().find(|study| study.id == *id);
        (study.unwrap_or_else(|| panic!("no study {id}")), *figures, *tables)
    })
}

#[test]
fn paper_what_was_measured_still_comes_out() {
    let bench = Bench::new(scenarios::unit_path());
    for (study, figures, tables) in ours() {
        let outcome = (study.run)(&bench).expect("the units are packed: cargo xtask pack");
        let named: Vec<&str> = outcome.claims.iter().map(|claim| claim.id.as_str()).collect();
        assert_eq!(named, study.claims, "{}", study.id);
        for claim in &outcome.claims {
            assert!(claim.holds, "{claim:#?}");
            assert!(!claim.ours.contains("NaN") && !claim.tolerance.is_empty(), "{claim:#?}");
            assert!(matches!(claim.kind, Kind::Measurement | Kind::Part), "{}: {:?}", claim.id, claim.kind);
        }
        assert!(outcome.figures.len() >= figures && outcome.tables.len() >= tables, "{}", study.id);
    }
}

#[test]
fn law_the_headline_counts_the_papers_own_statements() {
    let claim = |id: &str, holds: bool| Claim::new([id, "", ""], "", "", holds, "");
    let rows = [
        claim("C1", true),
        claim("C9", false),
        claim("C6", true).definition(),
        claim("C1.part", false).part(),
        claim("C1.other", true).part(),
        claim("Map", false).measurement(),
    ];
    let tally = Tally::of(rows.iter());
    assert_eq!((tally.holding, tally.claims), (1, 2));
    assert_eq!(
        tally.to_string(),
        "1 of 2 statements of the paper hold; beside them: 1 definitions, 1 of 2 figures, tables and parts hold, \
         1 measurements of ours"
    );
    assert_eq!(Tally::of(rows[..2].iter()).to_string(), "1 of 2 statements of the paper hold");
    let json = serde_json::to_string(&rows[5]).expect("it is data");
    assert!(json.contains("\"kind\":\"measurement\""), "{json}");
}

#[test]
fn paper_every_numbered_statement_is_decided_once() {
    let numbered = |id: &&str| id.strip_prefix('C').is_some_and(|n| n.parse::<u32>().is_ok());
    let mut ids: Vec<&str> =
        STUDIES.iter().flat_map(|study| study.claims).copied().filter(numbered).collect();
    ids.sort_by_key(|id| id[1..].parse::<u32>().unwrap_or_default());
    let all: Vec<String> = (1..=55).map(|number| format!("C{number}")).collect();
    assert_eq!(ids, all);
}

#[test]
fn law_a_reproduction_of_measurements_alone_has_no_statement() {
    let bench = Bench::new(scenarios::unit_path());
    let reproduction = reproduce(&["table-3-readings".to_owned()], &bench, &|_| {}).expect("packed units");
    assert_eq!((reproduction.tally().claims, reproduction.tally().measurements), (0, 1));
}
