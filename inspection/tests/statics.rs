//! Rules that read: each planted fault is found, and the description without one has none.

mod common;

use common::{DESCRIPTION, Units, check};
use inspection::Severity::{self, Error, Note, Warning};

/// What is replaced in the description, by what, and what is then found: rule, severity, variable.
type Planted = (&'static str, &'static str, &'static str, Severity, Option<&'static str>);

const PLANTED: &[Planted] = &[
    ("<DefaultExperiment", "<DefaultExperimet/><DefaultExperiment", "schema", Error, None),
    ("guid=\"{fault-0}\"", "", "schema", Error, None),
    ("fmiVersion=\"2.0\"", "fmiVersion=\"3.0\"", "schema", Error, None),
    ("valueReference=\"3\"", "valueReference=\"-3\"", "schema", Error, None),
    ("causality=\"input\"", "causality=\"in\"", "schema", Error, None),
    ("12:00:00Z", "noon", "schema", Error, None),
    ("dependenciesKind=\"dependent\"", "dependenciesKind=\"much\"", "schema", Error, None),
    ("<Real/>", "<Real/><Integer/>", "schema", Error, None),
    ("<LogCategories>", "<ModelStructure/><LogCategories>", "schema", Error, None),
    ("  </ModelVariables>", "", "well-formed", Error, None),
    // what readers that go by the letter refuse
    ("</fmiModelDescription>", "</fmiModelDescription>more", "well-formed", Error, None),
    ("<fmiModelDescription", "more<fmiModelDescription", "well-formed", Error, None),
    ("fmiVersion=\"2.0\"", "author=\"a<b\" fmiVersion=\"2.0\"", "well-formed", Error, None),
    ("fmiVersion=\"2.0\"", "author=\"\u{1}\" fmiVersion=\"2.0\"", "well-formed", Error, None),
    ("fmiVersion=\"2.0\"", "none:author=\"a\" fmiVersion=\"2.0\"", "well-formed", Error, None),
    ("<LogCategories>", "<!-- a -- b --><LogCategories>", "well-formed", Error, None),
    ("guid=\"{fault-0}\"", "guid=\"\"", "identity", Error, None),
    ("modelIdentifier=\"unit\"", "modelIdentifier=\"../unit\"", "identity", Error, None),
    ("canGetAndSetFMUstate=\"true\"", "", "capabilities", Error, None),
    ("stopTime=\"2\"", "stopTime=\"0\"", "default-experiment", Error, None),
    ("stepSize=\"0.01\"", "stepSize=\"0\"", "default-experiment", Error, None),
    ("stepSize=\"0.01\"", "stepSize=\"3\"", "default-experiment", Warning, None),
    ("name=\"d\"", "name=\"y\"", "variable-names", Error, Some("y")),
    ("name=\"d\"", "name=\"\"", "variable-names", Error, Some("")),
    ("name=\"d\"", "name=\"d&#10;e\"", "variable-names", Error, Some("d\ne")),
    ("name=\"d\"", "name=\"d e\"", "structured-names", Error, Some("d e")),
    ("<Unit name=\"m/s\">", "<Unit name=\"m\">", "unique-names", Error, None),
    ("name=\"fast\"", "name=\"slow\"", "unique-names", Error, None),
    ("value=\"2\"", "value=\"1\"", "unique-names", Error, None),
    ("unit=\"m/s\"", "unit=\"furlong\"", "units", Error, Some("u")),
    ("unit=\"m/s\"", "unit=\"m\" displayUnit=\"cm\"", "units", Error, Some("u")),
    ("displayUnit=\"mm\"", "displayUnit=\"cm\"", "units", Error, None),
    ("unit=\"m/s\"", "displayUnit=\"m\"", "units", Error, Some("u")),
    ("factor=\"1000\"", "factor=\"0\"", "unit-definitions", Error, None),
    ("declaredType=\"Place\"/>", "declaredType=\"Plaice\"/>", "types", Error, Some("y")),
    ("declaredType=\"Place\"/>", "declaredType=\"Mode\"/>", "types", Error, Some("y")),
    ("min=\"0\" max=\"9\"", "min=\"9\" max=\"0\"", "min-max", Error, Some("n")),
    ("min=\"-1e6\"", "min=\"2e6\"", "min-max", Error, None),
    ("start=\"0\" min=\"0\"", "start=\"-1\" min=\"0\"", "start-range", Error, Some("n")),
    ("start=\"0.5\"", "start=\"1e7\"", "start-range", Error, Some("x0")),
    (
        "<Integer start=\"0\" min=\"0\" max=\"9\"/>",
        "<Enumeration declaredType=\"Mode\" start=\"3\"/>",
        "start-range",
        Error,
        Some("n"),
    ),
    ("<Real start=\"1\"", "<Real", "start-missing", Error, Some("u")),
    ("<Real start=\"2\"/>", "<Real/>", "start-missing", Error, Some("k")),
    ("<Real/>", "<Real start=\"0\"/>", "start-superfluous", Error, Some("d")),
    ("<Real start=\"2\"/>", "<Real start=\"2\" nominal=\"0\"/>", "nominal", Warning, Some("k")),
    (
        "causality=\"parameter\" variability=\"fixed\"><Real start=\"2\"",
        "causality=\"parameter\"><Real start=\"2\"",
        "causality-variability",
        Error,
        Some("k"),
    ),
    (
        "variability=\"discrete\"><Integer/>",
        "variability=\"continuous\"><Integer/>",
        "causality-variability",
        Error,
        Some("c"),
    ),
    ("causality=\"input\"><Real", "causality=\"input\" initial=\"exact\"><Real", "initial", Error, Some("u")),
    (
        "causality=\"parameter\" variability=\"fixed\"><Real start=\"2\"",
        "causality=\"parameter\" variability=\"fixed\" initial=\"approx\"><Real start=\"2\"",
        "initial",
        Error,
        Some("k"),
    ),
    (
        "name=\"n\" valueReference=\"0\" causality=\"input\" variability=\"discrete\"><Integer start=\"0\" min=\"0\" max=\"9\"/>",
        "name=\"n\" valueReference=\"0\" causality=\"independent\" variability=\"continuous\"><Integer/>",
        "causality-variability",
        Error,
        Some("n"),
    ),
    (
        "name=\"k\" valueReference=\"3\" causality=\"parameter\" variability=\"fixed\"><Real start=\"2\"/>",
        "name=\"k\" valueReference=\"3\" causality=\"independent\"><Real start=\"2\"/>",
        "start-superfluous",
        Error,
        Some("k"),
    ),
    ("<ModelVariables>", "<ModelVariables>hello", "schema", Error, None),
    ("<ModelVariables>", "<?xml version=\"1.0\"?><ModelVariables>", "well-formed", Error, None),
    ("<Real/>", "<Real derivative=\"99\"/>", "derivative", Error, Some("d")),
    ("<Real/>", "<Real derivative=\"4\"/>", "derivative", Error, Some("k")),
    ("valueReference=\"4\"", "valueReference=\"3\"", "aliases", Error, Some("x0")),
    ("valueReference=\"2\"", "valueReference=\"1\"", "aliases", Error, Some("d")),
    (
        "<Unknown index=\"7\" dependencies=\"6\"/>",
        "<Unknown index=\"70\" dependencies=\"6\"/>",
        "structure-index",
        Error,
        None,
    ),
    ("<Unknown index=\"2\" dependencies=\"\"/>", "", "outputs", Error, Some("y")),
    (
        "<Unknown index=\"2\" dependencies=\"\"/>",
        "<Unknown index=\"2\"/><Unknown index=\"4\"/>",
        "outputs",
        Error,
        Some("k"),
    ),
    (
        "<InitialUnknowns>",
        "<Derivatives><Unknown index=\"2\"/></Derivatives><InitialUnknowns>",
        "derivatives",
        Error,
        Some("y"),
    ),
    ("<Unknown index=\"2\" dependencies=\"5\"/>", "", "initial-unknowns", Error, Some("y")),
    (
        "<Unknown index=\"2\" dependencies=\"5\"/>",
        "<Unknown index=\"2\"/><Unknown index=\"4\"/>",
        "initial-unknowns",
        Error,
        Some("k"),
    ),
    (
        "dependencies=\"1\" dependenciesKind",
        "dependencies=\"1 6\" dependenciesKind",
        "dependencies-list",
        Error,
        Some("d"),
    ),
    ("dependencies=\"1\" dependenciesKind", "dependenciesKind", "dependencies-list", Error, Some("d")),
    ("dependencies=\"1 4 5\"", "dependencies=\"1 4 4\"", "dependencies-list", Error, Some("d")),
    (
        "<DefaultExperiment startTime=\"0\" stopTime=\"2\" stepSize=\"0.01\"/>",
        "",
        "default-experiment",
        Note,
        None,
    ),
];

