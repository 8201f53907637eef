//! Loops of outputs that depend on each other at once: solved at the start, or named.

use crate::common;

use crate::common::{FEEDTHROUGH, Fixture, Units, build, connection, unit};
use orchestrator::Quiet;

#[test]
fn value_a_loop_that_settles_is_solved_by_going_round() {
    // y = 0.5 u + 1, u = y.
    let parts = [unit("a", "feedthrough.fmu", "mode = 1, k = 0.5, x0 = 1"), connection("a.y1", "a.u1")];
    let mut simulation = build(&Units::new(), &parts).expect("builds");
    // It ends within 1e-10 of itself, so within twice that of the solution.
    assert!((simulation.value("a.y1").expect("known") - 2.0).abs() < 1e-9);
    let told = simulation.notices().pop().expect("told");
    assert!(told.contains("at initialisation: solved in ") && told.ends_with(" iterations"), "{told}");
    // The first round replaces the start value, by what the unit says to it; what follows are steps on the way.
    assert_eq!(simulation.replaced_starts(), ["a.u1 = 0.0 (now 1.0)"]);
    // Where the output does not change with the input a second look is enough, and there is nothing to tell.
    let parts = [unit("a", "feedthrough.fmu", "mode = 1, k = 0, x0 = 1"), connection("a.y1", "a.u1")];
    let mut simulation = build(&Units::new(), &parts).expect("builds");
    assert_eq!(simulation.value("a.u1").expect("known"), 1.0);
    let notices = simulation.notices();
    assert!(!notices.iter().any(|notice| notice.contains("at initialisation")), "{notices:?}");
}

#[test]
fn law_a_long_loop_is_told_in_short() {
    let told = |count: usize| {
        let mut parts: Vec<String> = (0..count)
            .map(|n| unit(&format!("a{n}"), "feedthrough.fmu", "mode = 1, k = 2, x0 = 1"))
            .collect();
        parts
            .extend((0..count).map(|n| connection(&format!("a{n}.y1"), &format!("a{}.u1", (n + 1) % count))));
        build(&Units::new(), &parts).expect("builds").notices().remove(0)
    };
    let short = told(9);
    assert_eq!(short.matches(" -> ").count(), 18, "each input, each output and the first again: {short}");
    let long = told(30);
    // Twenty of 61 names.
    assert_eq!(long.matches(" -> ").count(), 20, "{long}");
    assert!(long.contains(" -> (41 more) -> a0.") || long.contains(" -> (41 more) -> a"), "{long}");
}

#[test]
fn law_a_loop_of_states_is_none_at_the_start() {
    // An integrator begins with x0 whatever drives it, so there is nothing to be solved, and nothing to tell.
    let parts = [
        unit("x", "stateful.fmu", "x0 = 2"),
        unit("v", "stateful.fmu", "k = -1"),
        connection("v.y1", "x.u1"),
        connection("x.y1", "v.u1"),
    ];
    let mut simulation = build(&Units::new(), &parts).expect("builds");
    assert_eq!(simulation.value("v.u1").expect("known"), 2.0);
    assert_eq!(simulation.notices(), Vec::<String>::new());
    assert_eq!(simulation.replaced_starts(), ["v.u1 = 0.0 (now 2.0)"], "that of x stays 0");
}

