//! What the numbers of this room decide, on an engine; and the engine for other rooms' tests.

use super::build::{Built, build};
use super::schedule::Schedule;
use super::worker::Job;
use crate::infer::fit::Linearise;
use crate::observe::{Problem, load};
use orchestrator::UnitPath;
use std::path::Path;

/// Distance of the pendulum's rows, s.
pub const ROW: f64 = 0.02;

/// Where the units lie.
pub fn units() -> UnitPath {
    scenarios::unit_path().with(Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/fmus"))
}

/// A hanging double pendulum, logged over so many rows of 20 ms; `name` is the test's own.
pub fn pendulum(name: &str, rows: u32) -> Problem {
    pendulum_with(name, rows, "")
}

/// The same with further lines of `[set]`.
fn pendulum_with(name: &str, rows: u32, set: &str) -> Problem {
    let head = format!(
        "format = 2\nfmu = \"acrobot_plant.fmu\"\n[set]\n\"acrobot_plant.theta_2\" = 0.0\n\"acrobot_plant.theta_7\" = 0.0\n\
                \"acrobot_plant.q2_max\" = 1e9\n{set}[[run]]\nfile = \"a.csv\"\n[[channel]]\nvariable = \"acrobot_plant.tau\"\n"
    );
    let states = ["q1", "q2", "dq1", "dq2"].map(|name| {
        format!("[[state]]\nstart = \"acrobot_plant.{name}_0\"\nshows = \"acrobot_plant.{name}\"\n")
    });
    let channels =
        ["q1", "q2"].map(|name| format!("[[channel]]\nvariable = \"acrobot_plant.{name}\"\nnoise = 1e-3\n"));
    let row = |row: u32| {
        let t = ROW * f64::from(row);
        format!(
            "{t},{},{},{}\n",
            0.01 * libm::sin(9.0 * t),
            std::f64::consts::PI + 0.01 * libm::sin(5.0 * t),
            std::f64::consts::PI + 0.01 * libm::cos(7.0 * t)
        )
    };
    let folder = std::env::temp_dir().join(format!("diagnosis-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder can be made");
    let put = |name: &str, text: String| std::fs::write(folder.join(name), text).expect("it can be written");
    put("dataset.toml", format!("{head}{}{}", states.concat(), channels.concat()));
    put("a.csv", "time,tau,q1,q2\n".to_owned() + &(0..rows).map(row).collect::<String>());
    let problem = load(&folder, &units(), None).expect("cargo xtask pack made the unit");
    let _ = std::fs::remove_dir_all(folder);
    problem
}

/// The same with its last output logged in so many columns more.
pub fn logged_again(mut problem: Problem, more: usize) -> Problem {
    let last = problem.channels.len() - 1;
    for _ in 0..more {
        problem.channels.push(problem.channels[last].clone());
        problem.runs.iter_mut().for_each(|run| run.series.push(run.series[last].clone()));
    }
    problem
}

/// Its engine.
pub fn built(problem: &Problem) -> Built {
    build(problem, &problem.whole_runs()).expect("it can be followed")
}

/// The same, with what the model itself does from a wide start on in the place of the log.
pub fn swung(name: &str, rows: u32) -> Problem {
    simulated(pendulum(name, rows))
}

/// A problem with what the model itself does from a wide start on in the place of its log.
pub fn simulated(mut problem: Problem) -> Problem {
    let built = built(&problem);
    let (machine, grid) = (&built.engine.machine, &built.engine.grids[0]);
    let schedule = Schedule::new(machine, grid, &machine.neutral());
    let (pi, mut out) = (std::f64::consts::PI, Vec::new());
    let start = [pi + 0.48, pi - 0.32, 0.8, -1.2];
    let whole = schedule.job(grid.time[0], 0, grid.time.len() - 1, &start);
    let job = Job { each_row: true, reads: &[], ..whole };
    built.engine.with_worker(|worker| worker.interval(machine, &job, &mut out)).expect("it swings");
    let courses = out[machine.order()..].chunks(machine.channels.len());
    for (row, shown) in courses.enumerate() {
        for (output, value) in machine.channels.iter().zip(shown) {
            problem.runs[0].series[output.channel].values[row] = *value;
        }
    }
    problem
}

/// Place of a parameter by its name, of the unit or of what is added at its ports.
pub fn place(built: &Built, name: &str) -> usize {
    let name = format!("acrobot_plant.{name}");
    let found = built.engine.machine.parameters.iter().position(|parameter| parameter.name == name);
    found.expect("a parameter")
}

#[test]
fn value_how_much_of_the_motion_starts_and_process_noise_may_be() {
    let problem = pendulum("sizes", 60);
    let built = built(&problem);
    let (scales, span) = (&built.engine.scales, 59.0 * ROW);
    for (state, scale) in scales.iter().enumerate() {
        // what a log begins at may lie several of its sizes off what follows, and not fifty: then it is another log
        let start = built.engine.starts[0].1[state];
        let whole = scale.max(built.engine.machine.states[state].nominal.abs());
        assert!(start > 5.0 * scale && start < 15.0 * whole, "state {state}: {start} of {scale}");
        let (least, most) = built.sizes.process[state];
        // over a run it adds up to what a difference of units is rounded to, whatever the run's length
        assert!((0.5e-6..2e-6).contains(&(least * span.sqrt() / scale)), "state {state}: {least}");
        // and within a row to several times all of the motion: an equation that says nothing of it
        assert!((5.0..15.0).contains(&(most * ROW.sqrt() / scale)), "state {state}: {most}");
    }
    // timestamps that scatter by more than a third of a row change places
    assert!((0.25..0.35).contains(&(built.sizes.jitter / ROW)), "{}", built.sizes.jitter);
}

#[test]
fn law_timestamps_that_are_late_are_a_delay_of_what_is_fed() {
    let built = built(&pendulum("timestamps", 40));
    let (engine, theta) = (&built.engine, built.engine.machine.neutral());
    let path = [std::f64::consts::PI + 0.48, std::f64::consts::PI - 0.32, 0.8, -1.2].repeat(40);
    let delay = place(&built, "tau:delay");
    let run = &engine.linearise(&theta, &[path], &[delay]).expect("it can be linearised")[0];
    let moved = |row: usize| (run.late(row)[2..].iter()).zip(&run.column(row, 0)[2..]);
    let largest = (1..39).flat_map(moved).fold(0.0, |most, (_, delay)| f64::max(most, delay.abs()));
    assert!(largest > 0.0);
    for (late, delay) in (1..39).flat_map(moved) {
        // of the rates, which end as far off as the input acts late; over a third of a row the machine bends by a thousandth
        assert!((late - delay).abs() < 1e-2 * largest, "{late} against {delay}");
    }
    // before the log its first value held: an interval that is cut elsewhere ends the same to rounding of a difference over 6 ms
    assert!(run.late(0).iter().all(|late| late.abs() < 1e-6 * largest), "{:?} of {largest}", run.late(0));
}

#[test]
fn value_a_sensor_that_lags_is_read_at_the_elevenths_of_an_interval() {
    let problem = pendulum("elevenths", 10);
    let built = built(&problem);
    let machine = &built.engine.machine;
    let mut theta = machine.neutral();
    theta[place(&built, "q1:lag")] = 0.03;
    let schedule = Schedule::new(machine, &built.engine.grids[0], &theta);
    for row in &schedule.inner {
        let times: Vec<f64> = row[0].iter().map(|(time, _)| time / ROW).collect();
        // a course between them is off its line by 1/121 of what it bends by over the row
        assert_eq!(times.len(), 10, "{times:?}");
        let off = times.iter().zip(1..).map(|(time, part)| (time - f64::from(part) / 11.0).abs());
        // times of a log of a second, rounded, in rows
        assert!(off.fold(0.0, f64::max) < 1e-12, "{times:?}");
    }
}

#[test]
fn value_a_machine_that_sticks_at_rest_is_read_back_as_soon_as_one_that_does_not() {
    // friction turns about at rest, where the model of an unmeasured rate begins: what is asked is asked beside that
    let rows = |name: &str, set: &str| {
        let mut built = built(&pendulum_with(name, 60, set));
        built.engine.choose_horizon().expect("it can be followed")
    };
    let free = rows("free", "");
    assert_eq!(rows("sticks", "\"acrobot_plant.fc_joint\" = 0.02\n"), free);
}

#[test]
fn law_a_unit_with_steps_of_its_own_is_stepped_as_far_as_they_go() {
    let built = built(&pendulum("leaps", 20));
    let steps = |factor: f64, most: f64| built.engine.steps_as_far(factor, most);
    // rows of an hour cost a unit with steps of milliseconds as many times more as it makes steps; rows of a tenth of a second don't
    assert!(steps(5.0, 300.0) && !steps(3600.0 / ROW, 300.0));
}

#[test]
fn every_whole_run_of_more_states_than_can_be_followed_is_refused() {
    // two outputs and four start values; the sweep has room for 23 and an unlisted input
    let whole = |more: usize| Problem { whole: true, ..logged_again(pendulum("wide", 20), more) };
    let refused = |more: usize| {
        let problem = whole(more);
        build(&problem, &problem.whole_runs()).err().map(|error| error.to_string())
    };
    assert_eq!(refused(17), None);
    let text = refused(18).expect("24 states");
    assert!(text.contains("20 compared outputs") && text.contains("at most 23"), "{text}");
}

#[test]
fn bad_data_a_channel_of_one_value_has_a_size_and_is_told() {
    let mut problem = pendulum("still", 101);
    let told = |problem: &Problem| {
        let built = built(problem);
        let still = built.notices.iter().filter(|notice| notice.message.contains("one value in all rows"));
        (
            still.map(|notice| notice.message.clone()).collect::<Vec<_>>(),
            built.scatter[1].size,
            built.noise.channels[1],
        )
    };
    assert!(told(&problem).0.is_empty());
    problem.runs[0].series[problem.channels.len() - 1].values.fill(2.5);
    let (messages, size, noise) = told(&problem);
    assert!(messages.len() == 1 && messages[0].contains("acrobot_plant.q2"), "{messages:?}");
    // a noise of 1e-300 of its unit would make any residual infinitely unlikely
    assert!(size == 2.5 && noise > 1e-9, "{size} {noise}");
    problem.runs[0].series[problem.channels.len() - 1].values.fill(0.0);
    assert_eq!(told(&problem).1, 1.0);
}

#[test]
fn bad_data_runs_of_too_few_rows_are_told_where_none_is_left() {
    let problem = pendulum("few-rows", 2);
    let error = build(&problem, &problem.whole_runs()).err().expect("two rows").to_string();
    assert!(
        error.contains("no usable run:") && error.contains("a.csv: 2 rows tell nothing of a motion"),
        "{error}"
    );
}
