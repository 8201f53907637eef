//! The general data set: what is said is read and resolved, what is unknown is an error with line and suggestion.

use crate::common;

use crate::common::Folder;
use diagnosis::Error;
use diagnosis::testing::{Hold, InputEffect, Ports, Problem, Role, Scale, load_problem};
use std::f64::consts::PI;

const SET: &str = r#"format = 2
fmu = "acrobot_plant.fmu"
[set]
"acrobot_plant.theta_2" = 0.0
acrobot_plant.theta_7 = 0
[[channel]]
variable = "acrobot_plant.tau"
column = "motor"
unit = "mN.m"
hold = "linear"
[[channel]]
variable = "acrobot_plant.q1"
unit = "deg"
noise = 0.1
[[channel]]
variable = "acrobot_plant.q2"
column = "arm"
scale = -2.0
offset = 0.5
noise = 0.25
[[state]]
start = "acrobot_plant.q1_0"
shows = "acrobot_plant.q1"
[[state]]
start = "acrobot_plant.dq1_0"
[[candidate]]
variable = "acrobot_plant.b_joint"
range = [0, 5e-2]
[[candidate]]
variable = "acrobot_plant.theta_1"
range = [0.5, 2.0]
scale = "relative"
phrase = "inertia"
[[candidate]]
variable = "acrobot_plant.velocity_terms"
[[candidate]]
variable = "acrobot_plant.tau_max"
scale = "saturation"
[ports]
inputs = ["gain", "rate_limit"]
unknown_inputs = false
[[run]]
file = "a.csv"
[[run]]
file = "b.csv"
time = { column = "t", unit = "ms" }
"#;
const A: &str = "time,motor,q1,arm\n0.00,100,1.8,0.5\n0.01,,3.6,\n0.02,200,-3.6,0.25\n0.021,50,,0\n";
const B: &str =
    "\u{feff}n,t,arm,motor,q1\r\n0,1000,0,1,1\r\n1,1020,1,1,NaN\r\n2,1020,1,1,1\r\n3,1040,1,1,1\r\n";

fn load(set: &str, a: &str, b: &str, name: &str) -> Result<Problem, Error> {
    let folder = Folder::new(name);
    folder.put("dataset.toml", set);
    folder.put("a.csv", a);
    folder.put("b.csv", b);
    load_problem(folder.path(), &common::units(), None)
}

