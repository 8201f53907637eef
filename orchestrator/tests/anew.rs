//! Units as some tools make them: values that are set before the experiment are lost, a reset leaves things behind, one instance a process.

use crate::common::{LEAKY, ONLY_ONCE, STATEFUL, Units, described_as_only_once, description, library_with};
use orchestrator::{Fmu, NoRecorder, Quiet, Scenario, Simulation};

/// It begins anew when it is told of the experiment, as units of 20-sim do.
const FORGETS: (&str, &str) = ("    u->set_up = 1;\n", "    start(u);\n    u->set_up = 1;\n");

fn simulation(units: &Units) -> Simulation {
    let text = "format = 1\nexperiment = { stop = 1 }\n[[units]]\nname = \"a\"\nfmu = \"stateful.fmu\"\ninterval = 0.125\n\
                set = { k = 3, x0 = 1 }\n[[sources]]\nto = \"a.u1\"\nkind = \"constant\"\nvalue = 2.0\n";
    let scenario = Scenario::parse(text, "test.toml").expect("a scenario");
    Simulation::new(&scenario, &units.unit_path()).expect("builds")
}

/// It takes values that were set before initialization mode back, as units that were made for libcosim do.
const HEEDS_LATE: (&str, &str) = (
    "    ((Unit *)c)->initialising = 1;\n",
    "    start(c);\n    ((Unit *)c)->set_up = ((Unit *)c)->initialising = 1;\n",
);
/// It refuses to have its parameters set in that mode.
const REFUSES_LATE: (&str, &str) = (
    "        for (size_t i = 0; i < n; i++) ((Unit *)c)->FIELD[refs[i]] = values[i];",
    "        for (size_t i = 0; i < n; i++) { if (((Unit *)c)->initialising && refs[i] == K) return 3; \
     ((Unit *)c)->FIELD[refs[i]] = values[i]; }",
);

/// Where it ends: 1 + 3 · 2.
fn end(simulation: &mut Simulation) -> f64 {
    simulation.run(&mut NoRecorder, &mut Quiet).expect("runs");
    simulation.value("a.y1").expect("known")
}

#[test]
fn law_values_are_set_where_units_keep_them() {
    let units = Units::new();
    assert_eq!(end(&mut simulation(&units)), 7.0);
    units.pack("stateful.fmu", &description(STATEFUL), &library_with(&[FORGETS]));
    assert_eq!(end(&mut simulation(&units)), 7.0, "values set before the experiment are lost");
    units.pack("stateful.fmu", &description(STATEFUL), &library_with(&[HEEDS_LATE]));
    assert_eq!(end(&mut simulation(&units)), 7.0, "values set before initialization mode are lost");
    units.pack("stateful.fmu", &description(STATEFUL), &library_with(&[REFUSES_LATE]));
    let mut refusing = simulation(&units);
    assert_eq!(
        (end(&mut refusing), end(&mut refusing)),
        (7.0, 7.0),
        "values in initialization mode are refused"
    );
}

#[test]
fn law_a_second_run_is_the_first_whatever_a_reset_leaves() {
    let units = Units::new();
    let mut honest = simulation(&units);
    assert!(honest.restores());
    assert_eq!((end(&mut honest), end(&mut honest)), (7.0, 7.0));
    // values that a scenario sets hide what was left; an input's start value does not
    let keeps = (
        "API int fmi2Reset(void *c) { start(c); return 0; }",
        "API int fmi2Reset(void *c) { (void)c; return 0; }",
    );
    for change in [LEAKY, keeps] {
        units.pack("stateful.fmu", &description(STATEFUL), &library_with(&[change]));
        let mut leaky = simulation(&units);
        assert!(!leaky.restores());
        leaky.set("a.k", 3.0).expect("before a run");
        assert_eq!((end(&mut leaky), end(&mut leaky)), (7.0, 7.0));
    }
}

