//! README.md shows the code of the crate's documentation, which is compiled and run.

#[test]
fn law_the_readme_shows_the_code_that_is_tested() {
    let block = |text: &str, fence: &str| {
        let (_, rest) = text.split_once(fence).expect("a block begins");
        rest.split_once("```").expect("it ends").0.trim().to_owned()
    };
    let readme = block(include_str!("../README.md"), "```rust\n");
    let documented =
        block(&include_str!("../src/lib.rs").replace("//! ", "").replace("//!\n", "\n"), "```\n");
    let shown: Vec<&str> = documented
        .lines()
        .filter(|line| !line.starts_with("# ") && !line.contains("mistakes()")) // what rustdoc hides, and its assertion
        .collect();
    assert_eq!(readme.lines().collect::<Vec<_>>(), shown);
}
