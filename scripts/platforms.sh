#!/usr/bin/env bash
# Packs the units for all platforms, checks each library, and runs Windows' under Wine and ARM's under QEMU: the same bits as
# here. Takes minutes; needs python/requirements.txt, the targets below and, for the runs, Debian's wine64, qemu-user-static and
# libc6-arm64-cross.
set -euo pipefail
cd "$(dirname "$0")/.."

step() { printf '\n== %s ==\n' "$*"; }

[ -x .venv/bin/python ] || python3 -m venv .venv
.venv/bin/python -m pip install --quiet --disable-pip-version-check -r python/requirements.txt
rustup --quiet target add x86_64-pc-windows-gnu x86_64-apple-darwin aarch64-apple-darwin aarch64-unknown-linux-gnu

step "Units for linux64 (GLIBC 2.17), win64, darwin64 (universal), aarch64-linux: exports and imports"
cargo xtask pack --platforms all

# The master, which writes every variable of a scenario as CSV, of here and of a target.
master=(--quiet --release --package acroscope-orchestrator --example run_csv)
cargo build "${master[@]}"
master_for() { PATH="$PWD/.venv/bin:$PATH" cargo zigbuild "${master[@]}" --target "$1" --target-dir target/programs; }
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
for scenario in visual-servo full-state; do
    target/release/examples/run_csv "scenarios/$scenario.toml" target/fmus "$out/$scenario.csv" 3
done
same() {
    cmp "$out/$1.csv" "$out/there.csv"
    echo "$1: $(wc -l <"$out/$1.csv") rows, the same bits"
}

step "Windows' units under Wine, against the bits of Linux"
wine=$(command -v wine64 || command -v wine || ls /usr/lib/wine/wine64 2>/dev/null || true)
if [ -z "$wine" ]; then
    echo "SKIPPED: there is no Wine here (apt-get install wine64), so nothing of win64 has run"
else
    master_for x86_64-pc-windows-gnu
    # Wine before 8.13 lacks what Rust asks Windows' bcryptprimitives.dll for; its own generator gives it.
    cat >target/prng.c <<'END'
__declspec(dllimport) unsigned char SystemFunction036(void *, unsigned long);
__declspec(dllexport) int ProcessPrng(void *to, unsigned long long length) { return SystemFunction036(to, (unsigned long)length); }
END
    .venv/bin/python -m ziglang cc -target x86_64-windows-gnu -shared -O1 target/prng.c -ladvapi32 \
        -o target/programs/x86_64-pc-windows-gnu/release/examples/bcryptprimitives.dll
    export WINEPREFIX="$out/wine" WINEDEBUG=-all
    for scenario in visual-servo full-state; do
        "$wine" target/programs/x86_64-pc-windows-gnu/release/examples/run_csv.exe \
            "scenarios\\$scenario.toml" "Z:$PWD/target/fmus" "Z:$out/there.csv" 3
        same "$scenario"
    done
fi

step "ARM's units under QEMU, against the bits of x86-64"
qemu=$(command -v qemu-aarch64-static || command -v qemu-aarch64 || true)
if [ -z "$qemu" ] || [ ! -d /usr/aarch64-linux-gnu ]; then
    echo "SKIPPED: there is no QEMU here (apt-get install qemu-user-static libc6-arm64-cross), so nothing of aarch64-linux has run"
else
    master_for aarch64-unknown-linux-gnu.2.17
    for scenario in visual-servo full-state; do
        "$qemu" -L /usr/aarch64-linux-gnu target/programs/aarch64-unknown-linux-gnu/release/examples/run_csv \
            "scenarios/$scenario.toml" target/fmus "$out/there.csv" 3
        same "$scenario"
    done
fi
