//! Compiles the variadic half of the logger; stable Rust can call such a function but not define one. Says where units can
//! have processes of their own.

fn main() {
    println!("cargo:rerun-if-changed=src/fmu/logger.c");
    cc::Build::new().file("src/fmu/logger.c").compile("orchestrator_logger");
    println!("cargo:rustc-check-cfg=cfg(isolation)");
    let target = |part: &str| std::env::var(format!("CARGO_CFG_TARGET_{part}")).unwrap_or_default();
    if target("OS") == "linux" && target("POINTER_WIDTH") == "64" {
        println!("cargo:rustc-cfg=isolation");
    }
}
