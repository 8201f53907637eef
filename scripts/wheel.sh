#!/usr/bin/env bash
# Makes dist/acroscope-*.whl for Linux with GLIBC 2.17 or newer (manylinux2014; maturin checks it): the Python module, the
# command, units, scenarios and examples. Needs Rust and Python 3.11. Argument: platforms of the units inside, as for
# `cargo xtask pack --platforms` (default linux64; a release has all).
set -euo pipefail
cd "$(dirname "$0")/.."
platforms=${1:-linux64}

[ -x .venv/bin/python ] || python3 -m venv .venv
.venv/bin/python -m pip install --quiet --disable-pip-version-check -r python/requirements.txt

cargo xtask pack --platforms "$platforms" >/dev/null

data=python/acroscope/data
rm -rf "$data"
mkdir -p "$data/fmus" "$data/scenarios"
cp target/fmus/*.fmu "$data/fmus"
cp scenarios/*.toml "$data/scenarios"
rm "$data/scenarios/Cargo.toml"
cp -R examples "$data/examples"
# Pages link to others of the repository, and units there were made for one machine.
find "$data/examples" \( -name '*.md' -o -name '*.fmu' \) -delete

# Only the module itself is linked for old machines, so that all else is shared with the ordinary build.
linker=$PWD/target/zig-cc-$(uname -m)
cat >"$linker" <<EOF
#!/bin/sh
exec "$PWD/.venv/bin/python" -m ziglang cc -target $(uname -m)-linux-gnu.2.17 "\$@"
EOF
chmod +x "$linker"
(cd python && ../.venv/bin/maturin build --quiet --release --strip --compatibility manylinux2014 --target-dir ../target \
    --out ../dist -- -C "linker=$linker")
ls -l dist/*.whl
