//! Measures everything and writes the page: `scripts/bench.sh`, or `cargo bench -p benches [-- SECTION ...]` with the
//! sections frame, master, isolated, loop, sweep, estimator, diagnosis; with sections named, the page is not written.

use benches::{Row, closed_loop, diagnosis, estimator, frame, isolated, master, page, peer, sweep};

type Section = (&'static str, fn() -> Vec<Row>);

const SECTIONS: [Section; 7] = [
    ("frame", frame::rows),
    ("master", master::rows),
    ("isolated", isolated::rows),
    ("loop", || closed_loop::rows(env!("CARGO_BIN_EXE_counted"))),
    ("sweep", sweep::rows),
    ("estimator", estimator::rows),
    ("diagnosis", diagnosis::rows),
];

fn main() {
    // First, since this process may be that of a unit.
    orchestrator::host_units(["(the process of a unit)"]);
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    if let [flag, stop] = &arguments[..]
        && flag == "--memory"
    {
        return closed_loop::memory(stop);
    }
    let mut rows = Vec::new();
    for (name, measure) in SECTIONS {
        if arguments.is_empty() || arguments.iter().any(|wanted| wanted == name) {
            let part = measure();
            println!("{}", page::table(&part));
            rows.extend(part);
        }
    }
    if arguments.is_empty() {
        let path = peer::root().join("docs/speed.md");
        std::fs::create_dir_all(peer::root().join("docs")).expect("writable");
        std::fs::write(&path, page::page(&rows)).expect("writable");
        println!("written to docs/speed.md; {}", page::machine());
    }
}