#[test]
fn value_what_is_said_is_resolved() {
    let problem = load(SET, A, B, "said").unwrap_or_else(|error| panic!("{error}"));
    let [tau, q1, q2] = problem.channels.as_slice() else { panic!("{:?}", problem.channels) };
    assert_eq!((tau.role, tau.name.as_str()), (Role::Fed(Hold::Linear), "acrobot_plant.tau"));
    assert_eq!((q1.role, q2.role), (Role::Compared, Role::Compared));
    assert_eq!((q2.noise, tau.noise), (Some(0.5), None));
    // a product of two roundings
    assert!((q1.noise.unwrap_or(0.0) - 0.1 * PI / 180.0).abs() < 1e-18);

    let [a, b] = problem.runs.as_slice() else { panic!("{:?}", problem.runs) };
    assert_eq!(a.series[0].time, [0.0, 0.02, 0.021]);
    for (value, wanted) in a.series[0].values.iter().zip([0.1, 0.2, 0.05]) {
        assert!((value - wanted).abs() < 1e-15, "{value}");
    }
    assert!((a.series[1].values[0] - 0.01 * PI).abs() < 1e-15);
    assert_eq!((&a.series[2].time, &a.series[2].values), (&vec![0.0, 0.02, 0.021], &vec![-0.5, 0.0, 0.5]));
    assert_eq!(a.span(), (0.0, 0.021));
    // milliseconds; the row at the same time as the one before is left out, and told
    assert_eq!((&b.series[0].time, &b.series[1].time), (&vec![1.0, 1.02, 1.04], &vec![1.0, 1.04]));
    assert!(problem.notices.iter().any(|notice| notice.file == "b.csv" && notice.line == 4));

    let [first, second] = problem.states.as_slice() else { panic!("{:?}", problem.states) };
    assert_eq!((first.channel, second.shows, second.channel), (Some(1), None, None));
    let [joint, inertia, switch, limit] = problem.candidates.as_slice() else {
        panic!("{:?}", problem.candidates)
    };
    assert_eq!((joint.neutral, joint.range, joint.scale), (0.0, (0.0, 0.05), Scale::Absolute));
    assert!(joint.phrase.starts_with("Viscous friction of the joint"));
    assert_eq!(
        (inertia.neutral, inertia.scale, inertia.phrase.as_str()),
        (0.20386, Scale::Relative, "inertia")
    );
    assert_eq!(inertia.range, (0.10193, 0.40772), "factors, since they don't hold 0.20386");
    assert_eq!((switch.scale, switch.neutral), (Scale::Switch, 1.0));
    assert_eq!(switch.range, (0.0, 1.0));
    assert_eq!((limit.scale, limit.range), (Scale::Saturation, (0.0, f64::INFINITY)));
    assert_eq!(problem.ports.inputs, [InputEffect::Gain, InputEffect::RateLimit]);
    assert_eq!((problem.ports.outputs.len(), problem.ports.unknown_inputs), (5, false));

    assert_eq!(problem.model.scenario.units[0].name, "acrobot_plant");
    let theta = nominal(&problem, "acrobot_plant.theta_2");
    assert_eq!((theta, nominal(&problem, "acrobot_plant.theta_7")), (Some(0.0), Some(0.0)));
}

fn nominal(problem: &Problem, name: &str) -> Option<f64> {
    let found = problem.model.set.iter().find(|(id, _)| problem.model.name(*id) == name);
    found.and_then(|(id, _)| problem.model.number(*id))
}

#[test]
fn value_defaults_come_from_the_description() {
    let short = "format = 2\nfmu = \"acrobot_plant.fmu\"\n[[channel]]\nvariable = \"acrobot_plant.q1\"\n[[run]]\nfile = \"a.csv\"\n";
    let problem = load(short, A, B, "short").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(problem.ports, Ports::default());
    // its outputs are computed from parameters: no start value is known to show
    assert_eq!(problem.states, []);
    let names: Vec<&str> = problem.candidates.iter().map(|candidate| candidate.name.as_str()).collect();
    assert!(names.contains(&"acrobot_plant.theta_1") && names.contains(&"acrobot_plant.slope"), "{names:?}");
    assert!(problem.notices.iter().any(|notice| notice.message.contains("every parameter may be off")));
    // rows are 10 ms apart, a whole number of the unit's own steps
    let interval = problem.model.scenario.units[0].interval.to_f64();
    let parts = 0.01 / interval;
    assert!((parts - parts.round()).abs() < 1e-9 && parts >= 1.0, "{interval}");
}

#[test]
fn value_a_list_of_no_candidates_is_none() {
    let short = "format = 2\nfmu = \"acrobot_plant.fmu\"\ncandidate = []\n[[channel]]\nvariable = \"acrobot_plant.q1\"\n[[run]]\nfile = \"a.csv\"\n";
    let problem = load(short, A, B, "none").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(problem.candidates, []);
    let told = |words: &str| problem.notices.iter().any(|notice| notice.message.contains(words));
    assert!(
        told("candidate = []: no parameter may be off") && !told("every parameter"),
        "{:?}",
        problem.notices
    );
}

#[test]
fn value_a_scenario_serves_as_well() {
    let set = "format = 2\nscenario = \"visual-servo\"\n[[channel]]\nvariable = \"plant.q1\"\n[[channel]]\nvariable = \"plant.tau\"\n\
               column = \"motor\"\n[[run]]\nfile = \"a.csv\"\n";
    let problem = load(set, A, B, "scenario").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(problem.model.fmus.len(), 3);
    let torque = problem.channels[1].variable;
    assert!(problem.model.is_driven(torque) && problem.model.name(torque) == "plant.tau");
}

