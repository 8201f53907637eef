//! Prints the selection on the plant's cut of a data set, for a developer: `--example study -- DATASET`.

use diagnosis::candidates::{Cuts, candidates};
use diagnosis::dataset::DataSet;
use diagnosis::model::Model;
use diagnosis::residual::plant::PlantCut;
use diagnosis::residual::torque;
use diagnosis::selection::study;
use std::path::Path;
use std::sync::Arc;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let start = std::time::Instant::now();
    let data = DataSet::load(Path::new(&std::env::args().nth(1).ok_or("DATASET")?))?;
    for notice in &data.notices {
        println!("{notice}");
    }
    let units = orchestrator::UnitPath::new().with("target/fmus");
    let model = Model::load(&data, &units)?;
    let list = Arc::new(candidates(&model, &[], &|cuts| match cuts {
        Cuts::Torque => vec![],
        Cuts::TorqueRate => vec![],
    }));
    let mut cut = PlantCut::new(&data, &model, list.clone(), false)?.ok_or("no plant log")?;
    println!("set up {:?}", start.elapsed());
    if std::env::args().nth(2).is_some() {
        use diagnosis::residual::{Cut, Probe};
        let point: Vec<f64> = list.iter().map(|candidate| candidate.off).collect();
        let now = std::time::Instant::now();
        cut.linearise(&point, &[], false)?;
        println!("first {:?}", now.elapsed());
        let now = std::time::Instant::now();
        cut.linearise(&point, &[], false)?;
        println!("again {:?}", now.elapsed());
        for (index, candidate) in list.iter().enumerate() {
            let now = std::time::Instant::now();
            cut.linearise(&point, &[Probe { candidate: index, by: candidate.steps[0] }; 5], true)?;
            println!("{} {:?}", candidate.name, now.elapsed());
        }
        return Ok(());
    }
    let point: Vec<f64> = list.iter().map(|candidate| candidate.off).collect();
    {
        use diagnosis::residual::Cut;
        cut.linearise(&point, &[], false)?;
        println!("led {}", cut.led());
        if cut.led() > 0.5 {
            let mut weak = diagnosis::residual::weak::Weak::new(cut);
            let result =
                study(&mut weak, &list, &point, &mut |text| println!("  {text} {:?}", start.elapsed()))?;
            show(&result, &list, start);
            return Ok(());
        }
    }
    let result = study(&mut cut, &list, &point, &mut |text| println!("  {text} {:?}", start.elapsed()))?;
    show(&result, &list, start);
    let motions = cut.motion(&result.last.point, 1.0 / 120.0)?;
    let mut image = diagnosis::residual::image::ImageCut::new(
        &data,
        &model,
        list.clone(),
        diagnosis::residual::image::Pose::Logged(motions, 1e-4),
        720,
    )?
    .ok_or("no camera")?;
    let result =
        study(&mut image, &list, &result.last.point, &mut |text| println!("  {text} {:?}", start.elapsed()))?;
    show(&result, &list, start);
    Ok(())
}

fn show(
    result: &diagnosis::selection::Study,
    list: &[diagnosis::candidates::Candidate],
    start: std::time::Instant,
) {
    println!("{:?}; blocks {}", start.elapsed(), result.last.blocks.len());
    for step in &result.steps {
        println!(
            "p {:.5} deviance {:.1?} held out {:.1?} rest {:.3?} dropped {:?}",
            step.p_value, step.deviance, step.held_out, step.rest, step.dropped
        );
        for hit in &step.best {
            println!(
                "    {} gain {:.1} t {:.2} by {:.5}",
                list[hit.candidate].name, hit.gain, hit.statistic, hit.displacement
            );
        }
    }
    for (name, evaluation) in [("nominal", &result.nominal), ("last", &result.last)] {
        println!(
            "{name} sigmas {:?} seen {:?} softness {}",
            evaluation.sigmas, evaluation.seen, evaluation.softness
        );
        println!("   chi2 {:.1} / {:.1}", evaluation.total.square, evaluation.total.freedom);
        println!(
            "   torque rms, floor {:?}",
            torque::rms(&torque::torques(&evaluation.blocks, &[], &[], &result.folds.of))
        );
    }
    let free: Vec<usize> = result.active.clone();
    let covariance = result.last.covariance(&free);
    for (i, index) in free.iter().enumerate() {
        let error = covariance.as_ref().map_or(f64::NAN, |c| c[(i, i)].sqrt());
        println!("{} = {:.6} ± {:.6}", list[*index].name, result.last.point[*index], error);
    }
}
