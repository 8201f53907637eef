//! What goes between the master and a unit in a process of its own: reads that are made ahead, calls that fail among them, and the
//! end of the process.

use crate::common::{STATEFUL, Units, description, library_with};
use orchestrator::fmu::{Instance, Status};
use orchestrator::{Fmu, Isolation, Kind, Value};

/// The units' processes are this program with only this test, which serves them and never returns.
#[test]
fn unit_host() {
    let program = std::env::current_exe().expect("this program");
    orchestrator::host_units_by(
        program,
        ["--exact", "exchanges::unit_host", "--nocapture", "--test-threads=1"],
    );
}

/// What reads reals, with something done before each; y2 tells how many such calls there were.
fn reads(first: &str) -> (&'static str, String) {
    let text = format!(
        "API int fmi2GetReal(void *c, const unsigned *refs, size_t n, double *values) {{\n\
         static int calls;\n Unit *u = c;\n fresh(u);\n calls++;\n {first}\n\
         for (size_t i = 0; i < n; i++) values[i] = refs[i] == Y2 ? calls : u->r[refs[i]];\n return 0;\n}}\n\
         API int fmi2SetReal(void *c, const unsigned *refs, size_t n, const double *values) {{\n\
         for (size_t i = 0; i < n; i++) ((Unit *)c)->r[refs[i]] = values[i];\n return 0;\n}}\n"
    );
    ("ACCESS(Real, double, r)", text)
}

/// A unit with other functions, in this process and in one of its own.
fn both(units: &Units, name: &str, change: &[(&str, &str)]) -> [Fmu; 2] {
    let path = units.pack(name, &description(STATEFUL), &library_with(change));
    let fmu = Fmu::open(path).expect("opens");
    [fmu.clone(), fmu.isolated(Isolation::default())]
}

/// An instance that steps.
fn started(fmu: &Fmu, integers: &[(u32, i32)], reals: &[(u32, f64)]) -> Instance {
    let mut instance = fmu.instantiate("a").expect("instantiates");
    integers.iter().for_each(|(at, value)| instance.set_integer(&[*at], &[*value]).expect("set"));
    reals.iter().for_each(|(at, value)| instance.set_real(&[*at], &[*value]).expect("set"));
    instance.setup_experiment(0.0, None).expect("set up");
    instance.enter_initialization().expect("enters");
    instance.exit_initialization().expect("exits");
    instance
}

fn real(instance: &mut Instance, reference: u32) -> f64 {
    let mut value = [f64::NAN];
    instance.get_real(&[reference], &mut value).expect("a real");
    value[0]
}

#[test]
fn law_what_was_read_after_a_step_is_read_along_with_the_next_one() {
    unit_host();
    let (from, to) = reads("");
    let counted = |fmu: &Fmu| {
        let mut instance = started(fmu, &[], &[]);
        let mut step = 0.0;
        let mut next = |instance: &mut Instance| {
            assert_eq!(instance.do_step(step, 0.5, true), Status::Ok);
            step += 0.5;
        };
        let mut calls = Vec::new();
        for _ in 0..3 {
            next(&mut instance);
            calls.push(real(&mut instance, 3));
        }
        for _ in 0..3 {
            next(&mut instance);
            calls.extend([real(&mut instance, 3), real(&mut instance, 2), real(&mut instance, 3)]);
        }
        // What is set makes what was read ahead worthless: it is read again.
        next(&mut instance);
        instance.set_real(&[1], &[1.0]).expect("u2");
        calls.push(real(&mut instance, 3));
        // Nobody asked after this step, so the next one brings nothing along.
        next(&mut instance);
        next(&mut instance);
        next(&mut instance);
        calls.push(real(&mut instance, 3));
        calls
    };
    let units = Units::new();
    let [here, there] = both(&units, "counts.fmu", &[(from, &to)]);
    // y1 is 0 all along, and one of the calls.
    let each = [1.0, 2.0, 3.0, 4.0, 0.0, 6.0, 7.0, 0.0, 9.0, 10.0, 0.0, 12.0];
    assert_eq!(counted(&here), [&each[..], &[13.0, 14.0]].concat());
    // Three more with the step after which a value was set, and with the one after that; none once nobody asked.
    assert_eq!(counted(&there), [&each[..], &[16.0, 20.0]].concat());
}

#[test]
fn every_read_after_a_step_that_is_discarded_is_made() {
    unit_host();
    let told = |fmu: &Fmu| {
        // y1 is the unit's clock; steps that end at 1 s or later are discarded.
        let mut instance = started(fmu, &[(2, 2), (3, 2)], &[(6, 1.0)]);
        let mut told = Vec::new();
        for step in 0..4 {
            let status = instance.do_step(f64::from(step) * 0.5, 0.5, true);
            told.push((status, real(&mut instance, 2), instance.last_successful_time()));
        }
        told
    };
    let units = Units::new();
    let [here, there] = both(&units, "discards.fmu", &[]);
    let expected = told(&here);
    assert_eq!(
        expected.iter().map(|(status, ..)| *status).collect::<Vec<_>>(),
        [Status::Ok, Status::Discard, Status::Discard, Status::Discard]
    );
    assert_eq!(told(&there), expected);
}

