#!/usr/bin/env bash
# Installs dist/*.whl into bare environments outside the clone, without Rust on the PATH, and runs the Python of the READMEs
# there, then python/tests; looks at what its libraries ask of the machine. Makes the wheel first if there is none (scripts/wheel.sh).
set -euo pipefail
cd "$(dirname "$0")/.."

ls dist/*.whl >/dev/null 2>&1 || scripts/wheel.sh
wheel=$(ls -t "$PWD"/dist/*.whl | head -1)
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
cp -R python/tests python/README.md "$out"
cp README.md "$out/clone.md"
cd "$out"
export PATH=/usr/local/bin:/usr/bin:/bin PYTHONDONTWRITEBYTECODE=1
unset ACROSCOPE_FMUS

echo "== $(basename "$wheel") alone, without an index: README's first Python block, and the command =="
python3 -m venv bare
bare/bin/pip install --quiet --disable-pip-version-check --no-index "$wheel"
bare/bin/python tests/readme.py README.md 1
bare/bin/acroscope run full-state --stop 1 --out command

echo "== README's Python block of the clone =="
bare/bin/python tests/readme.py clone.md 1

echo "== What the libraries for Linux ask of GLIBC =="
python3 -m zipfile -e "$wheel" unpacked
for fmu in unpacked/acroscope/data/fmus/*.fmu; do python3 -m zipfile -e "$fmu" "unpacked/$(basename "$fmu" .fmu)"; done
find unpacked -path '*aarch64*' -prune -o -name '*.so' -exec objdump -T {} + >symbols
newest=$(grep --only-matching 'GLIBC_[0-9.]*' symbols | sort -uV | tail -1)
echo "$newest"
[ "$(printf 'GLIBC_2.17\n%s\n' "$newest" | sort -V | tail -1)" = GLIBC_2.17 ] || { echo "error: newer than 2.17"; exit 1; }
# Of no version at all is what GLIBC 2.17 hasn't: a linker lets it pass in a shared library. Weak ones may be missing.
later=$(awk '/\*UND\*/ && $2 != "w" && !/(GLIBC|GCC)_/ && $NF !~ /^_?Py/ { print $NF }' symbols | sort -u)
[ -z "$later" ] || { echo "error: GLIBC 2.17 lacks $later"; exit 1; }

echo "== With notebook packages: README's Python blocks, and python/tests =="
python3 -m venv full
full/bin/pip install --quiet --disable-pip-version-check "$wheel" -r tests/requirements.txt
full/bin/python tests/readme.py README.md 1 2
full/bin/python -m pytest -q tests
