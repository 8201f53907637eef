#!/usr/bin/env bash
# Installs what the tests need and passes all of them. Needs Rust (rustup), Python 3.11 or newer, and gcc.
set -euo pipefail
cd "$(dirname "$0")/.."

step() { printf '\n== %s ==\n' "$*"; }

step "Python environment (.venv)"
[ -x .venv/bin/python ] || python3 -m venv .venv
.venv/bin/python -m pip install --quiet --disable-pip-version-check -r tests/requirements.txt -r tests/hidden/requirements.txt

step "Formatting"
cargo fmt --check

step "Lints"
cargo clippy --quiet --release --workspace --all-targets -- -D warnings

step "Units: build, pack, compare with the committed descriptions"
cargo xtask pack --check
cargo xtask pack >/dev/null
cargo acroscope --version

step "Rust tests"
if cargo nextest --version >/dev/null 2>&1; then
    cargo nextest run --release --workspace --cargo-quiet --status-level fail
else
    cargo test --quiet --release --workspace --lib --bins --tests
fi
cargo test --quiet --release --workspace --doc

step "Foreign programs drive the units (FMPy, libcosim, scipy, OpenCV, PythonFMU)"
.venv/bin/python -m pytest tests/fmpy

step "Pages in a browser"
if ! command -v chromium >/dev/null && command -v apt-get >/dev/null && [ "$(id -u)" = 0 ]; then
    (apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends chromium) >/dev/null 2>&1 ||
        echo "chromium can't be installed here"
fi
.venv/bin/python -m pytest tests/browser

step "The maker of hidden data, and a slice of blind diagnoses"
(cd tests && ../.venv/bin/python -m pytest -q hidden)
(cd tests && ../.venv/bin/python -m pytest -q hidden_any -n 2)
.venv/bin/python scripts/blind.py
.venv/bin/python scripts/blind_any.py

step "Random calls, legal and not (a slice; scripts/test-long.sh has the rest)"
cargo xtask fuzz --sequences 300 target/fmus/acrobot_plant.fmu target/fmus/acrobot_camera.fmu \
    target/fmus/acrobot_controller.fmu target/fmus/acrobot_residual.fmu target/fmus/signal_effects.fmu

step "Documentation"
RUSTDOCFLAGS="-D warnings" cargo doc --quiet --release --no-deps --workspace
