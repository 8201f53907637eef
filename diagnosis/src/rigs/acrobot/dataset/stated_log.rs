//! `[log]` of `dataset.toml`: how logs count, where it isn't our way. Applied to the rows as they are read, before anything else looks.
//!
//! Each key stands for one habit of labs. `plausibility` finds most of them out and says which line is missing; nothing is
//! ever changed without it.

use super::{Run, Table};
use orchestrator::suggest::nearest;
use std::f64::consts::PI;

/// What a lab may say of its logs.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated {
    /// Seconds in a unit of time.
    pub time: f64,
    /// N·m in a unit of torque, with its sign.
    pub torque: f64,
    /// Radians in a unit of the encoders' angles, with their sign.
    pub angle: f64,
    /// Signs of `q1` and `q2`, and of their rates, beside that.
    pub signs: [f64; 2],
    /// Radians in a unit of the angles that the vision read, with their sign.
    pub vision: f64,
    /// Angles are counted from hanging down.
    pub hanging: bool,
    /// `q2` is link 2 against link 1.
    pub relative: bool,
    /// The encoders' columns are exchanged.
    pub swapped: bool,
    /// Circles whose columns in an image are exchanged.
    pub circles: Option<[char; 2]>,
    /// Where pixels are counted from.
    pub pixels: Pixels,
    /// Whether a torque was held, and frames were lost, where all logs pause or the torque's does; `None`: not said.
    pub gaps_known: Option<bool>,
    /// The keys that stand there, with their values.
    pub given: Vec<(&'static str, String)>,
}

/// Where pixels are counted from, and which way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pixels {
    /// From the image's centre, v up: ours.
    Centre,
    /// From the centre, v down.
    CentreDown,
    /// From the upper left corner, v down.
    TopLeft,
    /// From the lower left corner, v up.
    BottomLeft,
}

impl Default for Stated {
    fn default() -> Self {
        Self {
            time: 1.0,
            torque: 1.0,
            angle: 1.0,
            signs: [1.0; 2],
            vision: 1.0,
            hanging: false,
            relative: false,
            swapped: false,
            circles: None,
            pixels: Pixels::Centre,
            gaps_known: None,
            given: Vec::new(),
        }
    }
}

