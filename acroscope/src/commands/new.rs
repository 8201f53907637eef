//! `acroscope new`: a scenario that runs, from the descriptions of units.

use crate::cli::New;
use crate::error::Error;
use report::head::shell_word;
use std::io::{ErrorKind, Write as _};
use std::path::Path;

/// Writes the scenario, or prints it.
pub fn new(arguments: &New, quiet: bool) -> Result<(), Error> {
    arguments.called.look_out();
    let isolation = arguments.called.isolation();
    let draft = |path: &Path| inspection::draft::draft_with(&arguments.files, path, isolation.as_ref());
    let Some(path) = &arguments.output else {
        let text = draft(Path::new("scenario.toml"))?;
        tell!("{}", text.trim_end());
        return Ok(());
    };
    // Said before the work; the file itself is made so that none is lost.
    if path.exists() && !arguments.force {
        return Err(Error::There { path: path.clone() });
    }
    let text = draft(path)?;
    let mut options = std::fs::OpenOptions::new();
    match arguments.force {
        true => options.write(true).create(true).truncate(true),
        false => options.write(true).create_new(true),
    };
    let mut file = options.open(path).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => Error::There { path: path.clone() },
        _ => Error::file(path)(error),
    })?;
    file.write_all(text.as_bytes()).map_err(Error::file(path))?;
    if !quiet {
        let guesses = guesses(&text);
        let count = match guesses.len() {
            0 => "nothing in it is guessed".to_owned(),
            1 => "one guess, with a comment".to_owned(),
            more => format!("{more} guesses, each with a comment"),
        };
        for (line, guess) in guesses {
            tell!("{}:{line}: {guess}", path.display());
        }
        tell!("{}: {count}; run it with `{}`", path.display(), run_of(path));
    }
    Ok(())
}

/// The command that runs the scenario, as a shell takes it.
fn run_of(path: &Path) -> String {
    format!("acroscope run {}", shell_word(&path.to_string_lossy()))
}

/// Line and words of each guess. That of a table's head is about the keys below it.
fn guesses(text: &str) -> Vec<(usize, String)> {
    let lines: Vec<&str> = text.lines().collect();
    let guess = |(place, line): (usize, &&str)| {
        let (what, comment) = line.split_once(" # ")?;
        let (unit, guess) = comment.split_once("guess: ")?;
        let below = lines[place + 1..].iter().take_while(|line| !line.is_empty()).take(2);
        let what = match what.starts_with("[[") {
            true => below.copied().filter(|key| !key.starts_with("kind")).collect::<Vec<_>>().join(", "),
            false => what.to_owned(),
        };
        Some((place + 1, format!("{what}: {}", [unit, guess].concat())))
    };
    lines.iter().enumerate().filter_map(guess).collect()
}

#[cfg(test)]
mod tests {
    use super::{guesses, run_of};
    use std::path::Path;

    #[test]
    fn value_the_command_that_comes_next_can_be_pasted() {
        assert_eq!(run_of(Path::new("out/mine.toml")), "acroscope run out/mine.toml");
        assert_eq!(run_of(Path::new("out/my loop.toml")), "acroscope run 'out/my loop.toml'");
    }

    #[test]
    fn value_each_guess_is_told_with_its_line_and_what_it_is_about() {
        let text = "stop = 1.0 # guess: no unit proposes one\n\n[[connections]] # same name\nfrom = \"a.y\"\nto = \"b.y\"\n\n\
                    [[connections]] # guess: same name; these fit, too: c.y\nfrom = \"a.y\"\nto = \"b.u\"\ndelay = 1\n";
        let expected = [
            (1, "stop = 1.0: no unit proposes one".to_owned()),
            (7, "from = \"a.y\", to = \"b.u\": same name; these fit, too: c.y".to_owned()),
        ];
        assert_eq!(guesses(text), expected);
    }
}