/// Nobody's library: nothing is run.
const ELSEWHERE: &[(&str, &[u8])] = &[("sources/unit.c", b"")];

#[test]
fn every_planted_fault_of_a_description_is_found() {
    let units = Units::new();
    for (number, (good, bad, rule, severity, variable)) in PLANTED.iter().enumerate() {
        assert!(DESCRIPTION.contains(good), "{good}");
        let text = DESCRIPTION.replacen(good, bad, 1);
        let path = units.pack_files(&format!("{number}.fmu"), &text, ELSEWHERE);
        let findings = check(&path);
        let found = findings.iter().any(|finding| {
            finding.rule == *rule && finding.severity == *severity && finding.variable.as_deref() == *variable
        });
        assert!(found, "{good} -> {bad}: wanted is {rule}, found {findings:#?}");
    }
}

#[test]
fn law_a_description_without_a_fault_has_no_finding() {
    let units = Units::new();
    let findings = check(&units.pack_files("good.fmu", DESCRIPTION, ELSEWHERE));
    assert_eq!(common::short(&findings), [("binaries", Note, None)], "{findings:#?}");
}

#[test]
fn law_both_kinds_in_one_archive_are_legal_and_a_list_left_out_is_a_warning() {
    let units = Units::new();
    let both = DESCRIPTION.replace("<CoSimulation", "<ModelExchange modelIdentifier=\"unit\"/><CoSimulation");
    let findings = check(&units.pack_files("both.fmu", &both, ELSEWHERE));
    assert_eq!(common::short(&findings), [("binaries", Note, None)], "{findings:#?}");
    let (before, rest) = DESCRIPTION.split_once("<InitialUnknowns>").expect("there");
    let (_, after) = rest.split_once("</InitialUnknowns>").expect("there");
    let findings = check(&units.pack_files("none.fmu", &format!("{before}{after}"), ELSEWHERE));
    let expected = [("binaries", Note, None), ("initial-unknowns", Warning, None)];
    assert_eq!(common::short(&findings), expected, "{findings:#?}");
}