#[test]
fn every_read_after_one_that_failed_is_made() {
    unit_host();
    let units = Units::new();
    let (from, to) = reads("if (u->x > 1) return 3;");
    let told = |fmu: &Fmu| {
        let mut instance = started(fmu, &[(0, 41)], &[(0, 1.0)]);
        let mut told = Vec::new();
        for step in 0..4 {
            assert_eq!(instance.do_step(f64::from(step) * 0.5, 0.5, true), Status::Ok);
            let y1 = instance.get(Kind::Real, 2).map_err(|error| error.to_string());
            told.push((y1, instance.get(Kind::Integer, 1).expect("another function"), instance.log().len()));
        }
        told
    };
    let [here, there] = both(&units, "refuses.fmu", &[(from, &to)]);
    let expected = told(&here);
    assert!(expected[1].0 == Ok(Value::Real(1.0)) && expected[2].0.is_err(), "{expected:?}");
    assert!(expected.iter().all(|(_, i_out, _)| *i_out == Value::Integer(42)));
    assert_eq!(told(&there), expected);
}

#[test]
fn every_answer_with_a_warning_is_read() {
    unit_host();
    let (from, to) = reads("");
    let warns = to.replace("return 0;", "return 1;");
    let [here, there] =
        both(&Units::new(), "warns.fmu", &[(from, &warns), ("    return 0;\n}", "    return 1;\n}")]);
    let told = |fmu: &Fmu| {
        let mut instance = started(fmu, &[(2, 1)], &[(0, 1.0), (6, 0.0)]);
        instance.set(0, &Value::String("text".into())).expect("s_in");
        let mut told = Vec::new();
        for step in 0..2 {
            assert_eq!(instance.do_step(f64::from(step) * 0.5, 0.5, false), Status::Warning);
            // The second time they come along with the step.
            told.extend([(Kind::Real, 2), (Kind::Real, 3), (Kind::String, 1)].map(|(kind, reference)| {
                instance.get(kind, reference).expect("a warning is no error").to_string()
            }));
        }
        let state = instance.save_state().expect("saved");
        let bytes = instance.serialize_state(&state).expect("bytes");
        assert_eq!(instance.do_step(1.0, 0.5, false), Status::Warning);
        let again = instance.deserialize_state(&bytes).expect("a state");
        instance.restore_state(&again).expect("restored");
        told.push(real(&mut instance, 2).to_string());
        told.push(format!("{} bytes, {} warnings", bytes.len(), instance.warnings()));
        instance.free_state(state).and_then(|()| instance.free_state(again)).expect("freed");
        told
    };
    let expected = told(&here);
    assert_eq!(expected[..6], ["0.5", "2.0", "\"text\"", "1.0", "4.0", "\"text\""], "{expected:?}");
    assert_eq!(told(&there), expected);
}

#[test]
fn law_what_was_read_ahead_counts_no_more_once_the_unit_was_taken_back() {
    unit_host();
    let told = |fmu: &Fmu| {
        let mut instance = started(fmu, &[], &[(0, 1.0)]);
        let mut told = Vec::new();
        assert_eq!(instance.do_step(0.0, 0.5, false), Status::Ok);
        told.push(real(&mut instance, 2));
        let state = instance.save_state().expect("saved");
        assert_eq!(instance.do_step(0.5, 0.5, false), Status::Ok);
        instance.restore_state(&state).expect("restored");
        told.push(real(&mut instance, 2));
        assert_eq!(instance.do_step(0.5, 0.5, false), Status::Ok);
        assert_eq!(instance.last_successful_time(), Some(1.0));
        told.push(real(&mut instance, 2));
        instance.free_state(state).expect("freed");
        told
    };
    let [here, there] = both(&Units::new(), "honest.fmu", &[]);
    assert_eq!(told(&here), [0.5, 0.5, 1.0]);
    assert_eq!(told(&there), [0.5, 0.5, 1.0]);
}

