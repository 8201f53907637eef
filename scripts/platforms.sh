#!/usr/bin/env bash
# Packs the units for all platforms, checks each library, and runs Windows' under Wine: the same bits as
# here. Takes minutes; needs python/requirements.txt, the targets below and, for the run, Debian's wine64.
set -euo pipefail
cd "$(dirname "$0")/.."

step() { printf '\n== %s ==\n' "$*"; }

[ -x .venv/bin/python ] || python3 -m venv .venv
.venv/bin/python -m pip install --quiet --disable-pip-version-check -r python/requirements.txt
rustup --quiet target add x86_64-pc-windows-gnu x86_64-apple-darwin aarch64-apple-darwin aarch64-unknown-linux-gnu

step "Units for linux64 (GLIBC 2.17), win64, darwin64 (universal), aarch64-linux: exports and imports"
cargo xtask pack --platforms all

step "Windows' units under Wine, against the bits of Linux"
wine=$(command -v wine64 || command -v wine || ls /usr/lib/wine/wine64 2>/dev/null || true)
if [ -z "$wine" ]; then
    echo "SKIPPED: there is no Wine here (apt-get install wine64), so nothing of win64 has run"
else
    master=(--quiet --release --package acroscope-orchestrator --example run_csv)
    cargo build "${master[@]}"
    PATH="$PWD/.venv/bin:$PATH" cargo zigbuild "${master[@]}" --target x86_64-pc-windows-gnu --target-dir target/programs
    # Wine before 8.13 lacks what Rust asks Windows' bcryptprimitives.dll for; its own generator gives it.
    cat >target/prng.c <<'END'
__declspec(dllimport) unsigned char SystemFunction036(void *, unsigned long);
__declspec(dllexport) int ProcessPrng(void *to, unsigned long long length) { return SystemFunction036(to, (unsigned long)length); }
END
    .venv/bin/python -m ziglang cc -target x86_64-windows-gnu -shared -O1 target/prng.c -ladvapi32 \
        -o target/programs/x86_64-pc-windows-gnu/release/examples/bcryptprimitives.dll
    out=$(mktemp -d)
    trap 'rm -rf "$out"' EXIT
    export WINEPREFIX="$out/wine" WINEDEBUG=-all
    for scenario in visual-servo full-state; do
        target/release/examples/run_csv "scenarios/$scenario.toml" target/fmus "$out/linux.csv" 3
        "$wine" target/programs/x86_64-pc-windows-gnu/release/examples/run_csv.exe \
            "scenarios\\$scenario.toml" "Z:$PWD/target/fmus" "Z:$out/windows.csv" 3
        cmp "$out/linux.csv" "$out/windows.csv"
        echo "$scenario: $(wc -l <"$out/linux.csv") rows, the same bits"
    done
fi
