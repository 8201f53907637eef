//! Writes one frame of a robot at rest as PNG, for people and for cross-checks against other renderers.
//!
//! `cargo run --release -p camera --example frame -- FOLDER q1=0.1 q2=-0.4 k1=0.1 sigma=15 ...` sets any variables
//! of the unit by their FMI names, writes `FOLDER/frame_000000.png` and prints the outputs.

use camera::{Camera, Variables};
use fmi2_export::{Experiment, Log, Model, Slot, SlotMut, Table};

struct Silent;
impl Log for Silent {
    fn log(&mut self, _: &'static str, _: &dyn Fn() -> String) {}
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut variables = Variables::default();
    variables.sensor.frames_dir = arguments.next().ok_or("a folder for the frame, then name=value ...")?;
    let table = Variables::variables();
    for argument in arguments {
        let (name, value) = argument.split_once('=').ok_or(format!("{argument}: name=value"))?;
        let index = table.iter().position(|v| v.name == name).ok_or(format!("{name}: no such variable"))?;
        match variables.get_mut(index) {
            Some(SlotMut::Real(slot)) => *slot = value.parse()?,
            Some(SlotMut::Integer(slot)) => *slot = value.parse()?,
            Some(SlotMut::Boolean(slot)) => *slot = value.parse()?,
            Some(SlotMut::String(slot)) => value.clone_into(slot),
            None => {}
        }
    }
    let experiment = Experiment { start: 0.0, stop: None, tolerance: None };
    Camera::default().initialize(&mut variables, &experiment, &mut Silent)?;
    for (index, declared) in table.iter().enumerate() {
        if declared.causality == fmi2_export::Causality::Output {
            match variables.get(index) {
                Some(Slot::Real(value)) => println!("{} = {value}", declared.name),
                Some(Slot::Boolean(value)) => println!("{} = {value}", declared.name),
                other => println!("{} = {other:?}", declared.name),
            }
        }
    }
    Ok(())
}
