#!/usr/bin/env bash
# Measures speed beside the peers in one run, prints the table and writes docs/speed.md. Installs what it needs.
# ACROSCOPE_FEEDTHROUGH: the Feedthrough.fmu of the FMI project's reference units, measured too if it is given.
# Arguments: sections (frame, master, isolated, loop, sweep, estimator, diagnosis); with any, the page is not written.
set -euo pipefail
cd "$(dirname "$0")/.."

if [ -z "${ACROSCOPE_PYTHON:-}" ]; then
    [ -x .venv/bin/python ] || python3 -m venv .venv
    .venv/bin/python -m pip install --quiet --disable-pip-version-check -r scripts/peers/requirements.txt
fi
[ -n "${ACROSCOPE_FMUS:-}" ] || cargo xtask pack
exec cargo bench --quiet -p benches -- "$@"
