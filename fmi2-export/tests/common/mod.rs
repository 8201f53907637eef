//! A small unit for the tests, the C functions it exports, and a safe way to call them.

#![allow(unsafe_code)] // calls the C functions as a master does

use fmi2_export::abi::types::{Callbacks, Component, LoggerCallback, Status, Text};
use fmi2_export::{Dependencies, Description, Experiment, Log, LogCategory, Model, ModelError, Step, unit};
use serde::{Deserialize, Serialize};
use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr;
use std::sync::Mutex;

fmi2_export::variables! {
    /// A point that is driven along a line, with a counter and switches for the tests.
    pub struct Variables {
        input velocity: f64 = 0.0, "v", "v", unit::RADIAN_PER_SECOND, "Velocity.", min = -100.0, max = 100.0;
        input gear: i32 = 1, "gear", "g", unit::ONE, "Factor of the velocity.", min = 0, max = 5;
        input on: bool = true, "on", "o", unit::ONE, "Whether it moves.";
        output place: f64 = 0.0, "x", "x", unit::RADIAN, "Place.";
        output speed: f64 = 0.0, "dx", "ẋ", unit::RADIAN_PER_SECOND, "Speed.", derivative_of = "x";
        output steps: i32 = 0, "steps", "n", unit::ONE, "Steps that were made.";
        output moved: bool = false, "moved", "m", unit::ONE, "Whether it has left its start.";
        output said: String = String::new(), "said", "s", unit::ONE, "The last word.";
        parameter gain: f64 = 1.0, "gain", "k", unit::ONE, "Gain of the velocity, 50 % of #all <tests> & \"more\".";
        fixed start: f64 = 0.0, "x_0", "x₀", unit::RADIAN, "Place at the start.";
        fixed word: String = "hello".to_owned(), "word", "w", unit::ONE, "What it says.";
        effect drag: f64 = 0.0, "drag", "b", unit::ONE, "Loss of velocity.", min = 0.0, max = 1.0;
        parameter trouble: i32 = 0, "trouble", "!", unit::ONE,
            "1 panics, 2 gives NaN, 3 fails, 4 fails at the start, 5 panics at the start.", min = 0, max = 5;
    }
}

/// Value references, by place in the table above.
pub mod vr {
    pub const V: u32 = 0;
    pub const GEAR: u32 = 1;
    pub const ON: u32 = 2;
    pub const X: u32 = 3;
    pub const DX: u32 = 4;
    pub const STEPS: u32 = 5;
    pub const MOVED: u32 = 6;
    pub const SAID: u32 = 7;
    pub const GAIN: u32 = 8;
    pub const X_0: u32 = 9;
    pub const WORD: u32 = 10;
    pub const DRAG: u32 = 11;
    pub const TROUBLE: u32 = 12;
    pub const NONE: u32 = 13;
}

/// Its hidden state: places it was at, so that a saved state has some size.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Toy {
    history: Vec<f64>,
    random: u64,
}

impl Toy {
    fn speed(variables: &Variables) -> f64 {
        if !variables.on {
            return 0.0;
        }
        variables.gain * f64::from(variables.gear) * variables.velocity * (1.0 - variables.drag)
    }
}

impl Model for Toy {
    type Variables = Variables;

    fn description() -> Description {
        Description {
            identifier: "toy",
            description: "A unit for tests.",
            version: "1.0",
            stop_time: 1.0,
            step_size: 1e-2,
            provides_derivatives: true,
            log_categories: &[LogCategory { name: "logToy", description: "What the toy tells." }],
        }
    }

    fn dependencies(output: &str) -> Dependencies {
        match output {
            "x" => Dependencies { while_stepping: &[], at_start: Some(&["x_0"]) },
            "dx" => Dependencies { while_stepping: &["gear", "v", "on"], at_start: None },
            _ => Dependencies { while_stepping: &[], at_start: Some(&[]) },
        }
    }

    fn initialize(
        &mut self,
        v: &mut Variables,
        experiment: &Experiment,
        log: &mut dyn Log,
    ) -> Result<(), ModelError> {
        match v.trouble {
            4 => return Err(ModelError::Failed("no start".to_owned())),
            5 => panic!("no start at all"),
            _ => {}
        }
        assert!(self.history.is_empty(), "initialisation starts from nothing");
        *self = Self { history: vec![v.start], random: 42 };
        v.place = v.start;
        v.speed = Self::speed(v);
        v.steps = 0;
        v.moved = false;
        v.said.clone_from(&v.word);
        log.log("logToy", &|| format!("starts at {} s, 100 % #1", experiment.start));
        Ok(())
    }

