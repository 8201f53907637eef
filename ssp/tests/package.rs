//! Packages of all sorts: what they mean and why they are refused. The units are the packed ones.

mod common;

use common::{FORWARD, Package, component, real, two, values};
use orchestrator::package::pack;
use orchestrator::{Scenario, Simulation, UnitPath};

fn table(kind: &str, source: &str, target: &str) -> String {
    format!(
        "<ssc:{kind}MappingTransformation><ssc:MapEntry source=\"{source}\" target=\"{target}\"/></ssc:{kind}MappingTransformation>"
    )
}

#[test]
fn law_a_connection_may_be_written_backwards() {
    let backward = r#"<ssd:Connection startElement="b" startConnector="u" endElement="a" endConnector="y"/>"#;
    for (version, connection) in [("1.0", FORWARD), ("2.0", FORWARD), ("1.0", backward)] {
        assert_eq!(Package::new(version, &two(["", ""], connection)).last("b.u"), 5.0);
    }
}

#[test]
fn value_units_and_linear_transformations() {
    let linear = |suppress: &str| {
        format!(
            r#"<ssd:Connection startElement="a" startConnector="y" endElement="b" endConnector="u"{suppress}>
            <ssc:LinearTransformation factor="2" offset="3"/></ssd:Connection>"#
        )
    };
    let suppressed = FORWARD.replace("/>", " suppressUnitConversion=\"true\"/>");
    for (units, connection, expected) in [
        (["m", "mm"], FORWARD.to_owned(), 5000.0),
        (["degC", "K"], FORWARD.to_owned(), 278.15),
        (["m", "mm"], suppressed, 5.0),
        (["m", "m"], linear(""), 13.0),
        // The unit first, then the transformation.
        (["m", "mm"], linear(""), 10003.0),
        (["m", "mm"], linear(" suppressUnitConversion=\"1\""), 13.0),
    ] {
        assert_eq!(
            Package::new("1.0", &two(units, &connection)).last("b.u"),
            expected,
            "{units:?} {connection}"
        );
    }
}

#[test]
fn law_values_pass_through_systems_within_systems_and_dictionaries() {
    let inner = format!(
        r#"<ssd:System name="inner"><ssd:Connectors>
        <ssd:Connector name="u" kind="input"><ssc:Real unit="mm"/></ssd:Connector>
        <ssd:Connector name="y" kind="output"><ssc:Real unit="m"/></ssd:Connector>
        <ssd:Connector name="p" kind="parameter"><ssc:Real/></ssd:Connector></ssd:Connectors>
        <ssd:Elements>{}</ssd:Elements><ssd:Connections>
        <ssd:Connection startConnector="u" endElement="b" endConnector="u"/>
        <ssd:Connection startConnector="p" endElement="b" endConnector="bias"/>
        <ssd:Connection startConnector="y" endElement="b" endConnector="y"/></ssd:Connections></ssd:System>"#,
        component("b", ["m", "m"], &values(&real("bias", "100")))
    );
    let bus = |name: &str| {
        format!(
            r#"<ssd:SignalDictionaryReference name="{name}" dictionary="bus"><ssd:Connectors>
            <ssd:Connector name="x" kind="inout"><ssc:Real/></ssd:Connector></ssd:Connectors></ssd:SignalDictionaryReference>"#
        )
    };
    let system = format!(
        r#"{}<ssd:Elements>{}{inner}{}{}{}</ssd:Elements><ssd:Connections>
        <ssd:Connection startElement="a" startConnector="y" endElement="inner" endConnector="u"/>
        <ssd:Connection startElement="inner" startConnector="y" endElement="left" endConnector="x"/>
        <ssd:Connection startElement="right" startConnector="x" endElement="c" endConnector="u"/></ssd:Connections>
        <ssd:SignalDictionaries><ssd:SignalDictionary name="bus"/></ssd:SignalDictionaries>"#,
        values(&format!("{}{}", real("inner.p", "0.25"), real("a.bias", "7"))),
        component("a", ["", "m"], &values(&real("bias", "1"))),
        bus("left"),
        bus("right"),
        component("c", ["mm", ""], ""),
    );
    let package = Package::new("1.0", &system);
    // The outer binding counts: 7 m through the system's connector in mm, 0.25 m more, and on in mm.
    assert_eq!(package.last("inner/b.u"), 7.0);
    assert_eq!(package.last("c.u"), 7250.0);
}