/// A key: what it may be, and what it then does.
type Key = (&'static str, &'static [(&'static str, fn(&mut Stated))]);

/// All keys. To add a habit, add a line here and its fields above.
const KEYS: &[Key] = &[
    (
        "time",
        &[("s", |_| {}), ("ms", |s| s.time = 1e-3), ("us", |s| s.time = 1e-6), ("ns", |s| s.time = 1e-9)],
    ),
    (
        "torque",
        &[
            ("N·m", |_| {}),
            ("mN·m", |s| s.torque *= 1e-3),
            ("N·mm", |s| s.torque *= 1e-3),
            ("N·cm", |s| {
                s.torque *= 1e-2;
            }),
        ],
    ),
    ("torque_sign", &[("1", |_| {}), ("-1", |s| s.torque = -s.torque)]),
    ("angles", &[("rad", |_| {}), ("deg", |s| s.angle *= PI / 180.0)]),
    ("angles_sign", &[("1", |_| {}), ("-1", |s| s.angle = -s.angle)]),
    ("q1_sign", &[("1", |_| {}), ("-1", |s| s.signs[0] = -1.0)]),
    ("q2_sign", &[("1", |_| {}), ("-1", |s| s.signs[1] = -1.0)]),
    ("vision_angles", &[("rad", |_| {}), ("deg", |s| s.vision = PI / 180.0)]),
    ("zero", &[("upright", |_| {}), ("hanging", |s| s.hanging = true)]),
    ("q2", &[("absolute", |_| {}), ("relative", |s| s.relative = true)]),
    ("links", &[("in order", |_| {}), ("swapped", |s| s.swapped = true)]),
    (
        "circles",
        &[
            ("in order", |_| {}),
            ("1 and 2 swapped", |s| s.circles = Some(['1', '2'])),
            ("1 and 3 swapped", |s| s.circles = Some(['1', '3'])),
            ("2 and 3 swapped", |s| s.circles = Some(['2', '3'])),
        ],
    ),
    (
        "pixels",
        &[
            ("centre", |_| {}),
            ("centre, v down", |s| s.pixels = Pixels::CentreDown),
            ("top left", |s| s.pixels = Pixels::TopLeft),
            ("bottom left", |s| s.pixels = Pixels::BottomLeft),
        ],
    ),
    ("gaps", &[("known", |s| s.gaps_known = Some(true)), ("unknown", |s| s.gaps_known = Some(false))]),
];

impl Stated {
    /// Reads `[log]`.
    ///
    /// # Errors
    /// A key or a value that isn't one: the key, and what would be right.
    pub fn read(table: &toml::Table) -> Result<Self, (String, String)> {
        let mut stated = Self::default();
        // in the order of the list, since a sign multiplies a unit
        for (name, values) in KEYS {
            let Some(given) = table.get(*name) else { continue };
            let text = given.as_str().map_or_else(|| given.to_string(), str::to_owned);
            let known = values.iter().find(|(value, _)| *value == text);
            let Some((_, apply)) = known else {
                let wanted: Vec<String> = values.iter().map(|(value, _)| format!("{value:?}")).collect();
                return Err(((*name).to_owned(), format!("{name} = {given}: one of {}", wanted.join(", "))));
            };
            apply(&mut stated);
            stated.given.push((name, given.to_string()));
        }
        let known = || KEYS.iter().map(|(name, _)| *name);
        match table.keys().find(|key| !known().any(|name| name == key.as_str())) {
            Some(key) => {
                Err((key.clone(), format!("`{key}` is no habit of logs; {}", nearest(key, known()))))
            }
            None => Ok(stated),
        }
    }

    /// Turns the logs of a run into ours. `size` is the image's width and height in px.
    pub fn apply(&self, run: &mut Run, size: (f64, f64)) {
        let Run { camera, controller, plant, .. } = run;
        for log in [camera.as_mut(), controller.as_mut(), plant.as_mut()].into_iter().flatten() {
            log.time.iter_mut().for_each(|time| *time *= self.time);
        }
        if let Some(log) = controller {
            ["tau", "tau_1"].iter().for_each(|name| scale(log, name, self.torque));
        }
        if let Some(log) = plant {
            scale(log, "tau_applied", self.torque);
            for (name, sign) in ["q1", "q2", "dq1", "dq2"].into_iter().zip(self.signs.into_iter().cycle()) {
                scale(log, name, sign * self.angle);
            }
            self.turn(log);
        }
        if let Some(log) = camera {
            ["q1_est", "q2_est", "dq1_est", "dq2_est"].iter().for_each(|name| scale(log, name, self.vision));
            if let Some([one, other]) = self.circles {
                ["u", "v", "area"]
                    .iter()
                    .for_each(|name| log.swap(&format!("{name}{one}"), &format!("{name}{other}")));
            }
            self.count(log, size);
        }
    }

    /// Angles of encoders from the upright, both against the vertical, in their order.
    fn turn(&self, log: &mut Table) {
        let zero = if self.hanging { PI } else { 0.0 };
        for (names, zero) in [(["q1", "q2"], zero), (["dq1", "dq2"], 0.0)] {
            if self.swapped {
                log.swap(names[0], names[1]);
            }
            let first = log.column(names[0]).map(<[f64]>::to_vec);
            if let (true, Some(first), Some(second)) = (self.relative, first, log.column_mut(names[1])) {
                second.iter_mut().zip(&first).for_each(|(second, first)| *second += first);
            }
            for name in names {
                log.column_mut(name).into_iter().flatten().for_each(|value| *value += zero);
            }
        }
    }

    /// Counts pixels from the middle of the image and upwards, as the model does.
    fn count(&self, log: &mut Table, (width, height): (f64, f64)) {
        let (from, up) = match self.pixels {
            Pixels::Centre => return,
            Pixels::CentreDown => ((0.0, 0.0), -1.0),
            Pixels::TopLeft => ((0.5 * width, 0.5 * height), -1.0),
            Pixels::BottomLeft => ((0.5 * width, 0.5 * height), 1.0),
        };
        for circle in 1..=3 {
            for (name, from, sign) in [("u", from.0, 1.0), ("v", from.1, up)] {
                let column = log.column_mut(&format!("{name}{circle}"));
                column.into_iter().flatten().for_each(|value| *value = sign * (*value - from));
            }
        }
    }
}

/// Multiplies a column.
fn scale(log: &mut Table, name: &str, by: f64) {
    if by != 1.0 {
        log.column_mut(name).into_iter().flatten().for_each(|value| *value *= by);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Stated, (String, String)> {
        Stated::read(&text.parse().expect("it is TOML"))
    }

    fn run() -> Run {
        let log = |names: &[(&str, f64)]| {
            Some(Table::new(vec![1000.0], names.iter().map(|(name, x)| ((*name).into(), vec![*x])).collect()))
        };
        Run {
            name: "run-01".into(),
            camera: log(&[("u1", 256.0), ("v1", 435.0)]),
            controller: log(&[("tau", 300.0)]),
            plant: log(&[("q1", 180.0), ("q2", -10.0), ("dq1", 1.0), ("dq2", 2.0)]),
        }
    }

    #[test]
    fn value_logs_of_a_lab_become_ours() {
        let stated = read(
            "time = \"ms\"\ntorque = \"mN·m\"\ntorque_sign = -1\nangles = \"deg\"\nzero = \"hanging\"\nq2 = \"relative\"\n\
             pixels = \"top left\"",
        )
        .expect("all are known");
        let mut run = run();
        stated.apply(&mut run, (512.0, 512.0));
        let cell = |log: &Option<Table>, name: &str| {
            log.as_ref().and_then(|log| log.column(name)).map_or(f64::NAN, |all| all[0])
        };
        assert!((cell(&run.controller, "tau") + 0.3).abs() < 1e-12);
        assert!((cell(&run.plant, "q1") - 2.0 * PI).abs() < 1e-12);
        // 180 - 10 degrees from hanging
        assert!((cell(&run.plant, "q2") - (170.0 / 180.0 + 1.0) * PI).abs() < 1e-12);
        assert!((cell(&run.plant, "dq2") - 3.0 * PI / 180.0).abs() < 1e-12);
        assert_eq!((cell(&run.camera, "u1"), cell(&run.camera, "v1")), (0.0, -179.0));
        assert_eq!(run.plant.map(|log| log.time), Some(vec![1.0]));
    }

    #[test]
    fn value_one_encoder_that_counts_the_other_way_is_turned_with_its_rate() {
        let mut run = run();
        read("q2_sign = -1\nq2 = \"relative\"").expect("both are known").apply(&mut run, (512.0, 512.0));
        let plant = run.plant.expect("it was logged");
        let turned = ["q1", "q2", "dq1", "dq2"].map(|name| plant.column(name).map_or(f64::NAN, |all| all[0]));
        assert_eq!(turned, [180.0, 190.0, 1.0, -1.0]);
    }

    #[test]
    fn value_exchanged_links_are_put_in_order() {
        let mut run = run();
        read("links = \"swapped\"").expect("it is known").apply(&mut run, (512.0, 512.0));
        let plant = run.plant.expect("it was logged");
        assert_eq!([plant.column("q1"), plant.column("dq2")], [Some(&[-10.0][..]), Some(&[1.0][..])]);
    }

    #[test]
    fn value_exchanged_circles_are_put_in_order() {
        let mut run = run();
        let columns = ["u1", "u2", "v2", "u3", "v3", "area2", "area3"];
        let cells = columns.into_iter().zip([1.0, 2.0, 20.0, 3.0, 30.0, 72.0, 73.0]);
        run.camera = Some(Table::new(vec![0.0], cells.map(|(name, x)| (name.into(), vec![x])).collect()));
        read("circles = \"2 and 3 swapped\"").expect("it is known").apply(&mut run, (512.0, 512.0));
        let camera = run.camera.expect("it was logged");
        let turned = columns.map(|name| camera.column(name).map_or(f64::NAN, |all| all[0]));
        assert_eq!(turned, [1.0, 3.0, 30.0, 2.0, 20.0, 73.0, 72.0]);
    }

    #[test]
    fn every_key_and_value_that_is_none_is_named_with_what_would_be_right() {
        let (key, problem) = read("tme = \"ms\"").expect_err("mistyped");
        assert!(key == "tme" && problem.contains("did you mean time?"), "{problem}");
        let (key, problem) = read("time = \"hours\"").expect_err("none that we know");
        assert!(key == "time" && problem.contains("\"ms\""), "{problem}");
    }
}
