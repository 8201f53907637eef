//! Compiles the variadic half of the logger; stable Rust can call such a function but not define one.

fn main() {
    println!("cargo:rerun-if-changed=src/fmu/logger.c");
    cc::Build::new().file("src/fmu/logger.c").compile("orchestrator_logger");
}
