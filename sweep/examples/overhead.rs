//! What a sweep costs beside its runs: `overhead FOLDER-WITH-UNITS bare|sweep [CASES]` runs `full-state` for 0.1 s that often, on
//! one thread, ten times over: by a bare loop over `Simulation::run` that keeps nothing, or as a sweep with its data set. To be
//! compared by processor time (`perf stat`, `/usr/bin/time`), which what else the machine does moves less.

use orchestrator::{NoRecorder, Quiet, Scenario, Simulation, UnitPath};
use sweep::{Limits, Options, Plan, Silent, Study};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let units =
        UnitPath::new().with(words.next().ok_or("usage: overhead FOLDER-WITH-UNITS bare|sweep [CASES]")?);
    let bare = words.next().is_some_and(|word| word == "bare");
    let cases: u32 = words.next().map_or(Ok(1000), |cases| cases.parse())?;
    let mut scenario: Scenario = scenarios::load("full-state")?;
    scenario.set_stop("0.1")?;
    let study = format!(
        "format = 1\nscenario = \"full-state\"\nstop = 0.1\n[random]\ncount = {cases}\nseed = 1\n\
         \"plant.b_joint\" = {{ from = 0, to = 0.1 }}\n\
         [scalars]\nend = {{ signal = \"plant.q2\", reduce = \"last\" }}\nrms = {{ signal = \"plant.q1\", reduce = \"rms\" }}\n"
    );
    let plan = Plan::new(&Study::parse(&study, "overhead.toml".as_ref())?, &units, &Limits::default())?;
    let mut simulation = Simulation::new(&scenario, &units)?;
    for _ in 0..10 {
        if bare {
            for case in 0..cases {
                simulation.set("plant.b_joint", 0.1 * f64::from(case) / f64::from(cases))?;
                simulation.run(&mut NoRecorder, &mut Quiet)?;
            }
        } else {
            let folder = tempfile::tempdir()?;
            sweep::sweep(&plan, &Options { jobs: Some(1), ..Options::new(folder.path()) }, &Silent)?;
        }
    }
    Ok(())
}
