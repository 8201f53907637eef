//! What signs, units of measurement and offsets are believed by.

use super::*;

#[test]
fn value_the_longest_stretch_has_no_gap() {
    let timestamps = [0.0, 1.0, 2.0, 9.0, 10.0, 11.0, 12.0, 20.0];
    assert_eq!(whole_stretch(&timestamps, 1.0), 3..7);
    assert_eq!(whole_stretch(&timestamps[..3], 1.0), 0..3);
}

#[test]
fn value_a_log_is_tried_as_far_as_it_must_be() {
    // half a minute at 100 Hz: a model that drifts off in it says no more in an hour, and runs a hundred times as long
    let rows = |count: u32| whole_stretch(&(0..count).map(f64::from).collect::<Vec<_>>(), 1.0).len();
    assert_eq!(rows(2_700), 2_700);
    assert!(rows(3_300) < 3_300 && rows(100_000) == rows(3_300));
}

#[test]
fn value_how_many_signs_are_turned_and_what_each_must_gain() {
    // each of four inputs either way is a run of the model sixteen times; five inputs would be thirty-two
    assert_eq!([0, 1, 4, 5, 60].map(turned_ways), [1, 2, 16, 1, 1]);
    // a hundredth of the squared correlation: less is noise of the log, more is what a sign does
    assert!(score(0.909, 1) < score(0.9, 0) && score(0.911, 1) > score(0.9, 0));
    assert!(score(0.919, 2) < score(0.9, 0) && score(0.921, 2) > score(0.9, 0), "each of them");
}

/// What a line said of a speed in rad/s: evidence and conversion.
fn judged(line: Line) -> (String, Option<Affine>) {
    let (matched, _) = judged_in(line, Some("rad/s"), None);
    (matched.evidence.join("; "), matched.affine)
}

/// A speed in rad/s whose header says so, and whose sign may be turned, by a line; and notices.
fn judged_in(line: Line, header: Option<&str>, affine: Option<Affine>) -> (Match, Vec<String>) {
    let text = r#"<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g"><CoSimulation modelIdentifier="m"/>
        <UnitDefinitions><Unit name="rad/s"><BaseUnit rad="1" s="-1"/></Unit></UnitDefinitions><ModelVariables>
        <ScalarVariable name="w" valueReference="0" causality="output" variability="continuous"><Real unit="rad/s"/></ScalarVariable>
        </ModelVariables><ModelStructure/></fmiModelDescription>"#;
    let description = Description::parse(text).expect("a description");
    let mut matched = Match {
        variable: 0,
        column: "w".into(),
        unit: header.map(Into::into),
        affine,
        evidence: Vec::new(),
        fed: false,
        hold: None,
    };
    let mut notices = Vec::new();
    let told =
        Told { description: &description, starts: &[], signs: affine.is_some(), shifted_by: &|_| None };
    judge(&mut matched, line, &told, &mut notices);
    (matched, notices)
}

/// A line through the origin.
fn straight(slope: f64) -> Line {
    Line { slope, offset: 0.0, correlation: 0.99, spread: 1.0, mean: (0.0, 0.0), begun: true }
}

#[test]
fn value_a_slope_that_a_power_of_ten_explains_better_is_no_unit() {
    // revolutions per minute are 9.549 times as many
    for (slope, unit) in
        [(9.55, Some("rpm")), (8.4, Some("rpm")), (57.0, Some("deg/s")), (10.0, None), (1.2, None)]
    {
        let (matched, notices) = judged_in(straight(slope), None, None);
        assert_eq!(matched.unit.as_deref(), unit, "{slope}: {:?}", matched.evidence);
        let told = notices.iter().any(|told| told.contains("in rpm, or 10 times as large"));
        assert_eq!(told, slope == 10.0, "{notices:?}");
    }
}

#[test]
fn value_a_unit_by_trial_keeps_a_sign_that_is_turned() {
    let turned = Affine { scale: -1.0, offset: 0.0 };
    let (matched, _) = judged_in(straight(9.55), None, Some(turned));
    // a minute's revolutions, the other way round; a rounding of a product
    let scale = matched.affine.expect("both").scale;
    assert!((scale * 60.0 / std::f64::consts::TAU + 1.0).abs() < 1e-15, "{scale}");
}

