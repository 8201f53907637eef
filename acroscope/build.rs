//! Exports the program's own `_exit` and `_Exit`: units then call these (`main.rs`).

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "linux") {
        println!(
            "cargo::rustc-link-arg-bins=-Wl,--export-dynamic-symbol=_exit,--export-dynamic-symbol=_Exit"
        );
    }
}