    fn step(&mut self, v: &mut Variables, step: &Step<'_>, log: &mut dyn Log) -> Result<(), ModelError> {
        match v.trouble {
            1 => panic!("trouble {}", v.trouble),
            3 => {
                return Err(ModelError::Value {
                    name: "gain",
                    value: v.gain.to_string(),
                    expected: "less".to_owned(),
                });
            }
            _ => {}
        }
        self.random = self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let rate = step.input_rate("v").unwrap_or(0.0);
        v.speed = Self::speed(v);
        v.place += v.speed * step.size() + 0.5 * rate * step.size() * step.size();
        v.place += 1e-12 * (self.random >> 40) as f64;
        v.steps += 1;
        v.moved = v.place != v.start;
        v.said = format!("{}", v.steps);
        if v.trouble == 2 {
            v.place = f64::NAN;
        }
        self.history.push(v.place);
        log.log("logToy", &|| format!("at {} s", step.to));
        Ok(())
    }

    fn derivative(&self, variables: &Variables, unknown: &str, known: &str) -> Option<f64> {
        match (unknown, known) {
            ("dx", "v") => Some(Self::speed(&Variables { velocity: 1.0, ..variables.clone() })),
            ("dx", "x") => Some(0.0),
            _ => None,
        }
    }
}

fmi2_export::export!(Toy);

/// A log line: instance, status, category, message.
pub type Line = (String, Status, String, String);

unsafe extern "C" fn collect(
    environment: *mut c_void,
    name: Text,
    status: Status,
    category: Text,
    message: Text,
) {
    // SAFETY: `Instance` passes its own list; the strings are the unit's.
    unsafe {
        let lines = &*environment.cast::<Mutex<Vec<Line>>>();
        let text = |text| CStr::from_ptr(text).to_str().unwrap().to_owned();
        lines.lock().unwrap().push((text(name), status, text(category), text(message)));
    }
}

/// An instance with its log.
pub struct Instance {
    pub c: Component,
    pub log: Box<Mutex<Vec<Line>>>,
}

// SAFETY: a component may be used by any thread, one at a time.
unsafe impl Send for Instance {}

impl Instance {
    pub fn guid() -> CString {
        CString::new(fmi2_export::description::Unit::of::<Toy>().guid()).unwrap()
    }

    pub fn try_new(name: Option<&CStr>, kind: i32, guid: Option<&CStr>, logging: bool) -> Self {
        let log = Box::new(Mutex::new(Vec::new()));
        // SAFETY: a non-variadic function in place of a variadic one, called without variadic arguments: the same
        // calling convention on the platforms that run these tests.
        let logger: LoggerCallback = unsafe { std::mem::transmute(collect as *const ()) };
        let callbacks = Callbacks {
            logger: Some(logger),
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            environment: (&raw const *log).cast_mut().cast(),
        };
        let text = |text: Option<&CStr>| text.map_or(ptr::null(), CStr::as_ptr);
        // SAFETY: all pointers are null or valid.
        let c = unsafe {
            fmi2::fmi2Instantiate(
                text(name),
                kind,
                text(guid),
                ptr::null(),
                &callbacks,
                0,
                i32::from(logging),
            )
        };
        Self { c, log }
    }

    pub fn new() -> Self {
        let instance = Self::try_new(Some(c"one"), 1, Some(&Self::guid()), true);
        assert!(!instance.c.is_null(), "{:?}", instance.lines());
        instance
    }

    /// At the first communication point.
    pub fn ready() -> Self {
        let instance = Self::new();
        assert_eq!(instance.setup(0.0, None), 0);
        assert_eq!(instance.enter(), 0);
        assert_eq!(instance.exit(), 0);
        instance
    }

    pub fn lines(&self) -> Vec<Line> {
        std::mem::take(&mut self.log.lock().unwrap())
    }

    /// The one error that was logged since the last look.
    pub fn error(&self) -> String {
        let errors: Vec<_> = self.lines().into_iter().filter(|line| line.2 == "logStatusError").collect();
        assert_eq!(errors.len(), 1, "{errors:?}");
        assert_eq!(errors[0].1, 3);
        errors[0].3.clone()
    }