#[test]
fn every_experiment_is_told_elsewhere_as_it_is_here() {
    unit_host();
    let tells = (
        "    (void)from; (void)stop_defined; (void)stop;\n",
        "    u->callbacks->logger(u->callbacks->environment, \"u\", 1, \"events\", \"from %g, %d, %g\", from, stop_defined, \
         stop_defined ? stop : 0.0);\n",
    );
    let steps = (
        "    (void)no_return;\n",
        "    u->callbacks->logger(u->callbacks->environment, \"u\", 1, \"events\", \"%g by %g, returns %d\", from, size, !no_return);\n",
    );
    let units = Units::new();
    let proposing = description(STATEFUL).replace("stopTime=\"1\"", "stopTime=\"1\" tolerance=\"0.001\"");
    for (description, tolerance) in [(description(STATEFUL), None), (proposing, Some("tolerance 0.001"))] {
        let fmu =
            Fmu::open(units.pack("tells.fmu", &description, &library_with(&[tells, steps]))).expect("opens");
        for fmu in [&fmu, &fmu.isolated(Isolation::default())] {
            for (stop, told) in [(None, "from 0.5, 0, 0"), (Some(2.5), "from 0.5, 1, 2.5")] {
                let mut instance = fmu.instantiate("a").expect("instantiates");
                instance.setup_experiment(0.5, stop).expect("set up");
                let log: Vec<String> = instance.log().into_iter().map(|line| line.text).collect();
                let expected: Vec<&str> = [told].into_iter().chain(tolerance).collect();
                assert_eq!(log, expected);
                instance.enter_initialization().expect("enters");
                instance.exit_initialization().expect("exits");
                for returns in [true, false] {
                    let before = instance.log().len();
                    assert_eq!(instance.do_step(0.5, 0.25, !returns), Status::Ok);
                    let log =
                        instance.log().into_iter().skip(before).map(|line| line.text).collect::<Vec<_>>();
                    assert_eq!(log, [format!("0.5 by 0.25, returns {}", i32::from(returns))]);
                }
            }
        }
    }
}

#[test]
fn law_a_process_is_given_the_time_to_end_by_itself() {
    unit_host();
    let units = Units::new();
    let mark = units.path().join("gone");
    // What its library does when the process ends takes longer than a look of the master.
    let last = format!(
        "__attribute__((destructor)) static void last(void) {{ usleep(300000); FILE *f = fopen(\"{}\", \"w\"); if (f) fclose(f); }}\n\
         API int fmi2Terminate(",
        mark.display()
    );
    let [_, there] = both(&units, "slow.fmu", &[("API int fmi2Terminate(", &last)]);
    let mut instance = started(&there, &[], &[]);
    assert_eq!(instance.do_step(0.0, 0.5, true), Status::Ok);
    assert!(!mark.exists());
    drop(instance);
    assert!(mark.exists(), "it was ended before");
}

#[test]
fn law_a_process_that_does_not_end_is_ended() {
    unit_host();
    let units = Units::new();
    let mark = units.path().join("gone");
    // Five times as long as it is given.
    let last = format!(
        "__attribute__((destructor)) static void last(void) {{ sleep(10); FILE *f = fopen(\"{}\", \"w\"); if (f) fclose(f); }}\n\
         API int fmi2Terminate(",
        mark.display()
    );
    let [_, there] = both(&units, "endless.fmu", &[("API int fmi2Terminate(", &last)]);
    drop(started(&there, &[], &[]));
    assert!(!mark.exists(), "it was waited for");
}

/// Set in the process that is to be killed: the folder with the unit, which writes its process into it.
const MASTER: &str = "ORCHESTRATOR_KILLED_MASTER";

#[test]
fn law_a_process_ends_with_its_master() {
    unit_host();
    if let Some(folder) = std::env::var_os(MASTER) {
        let fmu = Fmu::open(std::path::Path::new(&folder).join("endless.fmu")).expect("opens");
        // It never comes back from its step, and is not asked to.
        started(&fmu.isolated(Isolation::default()), &[(2, 14)], &[(6, 0.0)]).do_step(0.0, 0.5, true);
        return;
    }
    let units = Units::new();
    let process = units.path().join("process");
    let writes = (
        "    case ENDLESS: ",
        &*format!(
            "    case ENDLESS: {{ FILE *f = fopen(\"{0}.tmp\", \"w\"); fprintf(f, \"%d\", getpid()); fclose(f); rename(\"{0}.tmp\", \"{0}\"); }} ",
            process.display()
        ),
    );
    both(&units, "endless.fmu", &[writes]);
    let mut master = std::process::Command::new(std::env::current_exe().expect("this program"))
        .args(["--exact", "exchanges::law_a_process_ends_with_its_master"])
        .env(MASTER, units.path())
        .env("TMPDIR", units.path())
        .stdout(std::process::Stdio::null())
        .spawn()
        .expect("starts");
    // Long enough for any machine; what is waited for takes milliseconds.
    let within_a_minute = |is: &dyn Fn() -> bool| {
        let limit = std::time::Instant::now() + std::time::Duration::from_secs(60);
        while !is() && std::time::Instant::now() < limit {
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        is()
    };
    assert!(within_a_minute(&|| process.exists()), "it steps");
    let number = std::fs::read_to_string(&process).expect("a number");
    // A process that has ended stays on the list, as a zombie, until somebody asks how: here nobody may.
    let lives = || {
        let status = std::fs::read_to_string(format!("/proc/{number}/stat"));
        status.is_ok_and(|status| !status.contains(") Z ") && !status.contains(") X "))
    };
    assert!(lives());
    master.kill().expect("killed with SIGKILL");
    master.wait().expect("ends");
    assert!(within_a_minute(&|| !lives()), "its process ends, too");
}