/// Each fault by itself: what is put for what, and what the error says, with its file and line.
const FAULTS: &[(&str, &str, &str)] = &[
    ("format = 2", "format = 3", "dataset.toml:1: format = 3"),
    (
        "column = \"motor\"",
        "colunm = \"motor\"",
        "dataset.toml:8: there is no key `colunm` here: did you mean column",
    ),
    ("[ports]", "[port]", "dataset.toml:39: there is no key `port` here: did you mean ports"),
    (
        "acrobot_plant.fmu",
        "acrobot_plan.fmu",
        "unit acrobot_plan.fmu not found: did you mean acrobot_plant.fmu",
    ),
    (
        "\"acrobot_plant.theta_2\" = ",
        "\"acrobot_plant.theta_22\" = ",
        "dataset.toml:4: [set] acrobot_plant has no variable \"theta_22\": did you mean theta_2",
    ),
    (
        "theta_7 = 0",
        "theta_7 = \"much\"",
        "dataset.toml:5: acrobot_plant.theta_7 = \"much\": not a value of type Real",
    ),
    (
        "acrobot_plant.tau\"",
        "acrobot_plant.tua\"",
        "dataset.toml:7: acrobot_plant has no variable \"tua\": did you mean tau",
    ),
    (
        "\"acrobot_plant.tau\"",
        "\"plant.tau\"",
        "dataset.toml:7: \"plant.tau\": there is no instance \"plant\": ",
    ),
    (
        "\"acrobot_plant.tau\"",
        "\"tau\"",
        "dataset.toml:7: \"tau\" lacks its instance: write \"acrobot_plant.tau\"",
    ),
    (
        "acrobot_plant.tau\"",
        "acrobot_plant.theta_5\"",
        "dataset.toml:7: acrobot_plant.theta_5 is a parameter",
    ),
    ("column = \"motor\"", "column = \"moter\"", "dataset.toml:6: acrobot_plant.tau: "),
    ("unit = \"mN.m\"", "unit = \"mNn\"", "dataset.toml:9: unit = \"mNn\" is unknown: did you mean mN.m"),
    (
        "unit = \"mN.m\"",
        "unit = \"degC\"",
        "dataset.toml:9: unit = \"degC\" doesn't measure the same quantity as \"N.m\"",
    ),
    ("hold = \"linear\"", "hold = \"lienar\"", "dataset.toml:10: hold = \"lienar\": did you mean linear"),
    ("unit = \"deg\"", "unit = \"deg\"\nscale = 2", "dataset.toml:13: `unit` and `scale`"),
    ("noise = 0.1", "noise = -0.1", "dataset.toml:14: noise = -0.1"),
    (
        "\"acrobot_plant.q2\"",
        "\"acrobot_plant.q1\"",
        "dataset.toml:16: a second channel for acrobot_plant.q1, the first is at line 11",
    ),
    (
        "start = \"acrobot_plant.q1_0\"",
        "start = \"acrobot_plant.q1\"",
        "dataset.toml:22: acrobot_plant.q1 can't be given a start value",
    ),
    (
        "shows = \"acrobot_plant.q1\"",
        "shows = \"acrobot_plant.q3\"",
        "dataset.toml:23: acrobot_plant has no variable \"q3\"",
    ),
    (
        "shows = \"acrobot_plant.q1\"",
        "shows = \"acrobot_plant.dq1\"",
        "dataset.toml:23: acrobot_plant.dq1 is in rad/s and can't show acrobot_plant.q1_0, which is in rad",
    ),
    ("acrobot_plant.b_joint", "acrobot_plant.q2", "dataset.toml:27: acrobot_plant.q2 is no candidate"),
    ("range = [0, 5e-2]", "range = [5e-2, 0]", "dataset.toml:28: range = [0.05, 0]"),
    (
        "range = [0, 5e-2]",
        "range = [1e-2, 5e-2]",
        "dataset.toml:28: range = [0.01, 0.05]: the neutral value 0",
    ),
    ("range = [0, 5e-2]", "range = [1.0]", "dataset.toml:28: range: two numbers are wanted"),
    ("range = [0, 5e-2]", "range = [-2, -1]", "dataset.toml:28: range = [-2, -1]: the neutral value 0"),
    ("range = [0, 5e-2]", "neutral = -1.0", "dataset.toml:28: neutral = -1.0: the unit takes 0"),
    (
        "range = [0.5, 2.0]",
        "neutral = 5.0\nrange = [0.0, 2.0]",
        "dataset.toml:32: range = [0, 2]: the neutral value 5 of theta_1 lies outside",
    ),
    (
        "[set]\n",
        "[set]\n\"acrobot_plant.tau\" = 1.0\n",
        "dataset.toml:4: [set] acrobot_plant.tau is fed: the [[channel]] of line 7 would overwrite it",
    ),
    (
        "scale = \"relative\"",
        "scale = \"relativ\"",
        "dataset.toml:32: scale = \"relativ\": did you mean relative",
    ),
    ("\"rate_limit\"", "\"rate\"", "dataset.toml:40: [ports] \"rate\" is unknown"),
    ("file = \"a.csv\"", "file = \"aa.csv\"", "dataset.toml:43: file = \"aa.csv\": there is no such file"),
    ("file = \"a.csv\"", "file = \"run-01/a.csv\"", "dataset.toml:43: file = \"run-01/a.csv\""),
    (
        "file = \"a.csv\"",
        "file = \"../a.csv\"",
        "dataset.toml:43: file = \"../a.csv\" leads out of the data set's folder",
    ),
    (
        "file = \"a.csv\"",
        "file = \"/etc/passwd\"",
        "dataset.toml:43: file = \"/etc/passwd\" leads out of the data set's folder",
    ),
    (
        "file = \"b.csv\"\n",
        "file = \"b.csv\"\ntime = { column = \"t\", unit = \"ms\" }\n[[run]]\nfile = \"./b.csv\"\n",
        "dataset.toml:48: file = \"./b.csv\" holds the same rows as \"b.csv\" of line 45",
    ),
    ("unit = \"ms\"", "unit = \"mm\"", "dataset.toml:46: unit = \"mm\" is no unit of time"),
    ("column = \"t\"", "column = \"T\"", "dataset.toml:46: time: "),
    (
        "time = { column = \"t\", unit = \"ms\" }",
        "",
        "dataset.toml:45: b.csv: the first column is \"n\", not \"time\"",
    ),
];

