//! Units by their names, and what converts to what.

use super::*;

#[test]
fn value_units_by_name() {
    // SI brochure (9th ed.); psi and lbf from NIST SP 811
    for (name, exponents, factor) in [
        ("N.m", [1, 2, -2, 0, 0, 0, 0, 0], 1.0),
        ("mN·m", [1, 2, -2, 0, 0, 0, 0, 0], 1e-3),
        ("km/h", [0, 1, -1, 0, 0, 0, 0, 0], 1.0 / 3.6),
        ("rpm", [0, 0, -1, 0, 0, 0, 0, 1], 0.104_719_755_119_659_77),
        ("deg/s", [0, 0, -1, 0, 0, 0, 0, 1], 0.017_453_292_519_943_295),
        ("W/(m2.K)", [1, 0, -3, 0, -1, 0, 0, 0], 1.0),
        ("kg.m2", [1, 2, 0, 0, 0, 0, 0, 0], 1.0),
        ("1/s", [0, 0, -1, 0, 0, 0, 0, 0], 1.0),
        ("s-1", [0, 0, -1, 0, 0, 0, 0, 0], 1.0),
        ("mΩ", [1, 2, -3, -2, 0, 0, 0, 0], 1e-3),
        ("mAh", [0, 0, 1, 1, 0, 0, 0, 0], 3.6),
        ("psi", [1, -1, -2, 0, 0, 0, 0, 0], 6_894.757_293_168),
        ("min", [0, 0, 1, 0, 0, 0, 0, 0], 60.0),
        ("cm", [0, 1, 0, 0, 0, 0, 0, 0], 1e-2),
        ("%", [0; 8], 1e-2),
        // as people write them
        ("°/s", [0, 0, -1, 0, 0, 0, 0, 1], 0.017_453_292_519_943_295),
        ("º/sec", [0, 0, -1, 0, 0, 0, 0, 1], 0.017_453_292_519_943_295),
        ("rad / s", [0, 0, -1, 0, 0, 0, 0, 1], 1.0),
        ("rad·s⁻¹", [0, 0, -1, 0, 0, 0, 0, 1], 1.0),
        ("m/sec^2", [0, 1, -2, 0, 0, 0, 0, 0], 1.0),
        ("Nm/rad", [1, 2, -2, 0, 0, 0, 0, -1], 1.0),
        ("kNm", [1, 2, -2, 0, 0, 0, 0, 0], 1e3),
        ("MNm", [1, 2, -2, 0, 0, 0, 0, 0], 1e6),
        ("Ncm", [1, 2, -2, 0, 0, 0, 0, 0], 1e-2),
        ("uNm", [1, 2, -2, 0, 0, 0, 0, 0], 1e-6),
        ("µNm", [1, 2, -2, 0, 0, 0, 0, 0], 1e-6),
        ("dNm", [1, 2, -2, 0, 0, 0, 0, 0], 1e-1),
        ("cNm", [1, 2, -2, 0, 0, 0, 0, 0], 1e-2),
        ("Nmm", [1, 2, -2, 0, 0, 0, 0, 0], 1e-3),
        ("kNm/deg", [1, 2, -2, 0, 0, 0, 0, -1], 1e3 * 180.0 / std::f64::consts::PI),
        ("mNm.s", [1, 2, -1, 0, 0, 0, 0, 0], 1e-3),
        ("L/min", [0, 3, -1, 0, 0, 0, 0, 0], 1e-3 / 60.0),
    ] {
        let unit = named(&name.replace("mΩ", "mOhm")).unwrap_or_else(|| panic!("{name}"));
        assert_eq!(unit.exponents, exponents, "{name}");
        // two or three roundings of products
        assert!((unit.factor / factor - 1.0).abs() < 4.0 * f64::EPSILON, "{name}: {}", unit.factor);
    }
    for unknown in
        ["", "N.", "flux", "m/", "N.(m", "degC/s", "°C/s", "mps2", "Nm2", "Nm-1", "kNx", "Nmol", "Nin"]
    {
        assert_eq!(named(unknown), None, "{unknown}");
    }
}

#[test]
fn value_g_is_a_gram_of_a_mass_and_a_standard_gravity_of_an_acceleration() {
    let text = r#"<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g"><CoSimulation modelIdentifier="m"/>
        <UnitDefinitions><Unit name="kg"><BaseUnit kg="1"/></Unit><Unit name="m/s2"><BaseUnit m="1" s="-2"/></Unit></UnitDefinitions>
        <ModelVariables><ScalarVariable name="load" valueReference="0" causality="output"><Real unit="kg"/></ScalarVariable>
        <ScalarVariable name="acc" valueReference="1" causality="output"><Real unit="m/s2"/></ScalarVariable></ModelVariables>
        <ModelStructure/></fmiModelDescription>"#;
    let description = Description::parse(text).expect("a description");
    let of = |unit: &str, place: usize| conversion(unit, &description.variables[place], &description);
    let scale = |unit: &str, place: usize| of(unit, place).map(|affine| affine.scale).expect("converts");
    assert_eq!((scale("g", 0), scale("g", 1), scale("mg", 0)), (1e-3, 9.80665, 1e-6));
    assert_eq!(scale("mg", 1), 9.80665e-3);
    assert!(of("kg", 1).is_err() && of("s", 1).is_err() && of("N", 0).is_err());
}

#[test]
fn value_which_units_are_of_other_quantities() {
    let text = |one: &str, other: &str| {
        format!(
            r#"<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g"><CoSimulation modelIdentifier="m"/><ModelVariables>
            <ScalarVariable name="a" valueReference="0" causality="output"><Real unit="{one}"/></ScalarVariable>
            <ScalarVariable name="b" valueReference="1" causality="output"><Real unit="{other}"/></ScalarVariable></ModelVariables>
            <ModelStructure/></fmiModelDescription>"#
        )
    };
    let alike = [("rad", "deg"), ("rad/s", "1/s"), ("K", "degC"), ("1", "V"), ("", "V"), ("furlong", "V")];
    let all = alike.map(|(one, other)| (one, other, false));
    for (one, other, unlike) in all.into_iter().chain([("rad", "rad/s", true), ("m", "rad", true)]) {
        let description = Description::parse(&text(one, other)).expect("a description");
        let of = |place: usize| (&description.variables[place], &description);
        assert_eq!(are_unlike(of(0), of(1)), unlike, "{one} {other}");
    }
}

#[test]
fn value_temperatures_have_their_offsets() {
    let celsius = named("°C").expect("known");
    assert_eq!((celsius.factor, celsius.offset), (1.0, 273.15));
    let fahrenheit = named("degF").expect("known");
    // 212 °F = 373.15 K; a rounding of 373
    assert!((fahrenheit.factor * 212.0 + fahrenheit.offset - 373.15).abs() < 1e-12);
}
