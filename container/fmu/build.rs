//! On Linux the library begins like a program, too: `acroscope_container_serve` in `src/lib.rs`.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let target = |part: &str| std::env::var(format!("CARGO_CFG_TARGET_{part}")).unwrap_or_default();
    if target("OS") == "linux"
        && target("ENV") == "gnu"
        && ["x86_64", "aarch64"].contains(&target("ARCH").as_str())
    {
        println!("cargo::rustc-link-arg-cdylib=-Wl,-e,acroscope_container_serve");
    }
}
