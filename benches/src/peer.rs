//! A peer in Python that stays alive and measures itself when asked: one line in, one line of JSON out.

use crate::Samples;
use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// A running script of `scripts/peers/`.
pub struct Peer {
    child: Child,
    questions: ChildStdin,
    answers: BufReader<ChildStdout>,
}

/// The root of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the package lies in the repository").to_owned()
}

/// The interpreter: `ACROSCOPE_PYTHON`, or that of `.venv`, which `scripts/bench.sh` makes.
pub fn python() -> PathBuf {
    std::env::var_os("ACROSCOPE_PYTHON").map_or_else(|| root().join(".venv/bin/python"), PathBuf::from)
}

impl Peer {
    /// Starts a script.
    pub fn start(script: &str, arguments: &[&str]) -> Self {
        let mut child = Command::new(python())
            .arg(root().join("scripts/peers").join(script))
            .arg("--serve")
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap_or_else(|error| panic!("{}: {error}; scripts/bench.sh makes it", python().display()));
        let (questions, answers) = (child.stdin.take(), child.stdout.take());
        Self { child, questions: questions.expect("piped"), answers: BufReader::new(answers.expect("piped")) }
    }

    /// Asks and waits for the answer.
    pub fn ask(&mut self, question: &str) -> Value {
        writeln!(self.questions, "{question}").expect("the peer listens");
        let mut line = String::new();
        self.answers.read_line(&mut line).expect("the peer speaks");
        serde_json::from_str(&line).unwrap_or_else(|error| panic!("`{question}` -> `{line}`: {error}"))
    }

    /// Asks for times in µs and appends them; returns the other values of the answer.
    pub fn measure(&mut self, question: &str, times: &mut Samples) -> Vec<f64> {
        let answer = self.ask(question);
        times.0.extend(numbers(&answer["times_us"]));
        numbers(&answer["values"])
    }
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

impl Drop for Peer {
    fn drop(&mut self) {
        // It is ours alone; nothing is lost when it can't be stopped twice.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
