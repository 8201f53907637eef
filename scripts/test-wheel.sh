#!/usr/bin/env bash
# Installs dist/*.whl into bare environments outside the clone, without Rust on the PATH, and runs the Python of its README
# there, then python/tests. Makes the wheel first if there is none (scripts/wheel.sh).
set -euo pipefail
cd "$(dirname "$0")/.."

ls dist/*.whl >/dev/null 2>&1 || scripts/wheel.sh
wheel=$(ls -t "$PWD"/dist/*.whl | head -1)
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
cp -R python/tests python/README.md "$out"
cd "$out"
export PATH=/usr/local/bin:/usr/bin:/bin PYTHONDONTWRITEBYTECODE=1
unset ACROSCOPE_FMUS

echo "== $(basename "$wheel") alone, without an index: README's first Python block, and the command =="
python3 -m venv bare
bare/bin/pip install --quiet --disable-pip-version-check --no-index "$wheel"
bare/bin/python tests/readme.py README.md 1
bare/bin/acroscope run full-state --stop 1 --out command

echo "== With notebook packages: README's Python blocks, and python/tests =="
python3 -m venv full
full/bin/pip install --quiet --disable-pip-version-check "$wheel" -r tests/requirements.txt
full/bin/python tests/readme.py README.md 1 2
full/bin/python -m pytest -q tests