#[test]
fn law_an_instance_that_was_reset_is_fresh() {
    let units = Units::new();
    units.pack("leaky.fmu", &description(STATEFUL), &library_with(&[LEAKY]));
    for (name, restores) in [("stateful.fmu", true), ("leaky.fmu", false)] {
        let fmu = Fmu::open(units.path().join(name)).expect("opens");
        let mut instance = fmu.instantiate("a").expect("instantiates");
        let k = |instance: &mut orchestrator::fmu::Instance| {
            let mut k = [0.0];
            instance.get_real(&[4], &mut k).expect("a parameter");
            k[0]
        };
        instance.set_real(&[4], &[5.0]).expect("before the initialisation");
        instance.setup_experiment(0.0, None).expect("set up");
        instance.enter_initialization().expect("enters");
        instance.exit_initialization().expect("exits");
        instance.reset().expect("anew");
        assert_eq!((fmu.restores(), k(&mut instance)), (restores, 1.0), "{name}");
    }
}

#[test]
fn law_an_instance_is_made_anew_only_where_a_reset_is_not_enough() {
    let units = Units::new();
    let tells = (
        "    start(u);\n    return u;\n",
        "    start(u);\n    callbacks->logger(callbacks->environment, name, 1, \"events\", \"born\");\n    return u;\n",
    );
    units.pack("honest.fmu", &description(STATEFUL), &library_with(&[tells]));
    units.pack("leaky.fmu", &description(STATEFUL), &library_with(&[tells, LEAKY]));
    // A step of status 4 is fatal: nothing of the instance may be called any more, a reset neither.
    for (name, fault, anew) in
        [("honest.fmu", 0, false), ("honest.fmu", 3, false), ("honest.fmu", 4, true), ("leaky.fmu", 0, true)]
    {
        let fmu = Fmu::open(units.path().join(name)).expect("opens");
        let mut instance = fmu.instantiate("a").expect("instantiates");
        instance.set_integer(&[2], &[fault]).expect("fault");
        instance.set_real(&[6], &[0.0]).expect("fault_time");
        instance.setup_experiment(0.0, None).expect("set up");
        instance.enter_initialization().expect("enters");
        instance.exit_initialization().expect("exits");
        instance.do_step(0.0, 0.5, true);
        instance.reset().expect("anew");
        let log: Vec<String> = instance.log().into_iter().map(|line| line.text).collect();
        assert_eq!(log, vec!["born"; usize::from(anew)], "{name}, fault {fault}");
    }
}

#[test]
fn law_a_unit_that_can_live_only_once_is_begun_anew_as_well() {
    let units = Units::new();
    let library = library_with(&[ONLY_ONCE[0], ONLY_ONCE[1], ONLY_ONCE[2], LEAKY]);
    units.pack("stateful.fmu", &described_as_only_once(STATEFUL), &library);
    let mut one = simulation(&units);
    assert_eq!((end(&mut one), end(&mut one), end(&mut one)), (7.0, 7.0, 7.0));
    assert!(!one.restores());
}

#[test]
fn law_a_library_that_bears_one_instance_ever_gets_one() {
    let units = Units::new();
    // as some that free at the second instantiation what the first left in static memory
    let never_again =
        ("    if (type != 1 ||", "    static int born;\n    if (born++) return NULL;\n    if (type != 1 ||");
    units.pack("stateful.fmu", &described_as_only_once(STATEFUL), &library_with(&[never_again, LEAKY]));
    let fmu = Fmu::open(units.path().join("stateful.fmu")).expect("opens");
    for name in ["first", "after it", "and beside it"] {
        let instance = fmu.instantiate(name).unwrap_or_else(|error| panic!("{name}: {error}"));
        let beside = fmu.instantiate("beside").unwrap_or_else(|error| panic!("{name}: {error}"));
        drop((instance, beside));
    }
    let (mut one, mut other) = (simulation(&units), simulation(&units));
    assert_eq!((end(&mut one), end(&mut one), end(&mut other)), (7.0, 7.0, 7.0));
}
