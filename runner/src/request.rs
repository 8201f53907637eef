//! What was asked of a run: as a title, as the name of a folder, as the command that asks for it again.

use crate::cli::Run;
use crate::error::Error;
use orchestrator::Scenario;
use report::{Change, head::shell_word};
use sha2::{Digest as _, Sha256};
use std::path::{Path, PathBuf};

/// A run as it was asked for.
pub struct Request {
    /// The scenario as it was typed.
    pub scenario: String,
    /// What is set, each name once, in order of the names: the last one counts, as for the run.
    sets: Vec<(String, String)>,
    stop: Option<String>,
    /// Options that keep a unit within limits, as they are typed: without them the same run may end the program.
    limits: Vec<String>,
}

/// Changes that a title names; more are counted.
const NAMED: usize = 4;
/// Bytes of a folder's name, at most: systems allow 255, people read fewer.
const LONGEST: usize = 100;

impl Request {
    /// Takes the command line apart.
    pub fn of(arguments: &Run) -> Result<Self, Error> {
        let sets = sets(&arguments.set)?;
        let stop = arguments.stop.as_ref().map(|stop| stop.trim().to_owned());
        let limits = isolation_words(arguments.isolate, arguments.step_limit, arguments.memory_limit);
        Ok(Self { scenario: arguments.scenario.clone(), sets, stop, limits })
    }

    /// Puts into the scenario what was typed beside its name, and a description that says so: a changed run must not
    /// go under the title of the figure that it was changed from.
    pub fn apply(&self, scenario: &mut Scenario) -> Result<(), Error> {
        for (name, value) in &self.sets {
            scenario.set(name, value)?;
        }
        if let Some(stop) = &self.stop {
            scenario.set_stop(stop)?;
        }
        if scenario.description.is_empty() || !self.changes().is_empty() {
            scenario.description = self.title();
        }
        Ok(())
    }

    /// The scenario's name and what was changed: `visual-servo with camera.T_delay = 0.05`.
    fn title(&self) -> String {
        let mut title = stem(&self.scenario);
        let shown = self.sets.iter().take(NAMED).map(|(name, value)| format!("{name} = {value}"));
        let mut changes: Vec<String> = shown.collect();
        if self.sets.len() > NAMED {
            changes.push(format!("{} more", self.sets.len() - NAMED));
        }
        if let Some((last, before)) = changes.split_last() {
            let before =
                if before.is_empty() { String::new() } else { format!("{} and ", before.join(", ")) };
            title.push_str(&format!(" with {before}{last}"));
        }
        if let Some(stop) = &self.stop {
            title.push_str(&format!(", to t = {stop} s"));
        }
        title
    }

    /// What differs from the scenario.
    pub fn changes(&self) -> Vec<Change> {
        let stop = self.stop.iter().map(|stop| ("stop".to_owned(), stop.clone()));
        let changes = self.sets.iter().cloned().chain(stop);
        changes.map(|(name, value)| Change { name, value }).collect()
    }

    /// Where the results go if nobody says: a folder for each thing that can be asked.
    pub fn folder(&self) -> PathBuf {
        let changes = self.changes().into_iter().map(|change| format!("{}={}", change.name, change.value));
        Path::new("out").join(folder_name(&stem(&self.scenario), changes))
    }

    /// The command that asks for it again.
    pub fn command(&self) -> String {
        let mut words = vec!["acroscope".to_owned(), "run".to_owned(), shell_word(&self.scenario)];
        for (name, value) in &self.sets {
            words.extend(["--set".to_owned(), shell_word(&format!("{name}={value}"))]);
        }
        if let Some(stop) = &self.stop {
            words.extend(["--stop".to_owned(), shell_word(stop)]);
        }
        words.extend(self.limits.iter().cloned());
        words.join(" ")
    }
}

/// The options for processes of their own, as they are typed.
pub fn isolation_words(isolate: bool, step_limit: Option<f64>, memory_limit: Option<u64>) -> Vec<String> {
    let isolate = isolate.then(|| "--isolate".to_owned());
    let step = step_limit.map(|seconds| format!("--step-limit {seconds}"));
    let memory = memory_limit.map(|size| format!("--memory-limit {size}"));
    [isolate, step, memory].into_iter().flatten().collect()
}

/// What `--set` sets, each name once, in order of the names: the last one counts.
pub fn sets(given: &[String]) -> Result<Vec<(String, String)>, Error> {
    let mut sets: Vec<(String, String)> = Vec::new();
    for given in given {
        let Some((name, value)) = given.split_once('=') else {
            return Err(Error::Override { given: given.clone() });
        };
        let (name, value) = (name.trim().to_owned(), value.trim().to_owned());
        sets.retain(|(known, _)| *known != name);
        sets.push((name, value));
    }
    sets.sort();
    Ok(sets)
}