#[test]
fn value_parameters_from_files_with_mappings_and_prefixes() {
    let set = |parameters: &str| {
        format!(
            r#"<ssv:ParameterSet xmlns:ssv="v" xmlns:ssc="c" version="2.0" name="p"><ssv:Parameters>{parameters}</ssv:Parameters>
            <ssv:Units><ssc:Unit name="cm"><ssc:BaseUnit m="1" factor="0.01"/></ssc:Unit></ssv:Units></ssv:ParameterSet>"#
        )
    };
    let mapping = r#"<ssm:ParameterMapping xmlns:ssm="m" xmlns:ssc="c" version="1.0">
        <ssm:MappingEntry source="a.offset" target="a.bias"><ssc:LinearTransformation factor="10" offset="1"/></ssm:MappingEntry>
        <ssm:MappingEntry source="a.offset" target="b.bias"/></ssm:ParameterMapping>"#;
    let system = format!(
        r#"<ssd:ParameterBindings><ssd:ParameterBinding source="resources/a%20set.ssv" prefix="a.">
        <ssd:ParameterMapping source="resources/map.ssm"/></ssd:ParameterBinding></ssd:ParameterBindings>{}"#,
        two(["", ""], FORWARD)
    );
    let parameters = r#"<ssv:Parameter name="offset"><ssv:Float64 value="3"/></ssv:Parameter>
        <ssv:Parameter name="nobody"><ssv:Boolean value="true"/></ssv:Parameter>"#;
    let package = Package::new("2.0", &system)
        .with("resources/a set.ssv", &set(parameters))
        .with("resources/map.ssm", mapping);
    assert_eq!(package.last("a.bias"), 31.0);
    assert_eq!(package.last("b.bias"), 3.0);
    // A unit of the set is converted to that of the connector.
    let cm = r#"<ssv:Parameter name="u"><ssv:Real value="250" unit="cm"/></ssv:Parameter>
        <ssv:Parameter name="nobody"><ssv:Real value="1"/></ssv:Parameter>"#;
    let bound =
        r#"<ssd:ParameterBindings><ssd:ParameterBinding source="resources/s.ssv"/></ssd:ParameterBindings>"#;
    let system = format!("<ssd:Elements>{}</ssd:Elements>", component("a", ["mm", ""], bound));
    let package = Package::new("1.0", &system).with("resources/s.ssv", &set(cm));
    assert_eq!(package.last("a.u"), 2500.0);
    let simulation = Simulation::new(&package.read(), &UnitPath::new()).expect("builds");
    let notes = simulation.notices().join("\n");
    assert!(notes.contains("1 of 2 parameters name nothing") && notes.contains("nobody"), "{notes}");
}

#[test]
fn law_packages_and_documents_lie_in_packages() {
    let inner = Package::new("1.0", &two(["", ""], FORWARD));
    let nested = |kind: &str, source: &str| {
        format!(
            r#"<ssd:Elements><ssd:Component name="sub" type="application/x-ssp-{kind}" source="{source}">{}</ssd:Component></ssd:Elements>"#,
            values(&real("a.bias", "8"))
        )
    };
    let package = Package::new("1.0", &nested("definition", "sub/other.ssd"));
    let text = String::from_utf8(inner.files["SystemStructure.ssd"].clone()).expect("text");
    let package = package.with("sub/other.ssd", &text.replace("resources/", "../resources/"));
    assert_eq!(package.last("sub/b.u"), 8.0);
    let mut package = Package::new("1.0", &nested("package", "resources/inner.ssp"));
    package.files.insert("resources/inner.ssp".to_owned(), pack(&inner.files).expect("packed"));
    assert_eq!(package.last("sub/b.u"), 8.0);
    let package = Package::new("1.0", &nested("definition", "SystemStructure.ssd"));
    assert!(package.refused().contains("systems deep"), "{}", package.refused());
}