#[test]
fn value_a_header_that_the_slope_contradicts_is_told() {
    // 1 rad under a header that says degrees counts as 0.017
    let (matched, notices) = judged_in(straight(1f64.to_radians()), Some("deg/s"), None);
    assert_eq!(
        (matched.unit.as_deref(), matched.affine),
        (Some("deg/s"), None),
        "nothing is changed by guess"
    );
    assert!(
        notices.iter().any(|told| told.contains("header says deg/s") && told.contains("unit = \"rad/s\"")),
        "{notices:?}"
    );
    // a slope that only comes near a unit's is told as what it is: 4.4 is pounds-force of an input as well as anything
    for (times, is_told) in [(1.03, true), (1.1, false), (1.2, false)] {
        let (matched, notices) = judged_in(straight(times * 1f64.to_radians()), Some("deg/s"), None);
        let told = (notices.join(" "), matched.evidence.join(" "));
        assert_eq!(told.0.contains("what the model says in rad/s"), is_told, "{times}: {told:?}");
        assert_eq!(
            told.0.contains("which no usual unit of measurement explains"),
            !is_told,
            "{times}: {told:?}"
        );
    }
    // without a header the nearest is taken still, and told with how far it is
    let (matched, notices) = judged_in(straight(8.4), None, None);
    assert!(matched.evidence.join(" ").contains("in rpm, by trial"), "{:?}", matched.evidence);
    assert!(
        notices.join(" ").contains("numbers in rpm, the nearest usual unit, would be 0.88 times"),
        "{notices:?}"
    );
    assert_eq!(judged_in(straight(9.4), None, None).1, [""; 0]);
    // and what fits as it says is not; a gain that a fault makes isn't a unit, either
    for slope in [1.0, 0.8, 1.25, 3.0] {
        assert_eq!(judged_in(straight(slope), Some("deg/s"), None).1, [""; 0], "{slope}");
    }
}

#[test]
fn value_a_slope_is_told_with_few_digits() {
    assert_eq!([0.907, -1.0, 1e5].map(judge::in_short), ["0.907", "-1.000", "100000.000"]);
    assert_eq!(judge::in_short(-2.793e300), "-2.79e300");
}

fn told(correlation: f64, apart: f64) -> (String, Option<Affine>) {
    let mean = (10.0, 10.0 + apart);
    judged(Line { slope: 1.0, offset: apart, correlation, spread: 1.0, mean, begun: true })
}

#[test]
fn value_a_correlation_that_says_nothing_of_sign_and_unit() {
    // a third of a course's square is what noise, a drift and another start leave of a right model: 0.6 squared
    assert!(told(0.54, 0.0).0.contains("says nothing"), "{:?}", told(0.54, 0.0));
    assert!(told(0.66, 0.0).0.contains("fit"), "{:?}", told(0.66, 0.0));
}

#[test]
fn value_an_offset_that_no_fault_of_the_model_is_taken_for() {
    // in deviations of the course, of which chance gives 4.5 once in 150 000
    assert_eq!(told(0.95, 4.0).1, None);
    let (why, affine) = told(0.95, 5.0);
    assert!(why.contains("offset taken out"), "{why}");
    // to the rounding of sums of tens
    assert!(affine.is_some_and(|affine| (affine.offset + 5.0).abs() < 1e-12 && affine.scale == 1.0));
}

#[test]
fn value_an_offset_that_a_start_explains_as_well_is_left_in() {
    let text = r#"<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g"><CoSimulation modelIdentifier="m"/><ModelVariables>
        <ScalarVariable name="s" valueReference="0" causality="output" variability="continuous"><Real/></ScalarVariable>
        </ModelVariables><ModelStructure/></fmiModelDescription>"#;
    let description = Description::parse(text).expect("a description");
    let judged = |slope: f64, start: Option<&str>| {
        let mut matched = Match {
            variable: 0,
            column: "s".into(),
            unit: None,
            affine: None,
            evidence: Vec::new(),
            fed: false,
            hold: None,
        };
        let shifted_by = |_: &Match| start.map(str::to_owned);
        let told = Told { description: &description, starts: &[], signs: false, shifted_by: &shifted_by };
        let line = Line { mean: (2.0, 8.0), correlation: 0.99 * slope, ..straight(slope) };
        judge(&mut matched, line, &told, &mut Vec::new());
        (matched.affine.map(|affine| (affine.scale, affine.offset)), matched.evidence.join("; "))
    };
    let (affine, why) = judged(1.0, Some("s_0"));
    assert_eq!(affine, None);
    assert!(why.contains("apart by 6.0000") && why.contains("s_0") && why.contains("size fit"), "{why}");
    assert_eq!(judged(1.0, None).0, Some((1.0, -6.0)));
    // a sign is turned whatever moves the course
    assert_eq!(judged(-1.0, Some("s_0")).0, Some((-1.0, 0.0)));
    assert_eq!(judged(-1.0, None).0, Some((-1.0, 10.0)));
}