#[test]
fn every_finding_of_a_description_says_its_line() {
    let text = DESCRIPTION.replace("min=\"0\" max=\"9\"", "min=\"9\" max=\"0\"");
    let line = text.lines().position(|line| line.contains("min=\"9\"")).expect("there") + 1;
    let units = Units::new();
    let findings = check(&units.pack_files("lines.fmu", &text, ELSEWHERE));
    let finding = findings.iter().find(|finding| finding.rule == "min-max").expect("found");
    assert_eq!(finding.text, format!("modelDescription.xml:{line}: min 9 is above max 0"));
}

/// Files beside the description, and what is then found: rule, severity, a part of the text.
type Case<'a> = (&'a [(&'a str, &'a [u8])], &'static str, Severity, &'static str);

#[test]
fn every_planted_fault_of_an_archive_is_found() {
    let units = Units::new();
    let library = common::library();
    let so = library.as_slice();
    let cases: &[Case<'_>] = &[
        (&[], "binaries", Error, "neither binaries/PLATFORM"),
        (&[("binaries/linux64/other.so", so)], "binaries", Error, "no library unit"),
        (&[("binaries/win64/unit.so", so)], "binaries", Error, "another ending than .dll"),
        (&[("binaries/linux32/unit.so", so)], "binaries", Error, "binaries/linux32/unit.so is for "),
        (&[("binaries/win64/unit.dll", b"no library")], "binary-functions", Error, "is no shared library"),
        (&[("sources/x.c", b""), ("Resources/a", b"")], "archive-layout", Error, "must be called resources"),
        (&[("sources/x.c", b""), ("readme.txt", b"")], "archive-layout", Warning, "readme.txt at the root"),
        (
            &[("sources/x.c", b""), ("resources/../../a", b"")],
            "archive-paths",
            Error,
            "leads out of the archive",
        ),
        (&[("sources/x.c", b""), ("/etc/a", b"")], "archive-paths", Error, "leads out of the archive"),
        (&[("sources/x.c", b""), ("resources\\a", b"")], "archive-paths", Error, "has a backslash"),
        (
            &[("sources/x.c", b""), ("resources/a", b""), ("resources/A", b"")],
            "archive-paths",
            Error,
            "is there twice",
        ),
        (&[("binaries/win64/unit.dll", so)], "runs", Note, "none for this machine"),
    ];
    for (files, rule, severity, text) in cases {
        let findings = check(&units.pack_files("case.fmu", DESCRIPTION, files));
        let found = findings.iter().any(|finding| {
            finding.rule == *rule && finding.severity == *severity && finding.text.contains(text)
        });
        assert!(found, "{rule} {text}: {findings:#?}");
    }
    let listed = DESCRIPTION.replace(
        "providesDirectionalDerivative=\"true\"/>",
        "><SourceFiles><File name=\"all.c\"/></SourceFiles></CoSimulation>",
    );
    let findings = check(&units.pack_files("case.fmu", &listed, ELSEWHERE));
    assert!(findings.iter().any(|finding| finding.rule == "source-files"), "{findings:#?}");
}