#[test]
fn law_times_come_from_whoever_says_them() {
    let interval = |scenario: &Scenario| scenario.units[0].interval.to_string();
    let package = Package::new("1.0", &two(["", ""], FORWARD));
    let plain = package.read();
    let hint = r#"<ssd:Annotations><ssc:Annotation type="org.acroscope"><x:AcroscopeUnit xmlns:x="y" interval="1/7"/></ssc:Annotation>
        <ssc:Annotation type="another"><x:AcroscopeUnit xmlns:x="y" interval="1/9"/></ssc:Annotation></ssd:Annotations>"#;
    let own = format!("<ssd:Elements>{}</ssd:Elements>", component("a", ["", ""], hint));
    assert_eq!(interval(&Package::new("1.0", &own).read()), "1/7");
    let master = r#"<ssd:Annotations><ssc:Annotation type="org.openmodelica"><oms:Annotations xmlns:oms="o"><oms:SimulationInformation>
        <oms:FixedStepMaster stepSize="0.002"/></oms:SimulationInformation></oms:Annotations></ssc:Annotation></ssd:Annotations>"#;
    let stepped = Package::new("1.0", &format!("{}{master}", two(["", ""], FORWARD))).read();
    assert_eq!(interval(&stepped), "1/500");
    let simulation = Simulation::new(&plain, &UnitPath::new()).expect("builds");
    let notes = simulation.notices().join("\n");
    assert!(notes.contains("says no communication intervals") && notes.contains("a 1/"), "{notes}");
}

#[test]
fn every_fault_names_document_line_and_element() {
    let connect = |text: &str| Package::new("1.0", &two(["", ""], text)).refused();
    let element = |text: &str| Package::new("1.0", &format!("<ssd:Elements>{text}</ssd:Elements>")).refused();
    let with = |from: &str, to: &str| element(&component("a", ["", ""], "").replace(from, to));
    for (told, parts) in [
        (
            connect(&FORWARD.replace("\"a\"", "\"aa\"")),
            ["SystemStructure.ssd:", "no such element", "did you mean a"],
        ),
        (
            connect(&FORWARD.replace("\"u\"", "\"uu\"")),
            ["has no such connector", "did you mean u", "endConnector"],
        ),
        (connect(&FORWARD.replace("\"u\"", "\"y\"")), ["a.y and b.y", "both give a value", "kind input"]),
        (
            connect(&format!("{FORWARD}{FORWARD}")),
            ["second connection into b.u", "the first one is at", ".ssd:"],
        ),
        (
            connect(&FORWARD.replace("/>", "><ssc:IntegerMappingTransformation/></ssd:Connection>")),
            ["IntegerMappingTransformation", "b.u", "MapEntry"],
        ),
        (
            connect(&FORWARD.replace("/>", &format!(">{}</ssd:Connection>", table("Integer", "1", "2.5")))),
            ["target=\"2.5\"", "IntegerMappingTransformation", "a whole number"],
        ),
        (
            connect(&FORWARD.replace("/>", &format!(">{}</ssd:Connection>", table("Boolean", "yes", "0")))),
            ["source=\"yes\"", "BooleanMappingTransformation", "true or false"],
        ),
        (
            connect(&FORWARD.replace("/>", &format!(">{}</ssd:Connection>", table("Integer", "1", "2")))),
            ["map from a.y (Real) to b.u (Real)", "between Integers", ".ssd:"],
        ),
        (
            Package::new("1.0", &two(["m", "K"], FORWARD)).refused(),
            ["b.u", "a value in m for one in K", "same quantity"],
        ),
        // a name that nobody defines is no reason to pass a number as it is
        (
            Package::new("1.0", &two(["m", "furlong"], FORWARD)).refused(),
            ["b.u", "a value in m for one in furlong", "a Unit furlong among the package's Units"],
        ),
        (
            with("resources/effects.fmu", "resources/effect.fmu"),
            ["test.ssp", "no \"resources/effect.fmu\"", "effects.fmu"],
        ),
        (with("resources/effects.fmu", "../x.fmu"), ["../x.fmu", "leads out of it", ".ssd:"]),
        (with("resources/effects.fmu", "/etc/passwd"), ["/etc/passwd", "nothing outside is opened", ".ssd:"]),
        (
            with("resources/effects.fmu", "file:///etc/passwd"),
            ["file:///etc/passwd", "nothing outside", ".ssd:"],
        ),
        (with("resources/effects.fmu", "http://x.org/x.fmu"), ["http://x.org", "nothing outside", ".ssd:"]),
        (with("resources/effects.fmu", "%2e%2e/x.fmu"), ["%2e%2e", "leads out of it", ".ssd:"]),
        (
            with(" source=\"resources/effects.fmu\"", ""),
            ["component a without source", "resources/UNIT.fmu", ".ssd:"],
        ),
        (
            with("source=", "type=\"text/plain\" source="),
            ["type \"text/plain\"", "application/x-ssp-package", ".ssd:"],
        ),
        (with("source=", "implementation=\"Analog\" source="), ["Analog", "CoSimulation", "component a"]),
        (with("kind=\"input\"", "kind=\"imput\""), ["kind=\"imput\"", "did you mean input", "connector u"]),
        (
            element(&component("a", ["", ""], &values(&real("bias", "x")))),
            ["bias = \"x\"", "a finite number", ".ssd:"],
        ),
        (
            element(&component("a", ["", ""], &values(&real("y", "1")))),
            ["a.y", "computed by the unit", ".ssd:"],
        ),
        (
            element(&component("a", ["", ""], &values(&real("bias", "1 2")))),
            ["bias", "an array", "one value"],
        ),
        (Package::new("3.0", "").refused(), ["version=\"3.0\"", "1.0 and 2.0", ".ssd:"]),
        (
            Package::new("1.0", "").with("SystemStructure.ssd", "<a><b></a>").refused(),
            ["SystemStructure.ssd:1", "b", "a"],
        ),
    ] {
        for part in parts {
            assert!(told.contains(part), "{told}\nlacks {part}");
        }
    }
    let mut empty = Package::new("1.0", "");
    empty.files.remove("SystemStructure.ssd");
    assert!(empty.refused().contains("it holds no \"SystemStructure.ssd\""), "{}", empty.refused());
}