#[test]
fn every_fault_of_the_file_is_told_with_its_line() {
    let mut wrong = Vec::new();
    for (place, (from, to, wanted)) in FAULTS.iter().enumerate() {
        assert!(SET.contains(from), "{from}");
        let set = SET.replacen(from, to, 1);
        let error = load(&set, A, B, &format!("fault-{place}")).expect_err(to);
        let said = error.to_string();
        if !said.contains(wanted) || !error.is_input() {
            wrong.push(format!("{to}\n  said   {said}\n  wanted {wanted}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_fault_of_a_log_is_told_with_its_line() {
    for (place, (log, wanted)) in [
        ("time;motor;q1;arm\n0;1;1;1\n", "a.csv:1: columns are separated by semicolons"),
        (
            "time,motor,q1,arm\n0,1,2,3\n0,5,1,2,3\n",
            "a.csv:3: 5 cells where the first line has 4; are these decimal commas",
        ),
        (
            "time,motor,q1,arm\n0,1,2,3\n1,\"0,5\",1,2\n",
            "a.csv:3: column \"motor\": \"0,5\" is not a finite number (write 0.5",
        ),
        ("time,motor,q1,arm\n0,1,2,3\n1,x,1,2\n", "a.csv:3: column \"motor\": \"x\""),
        (
            "time,motor,q1,arm\n0,1,2,3\n2026-11-24T10:00:00Z,1,1,2\n",
            "a.csv:3: column \"time\": \"2026-11-24T10:00:00Z\" is not a finite number; dates and times of day are read by \
             `acroscope import`",
        ),
        ("time,motor,q1,arm\n0,1,2,3\n,1,1,2\n", "a.csv:3: column \"time\": a row without a time"),
        (
            "time,motor,q1,arm\n3,1,2,3\n2,1,1,2\n1,1,1,2\n",
            "a.csv:3: column \"time\" is no time: 2 of 3 rows",
        ),
        (
            "t [ms],motor,q1,arm\n0,1,2,3\n1,1,2,3\n",
            "dataset.toml:43: a.csv: the first column is \"t [ms]\", not \"time\"; write time = { column = \"t [ms]\", unit = \"ms\" }",
        ),
        (
            "time,motor,q1,arm,q1\n0,1,2,3,4\n1,1,2,3,4\n",
            "a.csv:1: columns 3 and 5 are both called \"q1\"",
        ),
        (
            "time,motor,q1,arm\n0,1,2,3\n1,1,1e308,2\n2,1,1,2\n",
            "a.csv:3: column \"q1\": 1e308 is no measurement",
        ),
        ("time,motor,q1,arm\n", "a.csv:1: no rows"),
        ("time,motor,q1,arm\n0,,2,3\n1,,1,2\n", "column \"motor\" of a.csv holds no number to feed"),
    ]
    .into_iter()
    .enumerate()
    {
        let error = load(SET, log, B, &format!("log-{place}")).expect_err(wanted);
        assert!(error.to_string().contains(wanted) && error.is_input(), "{error}");
    }
}

#[test]
fn value_times_of_a_clock_count_from_the_first_row() {
    let set = "format = 2\nfmu = \"acrobot_plant.fmu\"\n[[channel]]\nvariable = \"acrobot_plant.q1\"\n[[run]]\nfile = \"a.csv\"\n\
               time = { column = \"t\", unit = \"us\" }\n";
    // microseconds since 1970 are exact, as seconds they would be rounded by a quarter of one
    let log = "t,q1\n1700000000000000,1\n1700000000000001,2\n1700000000000003,1\n";
    let problem = load(set, log, B, "clock").unwrap_or_else(|error| panic!("{error}"));
    let time = &problem.runs[0].series[0].time;
    assert!(
        time.iter().zip([0.0, 1e-6, 3e-6]).all(|(time, wanted)| (time - wanted).abs() < 1e-15),
        "{time:?}"
    );
    assert!(
        problem.notices.iter().any(|notice| notice.message.contains("a clock's")),
        "{:?}",
        problem.notices
    );
    // a run that begins late is no clock
    let late = log.replace("17000000000", "10");
    let problem = load(set, &late, B, "late").unwrap_or_else(|error| panic!("{error}"));
    assert!((problem.runs[0].series[0].time[0] - 1.0).abs() < 1e-12, "{:?}", problem.runs[0].series[0].time);
}

#[test]
fn value_a_range_beyond_the_units_is_cut_and_told() {
    let set = SET.replace("range = [0, 5e-2]", "range = [-1, 5e-2]");
    let problem = load(&set, A, B, "cut").unwrap_or_else(|error| panic!("{error}"));
    assert!(problem.candidates.iter().any(|candidate| candidate.range == (0.0, 5e-2)));
    assert!(
        problem.notices.iter().any(|notice| {
            notice.line == 28
                && notice.message.contains("the unit takes 0")
                && notice.message.contains("[0, 0.05]")
        }),
        "{:?}",
        problem.notices
    );
}