#[test]
fn law_an_output_of_two_inputs_starts_after_both_in_whatever_order_they_are_written() {
    // `both` needs a gain and the state that the gain needs, too; nothing says which of its inputs comes first.
    let fixtures = Units::new();
    fixtures.add(Fixture { name: "12.fmu", y1_dependencies: "1 2", ..FEEDTHROUGH });
    fixtures.add(Fixture { name: "21.fmu", y1_dependencies: "2 1", ..FEEDTHROUGH });
    let pairs =
        [("gain.y1", "both.u1"), ("state.y1", "both.u2"), ("state.y1", "gain.u1"), ("both.y1", "last.u1")];
    let started = |fmu: &str, names: [&str; 4], pairs: &[(&str, &str)]| {
        let part = |name: &str| match name {
            "both" => unit(name, fmu, "mode = 1, k = 5"),
            "state" => unit(name, "stateful.fmu", "x0 = 2"),
            _ => unit(name, "feedthrough.fmu", "mode = 1, k = 3"),
        };
        let mut parts: Vec<String> = names.into_iter().map(part).collect();
        parts.extend(pairs.iter().map(|(from, to)| connection(from, to)));
        let mut simulation = build(&fixtures, &parts).expect("builds");
        // last: 3 * (5 * (3 * 2)); an input that was set too early keeps what its source said then
        assert_eq!(simulation.value("last.y1").expect("known"), 90.0, "{fmu} {names:?} {pairs:?}");
        assert_eq!(simulation.value("both.y2").expect("known"), 2.0, "{fmu} {names:?} {pairs:?}");
        simulation.replaced_starts().to_vec()
    };
    for fmu in ["12.fmu", "21.fmu"] {
        for names in [["last", "both", "gain", "state"], ["state", "gain", "both", "last"]] {
            for pairs in [pairs, [pairs[3], pairs[1], pairs[2], pairs[0]]] {
                let order = started(fmu, names, &pairs);
                let place = |input: &str| order.iter().position(|told| told.starts_with(input));
                let places = ["gain.u1 =", "both.u1 =", "both.u2 =", "last.u1 ="].map(place);
                let [gain, first, second, last] = places.map(|place| place.expect("its start gave way"));
                assert!(gain < first && first < last && second < last && order.len() == 4, "{order:?}");
                assert_eq!(started(fmu, names, &pairs), order, "again");
            }
        }
    }
}

#[test]
fn value_loops_at_the_start_are_solved_or_named() {
    // a = k (k a + 4) + 1 at the start.
    let parts = |k: f64| {
        let gain = |name, x0| unit(name, "feedthrough.fmu", &format!("mode = 1, k = {k:?}, x0 = {x0}"));
        [gain("a", 1), gain("b", 4), connection("a.y1", "b.u1"), connection("b.y1", "a.u1")]
    };
    let units = Units::new();
    let mut simulation = build(&units, &parts(-0.5)).expect("builds");
    // (1 - k²) a = 4 k + 1; the iteration contracts by 1/4 and ends when a round changes less than 1e-12.
    assert!((simulation.value("a.y1").expect("solved") - -1.0 / 0.75).abs() < 1e-12);
    let path = "a.u1 -> a.y1 -> b.u1 -> b.y1 -> a.u1";
    let notices = simulation.notices();
    assert!(
        notices[0].starts_with(&format!("algebraic loop {path}: while stepping it is cut")),
        "{notices:?}"
    );
    assert!(
        notices.iter().any(|n| n.contains(path) && n.contains("at initialisation: solved in")),
        "{notices:?}"
    );

    // Iterating diverges here, by a factor of four a round, and there converges by 0.81 only: Newton's method.
    for k in [-2.0, 0.9] {
        let mut simulation = build(&units, &parts(k)).expect("builds");
        let solution = (4.0 * k + 1.0) / (1.0 - k * k);
        // The residual of 1e-12 is enlarged by 1/(1 - 0.81).
        let found = simulation.value("a.y1").expect("solved");
        assert!((found / solution - 1.0).abs() < 6e-12, "{found} {solution}");
        let notices = simulation.notices();
        assert!(notices.iter().any(|n| n.contains(path) && n.contains("Newton's method")), "{notices:?}");
    }
    // A gain of one with something added has no solution.
    let error = build(&units, &parts(1.0)).expect("builds").initialize().expect_err("parallel").to_string();
    assert!(
        error.starts_with(&format!("algebraic loop at initialisation: {path}: no fixed point")),
        "{error}"
    );
    // A delay breaks the loop.
    let mut delayed = parts(1.0).to_vec();
    delayed.push("delay = 0.5\n".into());
    build(&units, &delayed).expect("builds").initialize().expect("no loop");
}