#[test]
fn law_a_name_with_a_number_sign_goes_into_a_package_and_out_again() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("a#1.fmu"), common::unit("signal_effects.fmu")).expect("writable");
    let text =
        "format = 1\nexperiment = { stop = 1 }\n[[units]]\nname = \"a\"\nfmu = \"a#1.fmu\"\ninterval = 0.5\n";
    let scenario = Scenario::parse(text, folder.path().join("s.toml")).expect("a scenario");
    let package = folder.path().join("s.ssp");
    let simulation = Simulation::new(&scenario, &UnitPath::new()).expect("builds");
    std::fs::write(&package, ssp::write(&simulation).expect("packed")).expect("writable");
    let read = ssp::read(&package).expect("read");
    Simulation::new(&read, &UnitPath::new()).expect("builds");
}

#[test]
fn bad_input_documents_that_double_each_other_have_an_end() {
    let system = |next: &str| {
        let one = |name: &str| {
            format!(
                "<ssd:Component name=\"{name}\" type=\"application/x-ssp-definition\" source=\"{next}\"/>"
            )
        };
        format!("<ssd:System name=\"s\"><ssd:Elements>{}{}</ssd:Elements></ssd:System>", one("a"), one("b"))
    };
    let document = |next: &str| {
        format!("{}{}</ssd:SystemStructureDescription>", common::HEAD.replace("VERSION", "1.0"), system(next))
    };
    let mut files = std::collections::BTreeMap::new();
    files.insert("SystemStructure.ssd".to_owned(), document("resources/0.ssd").into_bytes());
    // 2²⁹ elements, 30 deep.
    for k in 0..28 {
        files.insert(format!("resources/{k}.ssd"), document(&format!("{}.ssd", k + 1)).into_bytes());
    }
    let last = document("").replace(&system(""), "<ssd:System name=\"s\"/>");
    files.insert("resources/28.ssd".to_owned(), last.into_bytes());
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("doubles.ssp");
    std::fs::write(&path, pack(&files).expect("a package")).expect("writable");
    let told = ssp::read(&path).expect_err("no end").to_string();
    assert!(told.contains("is one of more than 65536"), "{told}");
}
