//! One data set, diagnosed: scripts/ablate.
fn main() {
    let words: Vec<String> = std::env::args().collect();
    let units = scenarios::unit_path().with(&words[1]);
    let mut options = diagnosis::Options::default();
    options.without = words[3..].to_vec();
    match diagnosis::diagnose(words[2].as_ref(), &units, &options, &mut |_| {}) {
        Ok(found) => println!("{}", found.to_json()),
        Err(error) => println!("{{\"error\": {:?}}}", error.to_string()),
    }
}