#[test]
fn every_entry_of_the_same_name_and_every_link_is_found() {
    let units = Units::new();
    let path = units.pack_files("twins.fmu", DESCRIPTION, &[("resources/a1", b""), ("resources/a2", b"")]);
    let mut bytes = std::fs::read(&path).expect("it was made");
    // no writer makes them, so the second name is written over: before its content, and in the list at the end
    while let Some(at) = bytes.windows(12).position(|name| name == b"resources/a2") {
        bytes[at + 11] = b'1';
    }
    std::fs::write(&path, bytes).expect("writable");
    let said =
        |path| check(path).into_iter().filter(|found| found.rule == "archive-paths").collect::<Vec<_>>();
    let found = said(&path);
    assert!(found.len() == 1 && found[0].text.starts_with("1 of its entries"), "{found:#?}");
    let file = std::fs::File::create(&path).expect("writable");
    let mut zip = zip::ZipWriter::new(file);
    zip.add_symlink("resources/passwd", "/etc/passwd", zip::write::SimpleFileOptions::default())
        .expect("it can be packed");
    zip.finish().expect("it can be packed");
    let found = said(&path);
    assert!(
        found.len() == 1 && found[0].text.contains("\"resources/passwd\" is a symbolic link"),
        "{found:#?}"
    );
}

#[test]
fn law_an_encrypted_library_is_there_and_told_by_its_name() {
    let units = Units::new();
    let name = "binaries/linux64/unit.so";
    let path = units.pack_files("encrypted.fmu", DESCRIPTION, &[(name, &common::library())]);
    let mut bytes = std::fs::read(&path).expect("it was made");
    let is_named = |at: &usize| bytes[*at..].starts_with(name.as_bytes());
    let places: Vec<usize> = (0..bytes.len()).filter(is_named).collect();
    // The lowest bit of the flags, in the header before the content and in the list at the end.
    (bytes[places[0] - 24], bytes[places[1] - 38]) = (bytes[places[0] - 24] | 1, bytes[places[1] - 38] | 1);
    std::fs::write(&path, bytes).expect("writable");
    let findings = check(&path);
    let said = format!("{name} can't be read: it is encrypted");
    assert!(findings.iter().any(|found| found.text.contains(&said)), "{findings:#?}");
    assert!(!findings.iter().any(|found| found.text.contains("neither binaries")), "{findings:#?}");
}

#[test]
fn law_what_is_no_archive_is_a_finding_and_what_is_not_there_an_error() {
    let units = Units::new();
    let path = units.path().join("text.fmu");
    std::fs::write(&path, "no archive").expect("writable");
    assert_eq!(common::short(&check(&path)), [("archive", Error, None)]);
    let missing = units.path().join("missing.fmu");
    let error = inspection::check(&missing, &inspection::Limits::default()).expect_err("not there");
    assert!(error.is_input() && error.to_string().contains("missing.fmu"), "{error}");
    // A folder around it all is said to be what is wrong.
    let file = std::fs::File::create(&path).expect("writable");
    let mut zip = zip::ZipWriter::new(file);
    zip.start_file("model/modelDescription.xml", zip::write::SimpleFileOptions::default()).expect("an entry");
    zip.finish().expect("finished");
    let findings = check(&path);
    assert!(findings.iter().any(|finding| finding.text.contains("but in the folder model")), "{findings:#?}");
}

