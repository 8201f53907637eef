//! Our importer and `fmi-rs` (by the authors of FMPy) drive the same units: every Real output agrees to the last bit.

use fmi_rs::fmi2::builder::FMU2Builder;
use fmi_rs::fmi2::types::fmi2Status;
use orchestrator::Kind;
use orchestrator::fmu::{Causality, Fmu, Status};
use std::path::{Path, PathBuf};

const STEP: f64 = 1.0 / 600.0;
const STEPS: usize = 600;

fn unit(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../target/fmus/acrobot_{name}.fmu"))
}

/// A different number for each input and step, small enough for every unit.
fn drive(step: usize, input: usize) -> f64 {
    0.05 * ((step * 7919 + input * 104_729) % 101) as f64 / 101.0
}

fn agree(name: &str) {
    let path = unit(name);
    let ours = Fmu::open(&path).expect("pack the units first: cargo xtask pack");
    let real = |causality: Causality| {
        let variables = ours.description().variables.iter();
        let chosen = variables.filter(move |v| v.causality == causality && v.kind == Kind::Real);
        chosen.map(|variable| variable.reference).collect::<Vec<u32>>()
    };
    let (inputs, outputs) = (real(Causality::Input), real(Causality::Output));
    assert!(!inputs.is_empty() && !outputs.is_empty());

    let theirs = FMU2Builder::new(&path).expect("fmi-rs opens it").instantiate_cs(name).expect("fmi-rs instantiates");
    assert_eq!(theirs.setupExperiment(None, 0.0, None), fmi2Status::Ok);
    assert_eq!(theirs.enterInitializationMode(), fmi2Status::Ok);
    assert_eq!(theirs.exitInitializationMode(), fmi2Status::Ok);

    let mut instance = ours.instantiate(name).expect("it instantiates");
    instance.setup_experiment(0.0, None).expect("setup");
    instance.enter_initialization().expect("enter");
    instance.exit_initialization().expect("exit");

    let mut moved = false;
    let (mut mine, mut other) = (vec![0.0; outputs.len()], vec![0.0; outputs.len()]);
    for step in 0..STEPS {
        let values: Vec<f64> = (0..inputs.len()).map(|input| drive(step, input)).collect();
        let time = step as f64 * STEP;
        instance.set_real(&inputs, &values).expect("inputs");
        assert_eq!(instance.do_step(time, STEP, true), Status::Ok);
        let before = mine.clone();
        instance.get_real(&outputs, &mut mine).expect("outputs");
        moved |= mine != before;

        assert_eq!(theirs.setReal(&inputs, &values), fmi2Status::Ok);
        assert_eq!(theirs.doStep(time, STEP, 1), fmi2Status::Ok);
        assert_eq!(theirs.getReal(&outputs, &mut other), fmi2Status::Ok);
        assert_eq!(mine, other, "{name} at step {step}");
    }
    assert!(moved, "{name}: the outputs changed during the run");
}

#[test]
fn cross_plant() {
    agree("plant");
}

#[test]
fn cross_camera() {
    agree("camera");
}

#[test]
fn cross_controller() {
    agree("controller");
}

#[test]
fn cross_residual() {
    agree("residual");
}
