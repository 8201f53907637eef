//! Diagnoses a data set without the command line: `--example diagnose -- DATASET OUT [--without NAME]...`.

use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [set, out, rest @ ..] = arguments.as_slice() else { return Err("DATASET OUT".into()) };
    let without = rest.chunks(2).filter_map(|pair| pair.get(1).cloned()).collect();
    let options = diagnosis::Options { without, ..Default::default() };
    let units = orchestrator::UnitPath::new().with("target/fmus");
    let found = diagnosis::diagnose(Path::new(set), &units, &options, &mut |text| eprintln!("{text}"))?;
    found.write(Path::new(out))?;
    for effect in &found.effects {
        println!(
            "{} {:?} {:.6} {:?} p {:.4}",
            effect.name, effect.class, effect.value, effect.ci95, effect.probability
        );
    }
    println!("{:?} gap {:?}", found.verdict, found.gap);
    println!("unknown {:?}", found.unknown);
    Ok(())
}