#[test]
fn law_loops_begin_with_the_start_values() {
    // Gains of one: every value solves the loop, so the start values do, whatever an earlier run left behind.
    let gain = |name| unit(name, "feedthrough.fmu", "mode = 1");
    let parts = [gain("a"), gain("b"), connection("a.y1", "b.u1"), connection("b.y1", "a.u1")];
    let units = Units::new();
    let mut simulation = build(&units, &parts).expect("builds");
    for start in [7.0, -3.0] {
        simulation.reset();
        for input in ["a.u1", "b.u1"] {
            simulation.set(input, start).expect("before a run");
        }
        assert_eq!(simulation.value("a.y1").expect("solved"), start);
        simulation.run(&mut orchestrator::NoRecorder, &mut Quiet).expect("runs");
        assert_eq!(simulation.value("a.y1").expect("passed on"), start);
    }
    // A solution found from elsewhere would differ in its last bits.
    let more = [
        unit("a", "feedthrough.fmu", "mode = 1, k = -0.5, x0 = 1"),
        unit("b", "feedthrough.fmu", "mode = 1, k = -0.7, x0 = 4"),
    ];
    let mut simulation = build(&units, &[&more, &parts[2..]].concat()).expect("builds");
    let mut first = || {
        simulation.reset();
        let value = simulation.value("a.y1").expect("solved");
        simulation.run(&mut orchestrator::NoRecorder, &mut Quiet).expect("runs");
        value.to_bits()
    };
    assert_eq!(first(), first());
}

#[test]
fn value_a_loop_that_grows_fast_is_left_before_it_overflows() {
    // A thousand times as much each round: 1e300 after a hundred, and so in a product.
    let parts =
        [unit("a", "feedthrough.fmu", "mode = 1, k = -10000, x0 = 10001"), connection("a.y1", "a.u1")];
    let mut simulation = build(&Units::new(), &parts).expect("builds");
    // The residual is 1e-12 of 1, and the loop makes less of it.
    assert!((simulation.value("a.y1").expect("known") - 1.0).abs() < 1e-11);
    let told = simulation.notices().pop().expect("told");
    assert!(told.ends_with("of Newton's method, since iterating does not converge"), "{told}");
}

#[test]
fn law_units_that_say_nothing_start_after_all_their_inputs_each_by_itself() {
    let units = Units::new();
    // Without a list an output may depend on every input.
    let text = common::description(FEEDTHROUGH)
        .replace("<Unknown index=\"3\" dependencies=\"1 6\"/>", "<Unknown index=\"3\"/>");
    assert!(!text.contains("\"1 6\""));
    units.pack("silent.fmu", &text, &common::library());
    let gain = |name: &str| unit(name, "silent.fmu", "mode = 1, k = 3");
    let parts = [
        gain("d"),
        gain("c"),
        gain("b"),
        unit("a", "stateful.fmu", "x0 = 2"),
        connection("c.y1", "d.u1"),
        connection("b.y1", "c.u1"),
        connection("a.y1", "b.u1"),
    ];
    let mut simulation = build(&units, &parts).expect("builds");
    assert_eq!(simulation.value("d.y1").expect("known"), 54.0);
    let order = ["b.u1 = 0.0 (now 2.0)", "c.u1 = 0.0 (now 6.0)", "d.u1 = 0.0 (now 18.0)"];
    assert_eq!(simulation.replaced_starts(), order);
    assert_eq!(simulation.notices(), Vec::<String>::new());
}

#[test]
fn law_a_loop_settles_by_a_share_of_its_values() {
    // y = y / 2 + 2²⁰ halves what is left of 2²¹ each time: 2⁻⁴⁰ of it is below 1e-12, and the first round is a look.
    let parts = [unit("a", "feedthrough.fmu", "mode = 1, k = 0.5, x0 = 1048576"), connection("a.y1", "a.u1")];
    let mut simulation = build(&Units::new(), &parts).expect("builds");
    let off = simulation.value("a.y1").expect("known") / f64::from(1 << 21) - 1.0;
    assert!(off != 0.0 && off.abs() < 2e-12, "{off}");
    let told = simulation.notices().pop().expect("told");
    let rounds =
        told.split(' ').rev().nth(1).and_then(|rounds| rounds.parse::<u32>().ok()).expect("a number");
    assert!((39..=42).contains(&rounds), "{told}");
}
