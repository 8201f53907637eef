//! What a sweep costs beside its runs: `overhead FOLDER-WITH-UNITS [CASES]` runs `full-state` for 0.1 s that often, on one thread,
//! once by a bare loop over `Simulation::run` that keeps nothing, and once as a sweep with its data set.

use orchestrator::{NoRecorder, Quiet, Scenario, Simulation, UnitPath};
use std::time::{Duration, Instant};
use sweep::{Limits, Options, Plan, Silent, Study};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let units = UnitPath::new().with(words.next().ok_or("usage: overhead FOLDER-WITH-UNITS [CASES]")?);
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
    let (mut bare, mut whole) = (Duration::MAX, Duration::MAX);
    // Alternately, and the quickest of each: what else the machine does costs both.
    for _ in 0..7 {
        let begin = Instant::now();
        for case in 0..cases {
            simulation.set("plant.b_joint", 0.1 * f64::from(case) / f64::from(cases))?;
            simulation.run(&mut NoRecorder, &mut Quiet)?;
        }
        bare = bare.min(begin.elapsed());
        let folder = tempfile::tempdir()?;
        let begin = Instant::now();
        sweep::sweep(&plan, &Options { jobs: Some(1), ..Options::new(folder.path()) }, &Silent)?;
        whole = whole.min(begin.elapsed());
    }
    let each = |time: Duration| time.as_secs_f64() / f64::from(cases) * 1e6;
    let ratio = whole.as_secs_f64() / bare.as_secs_f64();
    println!("{cases} cases: bare {:.1} µs a run, sweep {:.1} µs, ratio {ratio:.2}", each(bare), each(whole));
    Ok(())
}