/// The name of a scenario: that of a shipped one, or the file's without its ending, after its folder's if it was named:
/// each diagnosis has an `amended.toml`.
fn stem(scenario: &str) -> String {
    let path = Path::new(scenario);
    let stem = path.file_stem().map_or_else(|| scenario.into(), |stem| stem.to_string_lossy());
    let folder = path.parent().and_then(Path::file_name).map(|folder| folder.to_string_lossy());
    match folder {
        Some(folder) if folder != "scenarios" => format!("{folder}-{stem}"),
        _ => stem.into_owned(),
    }
}

/// A folder's name from what was asked: letters that some system forbids are replaced and long names are cut; then a
/// checksum at the end keeps apart what was different.
pub fn folder_name(stem: &str, changes: impl Iterator<Item = String>) -> String {
    let asked = changes.fold(stem.to_owned(), |name, change| format!("{name}+{change}"));
    let allowed = |c: char| c.is_ascii_alphanumeric() || "._=+-".contains(c);
    let mut name: String = asked.chars().map(|c| if allowed(c) { c } else { '_' }).collect();
    if name == asked && name.len() <= LONGEST {
        return name;
    }
    let sum = crate::provenance::hex(&Sha256::digest(asked.as_bytes()));
    name.truncate(LONGEST - 9); // ASCII by now
    format!("{name}-{}", &sum[..8])
}

#[cfg(test)]
mod tests {
    use super::{LONGEST, Request, folder_name};
    use crate::cli::Run;

    fn request(scenario: &str, set: &[&str], stop: Option<&str>) -> Request {
        Request::of(&Run {
            scenario: scenario.into(),
            set: set.iter().map(|set| (*set).to_owned()).collect(),
            stop: stop.map(str::to_owned),
            isolate: false,
            step_limit: None,
            memory_limit: None,
            checkpoint: None,
            mcap: false,
            parquet: false,
            real_time: None,
            resume: false,
            verbose: false,
            out: None,
        })
        .expect("well formed")
    }

    #[test]
    fn law_each_thing_asked_has_a_folder_of_its_own() {
        let folder = |scenario: &str, set: &[&str], stop: Option<&str>| {
            request(scenario, set, stop).folder().display().to_string()
        };
        assert_eq!(folder("visual-servo", &[], None), "out/visual-servo");
        assert_eq!(folder("visual-servo", &["camera.k1=0.1"], None), "out/visual-servo+camera.k1=0.1");
        assert_eq!(folder("visual-servo", &[], Some("5")), "out/visual-servo+stop=5");
        assert_eq!(folder("scenarios/visual-servo.toml", &[], None), "out/visual-servo");
        let amended = |set: &str| folder(&format!("out/{set}/amended.toml"), &[], None);
        assert_ne!(amended("diagnose-a"), amended("diagnose-b"));
        let swapped = ["b.y=2", "a.x=1"];
        assert_eq!(folder("s", &swapped, None), folder("s", &["a.x=1", "b.y=2"], None), "the same run");
        assert_eq!(
            folder("s", &["a.x=1", "a.x=2"], None),
            folder("s", &["a.x=2"], None),
            "the last one counts"
        );
    }

    #[test]
    fn law_names_of_folders_are_safe_short_and_different() {
        let one = folder_name("s", ["u.file=/tmp/a b".to_owned()].into_iter());
        let other = folder_name("s", ["u.file=/tmp/a_b".to_owned()].into_iter());
        assert_ne!(one, other);
        for name in [&one, &other] {
            assert!(!name.contains(['/', ' ']), "{name}");
        }
        let many =
            |last: &str| folder_name("s", (0..99).map(|i| format!("u.x{i}=ä{i}")).chain([last.to_owned()]));
        assert!(many("a").len() <= LONGEST && many("a") != many("b"));
    }

    #[test]
    fn law_a_changed_run_says_what_was_changed() {
        assert_eq!(
            request("visual-servo", &["camera.T_delay=0.05"], None).title(),
            "visual-servo with camera.T_delay = 0.05"
        );
        assert_eq!(
            request("x.toml", &["b.y=2", "a.x=1"], Some("5")).title(),
            "x with a.x = 1 and b.y = 2, to t = 5 s"
        );
        let many: Vec<String> = (0..7).map(|i| format!("u.x{i}=1")).collect();
        let many: Vec<&str> = many.iter().map(String::as_str).collect();
        assert!(request("x", &many, None).title().ends_with("u.x3 = 1 and 3 more"));
        assert_eq!(
            request("a b.toml", &["u.s=x y"], None).command(),
            "acroscope run 'a b.toml' --set 'u.s=x y'"
        );
    }

    #[test]
    fn law_a_run_of_a_unit_in_a_process_of_its_own_is_asked_for_again_so() {
        let limited =
            Request { limits: super::isolation_words(true, Some(2.5), Some(64)), ..request("x", &[], None) };
        assert_eq!(limited.command(), "acroscope run x --isolate --step-limit 2.5 --memory-limit 64");
    }
}
