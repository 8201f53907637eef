#!/usr/bin/env bash
# The long suites: random calls by the ten thousand and under valgrind, the cross-check by fmi-rs, the hidden data sets,
# and binaries for other platforms, the wheel, the crates. Takes hours on two cores, and needs the Python environment that
# scripts/test.sh makes; scripts/test.sh itself has a slice of each that matters for every change.
set -euo pipefail
cd "$(dirname "$0")/.."
units=(target/fmus/acrobot_plant.fmu target/fmus/acrobot_camera.fmu target/fmus/acrobot_controller.fmu
    target/fmus/acrobot_residual.fmu target/fmus/signal_effects.fmu)

step() { printf '\n== %s ==\n' "$*"; }

cargo xtask pack >/dev/null

step "10 000 sequences of random calls on each unit"
cargo xtask fuzz --sequences 10000 "${units[@]}"

step "The same under valgrind (1000 sequences on each unit)"
for unit in "${units[@]}"; do
    valgrind --quiet --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite,possible \
        target/release/xtask fuzz --sequences 1000 --limit 600 "$unit"
done

step "Runs that are killed 50 times and resumed leave the same bytes"
cargo build --quiet --release --package acroscope
for scenario in visual-servo dual-loop; do .venv/bin/python scripts/kills.py --scenario "$scenario" --stop 100; done

step "Same source, same bytes"
cargo xtask same-bytes

step "Units for all platforms, Windows' under Wine; the wheel in bare environments"
scripts/platforms.sh
scripts/wheel.sh
scripts/test-wheel.sh

step "Crates that are for others build from their own archives"
scripts/crates.sh

step "fmi-rs drives the units to the same bits"
CARGO_TARGET_DIR=target/fmi-rs cargo test --quiet --release --manifest-path tests/fmi-rs/Cargo.toml

step "Diagnoses that take half a minute and more"
(cd tests && ../.venv/bin/python -m pytest -q hidden_any -m long)

step "Blind diagnoses, 40 of each part, ours and the rivals'"
.venv/bin/python scripts/blind.py --count 40 --seed 7 --rivals