#[test]
fn law_a_rule_that_had_nothing_to_look_at_is_not_among_those_that_found_nothing() {
    common::host();
    let units = Units::new();
    let path = units.path().join("text.fmu");
    std::fs::write(&path, "").expect("writable");
    let limits = inspection::Limits::default();
    let looked = inspection::look(&path, &limits).expect("looked at");
    assert_eq!(looked.rules(), ["archive"]);
    let reasons = looked.reasons();
    assert!(reasons.len() == 1 && reasons[0].0 == "the file is no zip archive", "{reasons:?}");
    assert!(reasons[0].1.contains(&"crash") && reasons[0].1.contains(&"leak"), "{reasons:?}");
    // no end of the description: what it says is not known
    let path = units.pack("cut.fmu", &DESCRIPTION.replace("  </ModelVariables>", ""), &common::library());
    let looked = inspection::look(&path, &limits).expect("looked at");
    assert!(looked.rules().contains(&"well-formed") && !looked.rules().contains(&"outputs"), "{looked:?}");
    let reasons: Vec<&str> = looked.reasons().into_iter().map(|(why, _)| why).collect();
    assert_eq!(reasons, ["the description can't be read to its end", "the unit can't be opened"]);
}

#[test]
fn value_findings_are_sentences_and_have_their_line() {
    let units = Units::new();
    let said = |from: &str, to: &str| {
        let text = DESCRIPTION.replacen(from, to, 1);
        let findings = check(&units.pack("planted.fmu", &text, &common::library()));
        findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    };
    let text = said("causality=\"output\"", "causality=\"ouput\"");
    for sentence in [
        "causality=\"ouput\" in <ScalarVariable> y: there is no such value; did you mean output (or input)?",
        "ModelStructure/Outputs must not list it: it lists every variable with causality=\"output\", and no other",
        "ModelStructure/InitialUnknowns must not list it: it lists every output, calculated parameter, state",
    ] {
        assert!(text.contains(sentence), "{sentence} in {text}");
    }
    let text = said("start=\"2\"", "start=\"2,5\"");
    assert!(text.contains("start=\"2,5\" in <Real>: wanted is a number"), "{text}");
}

/// 20 000 references to a text of a million letters: whoever puts them in handles 20 GB.
#[test]
fn bad_input_entities_are_not_blown_up() {
    let units = Units::new();
    let entity = format!("<!DOCTYPE f [<!ENTITY b \"{}\">]>\n<fmiModelDescription", "a".repeat(1_000_000));
    let all = "<a>&b;</a>".repeat(20_000);
    let tool =
        format!("<VendorAnnotations><Tool name=\"t\">{all}</Tool></VendorAnnotations>\n  <ModelVariables");
    let text =
        DESCRIPTION.replacen("<fmiModelDescription", &entity, 1).replacen("  <ModelVariables", &tool, 1);
    assert!(text.len() > DESCRIPTION.len() + 1_200_000, "both are in it");
    let findings = check(&units.pack("entities.fmu", &text, &[]));
    let told: Vec<_> = findings.iter().filter(|finding| finding.rule == "well-formed").collect();
    assert!(told.len() == 1 && told[0].severity == Warning, "{told:#?}");
    assert!(told[0].text.starts_with("modelDescription.xml:2: a document type definition"), "{}", told[0]);
}

/// The byte of an ü in Latin-1, in the third line.
#[test]
fn value_a_description_in_another_encoding_is_told_with_its_line() {
    let units = Units::new();
    let path = units.path().join("latin.fmu");
    let mut bytes = DESCRIPTION.as_bytes().to_vec();
    let place = DESCRIPTION.find("<CoSimulation").expect("it is there");
    bytes.insert(place, 0xFC);
    let mut zip = zip::ZipWriter::new(std::fs::File::create(&path).expect("writable"));
    zip.start_file("modelDescription.xml", zip::write::SimpleFileOptions::default()).expect("an entry");
    std::io::Write::write_all(&mut zip, &bytes).expect("written");
    zip.finish().expect("finished");
    let findings = check(&path);
    let found = findings.iter().find(|finding| finding.rule == "well-formed").expect("it is told");
    assert!(found.text.starts_with("modelDescription.xml:3: the byte 0xFC is no UTF-8"), "{found}");
    assert!(findings.iter().all(|finding| finding.rule != "archive-layout"), "{findings:#?}");
}

#[test]
fn every_rule_has_its_section() {
    let page = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/check.md");
    let page = std::fs::read_to_string(page).expect("docs/check.md");
    let sections: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("### ")).collect();
    let mut rules = inspection::rules();
    for rule in &rules {
        assert!(sections.contains(rule), "docs/check.md has no section for {rule}");
    }
    rules.sort_unstable();
    let mut sorted = sections.clone();
    sorted.sort_unstable();
    assert_eq!(sorted, rules, "sections of rules that are gone, or twice");
}