    pub fn setup(&self, start: f64, stop: Option<f64>) -> Status {
        let stop_defined = i32::from(stop.is_some());
        unsafe { fmi2::fmi2SetupExperiment(self.c, 0, 0.0, start, stop_defined, stop.unwrap_or(f64::NAN)) }
    }
    pub fn enter(&self) -> Status {
        unsafe { fmi2::fmi2EnterInitializationMode(self.c) }
    }
    pub fn exit(&self) -> Status {
        unsafe { fmi2::fmi2ExitInitializationMode(self.c) }
    }
    pub fn terminate(&self) -> Status {
        unsafe { fmi2::fmi2Terminate(self.c) }
    }
    pub fn reset(&self) -> Status {
        unsafe { fmi2::fmi2Reset(self.c) }
    }
    pub fn step(&self, from: f64, size: f64) -> Status {
        unsafe { fmi2::fmi2DoStep(self.c, from, size, 0) }
    }
    pub fn step_and_forget(&self, from: f64, size: f64) -> Status {
        unsafe { fmi2::fmi2DoStep(self.c, from, size, 1) }
    }
    pub fn set_real(&self, vr: u32, value: f64) -> Status {
        unsafe { fmi2::fmi2SetReal(self.c, &vr, 1, &value) }
    }
    pub fn set_integer(&self, vr: u32, value: i32) -> Status {
        unsafe { fmi2::fmi2SetInteger(self.c, &vr, 1, &value) }
    }
    pub fn set_boolean(&self, vr: u32, value: i32) -> Status {
        unsafe { fmi2::fmi2SetBoolean(self.c, &vr, 1, &value) }
    }
    pub fn set_string(&self, vr: u32, value: &CStr) -> Status {
        unsafe { fmi2::fmi2SetString(self.c, &vr, 1, &value.as_ptr()) }
    }
    pub fn get_real(&self, vr: u32) -> Result<f64, Status> {
        let mut value = f64::NAN;
        answer(unsafe { fmi2::fmi2GetReal(self.c, &vr, 1, &mut value) }, value)
    }
    pub fn get_integer(&self, vr: u32) -> Result<i32, Status> {
        let mut value = i32::MIN;
        answer(unsafe { fmi2::fmi2GetInteger(self.c, &vr, 1, &mut value) }, value)
    }
    pub fn get_boolean(&self, vr: u32) -> Result<i32, Status> {
        let mut value = i32::MIN;
        answer(unsafe { fmi2::fmi2GetBoolean(self.c, &vr, 1, &mut value) }, value)
    }
    pub fn get_string(&self, vr: u32) -> Result<String, Status> {
        let mut value = ptr::null();
        let status = unsafe { fmi2::fmi2GetString(self.c, &vr, 1, &mut value) };
        if status != 0 {
            return Err(status);
        }
        Ok(unsafe { CStr::from_ptr(value) }.to_str().unwrap().to_owned())
    }
    pub fn get_state(&self, state: &mut *mut c_void) -> Status {
        unsafe { fmi2::fmi2GetFMUstate(self.c, state) }
    }
    pub fn set_state(&self, state: *mut c_void) -> Status {
        unsafe { fmi2::fmi2SetFMUstate(self.c, state) }
    }
    pub fn free_state(&self, state: &mut *mut c_void) -> Status {
        unsafe { fmi2::fmi2FreeFMUstate(self.c, state) }
    }
    pub fn serialize(&self, state: *mut c_void) -> Result<Vec<u8>, Status> {
        let mut size = 0;
        answer(unsafe { fmi2::fmi2SerializedFMUstateSize(self.c, state, &mut size) }, ())?;
        let mut bytes = vec![0_u8; size];
        let status = unsafe { fmi2::fmi2SerializeFMUstate(self.c, state, bytes.as_mut_ptr().cast(), size) };
        answer(status, bytes)
    }
    pub fn deserialize(&self, bytes: &[u8]) -> Result<*mut c_void, Status> {
        let mut state = ptr::null_mut();
        let from = bytes.as_ptr().cast::<c_char>();
        let status = unsafe { fmi2::fmi2DeSerializeFMUstate(self.c, from, bytes.len(), &mut state) };
        answer(status, state)
    }
    pub fn rate(&self, vr: u32, order: i32, value: f64) -> Status {
        unsafe { fmi2::fmi2SetRealInputDerivatives(self.c, &vr, 1, &order, &value) }
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        unsafe { fmi2::fmi2FreeInstance(self.c) }
    }
}

fn answer<T>(status: Status, value: T) -> Result<T, Status> {
    if status == 0 { Ok(value) } else { Err(status) }
}
