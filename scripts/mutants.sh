#!/usr/bin/env bash
# What faults the tests let through: cargo-mutants changes one thing at a time (a sign, a limit, an answer) and runs the
# tests of the crate that it is in. A nightly job, a shard a night or a machine:
#
#   scripts/mutants.sh 3/12                       # the fourth of twelve parts of all mutants
#   scripts/mutants.sh 0/1 fmus/plant/src/effects/delay.rs      # all mutants of chosen files
#
# Prints the counts and each mutant that no test noticed; ends with status 1 where less than 95 % were. Those that change
# nothing that can be seen are listed in scripts/mutants-equal.txt, a regular expression a line, with the reason above it.
set -euo pipefail
cd "$(dirname "$0")/.."

shard=${1:-0/1}
shift || true
packages=(mechanics fmi2-export plant camera controller residual signal-effects)
goal=95
out=${ACROSCOPE_MUTANTS:-target/mutants}

cargo mutants --version >/dev/null 2>&1 || cargo install cargo-mutants --locked
cargo nextest --version >/dev/null 2>&1 && tool=nextest || tool=cargo

arguments=(--shard "$shard" --output "$out" --no-shuffle --test-tool "$tool" --timeout-multiplier 5 --minimum-test-timeout 60)
arguments+=(--jobs "${ACROSCOPE_JOBS:-1}" --cargo-arg=--release --colors never)
if [ $# -gt 0 ]; then
    for file in "$@"; do arguments+=(--file "$file"); done
else
    for package in "${packages[@]}"; do arguments+=(--package "$package"); done
fi
while IFS= read -r line; do
    case $line in '' | '#'*) ;; *) arguments+=(--exclude-re "$line") ;; esac
done <scripts/mutants-equal.txt

rm -rf "$out"
mkdir -p "$out"
cargo mutants "${arguments[@]}" || [ -s "$out/mutants.out/outcomes.json" ]

cd "$out/mutants.out"
count() { grep -c . "$1.txt" || true; }
caught=$(($(count caught) + $(count timeout)))
missed=$(count missed)
printf '\n%s caught, %s missed, %s that do not build\n' "$caught" "$missed" "$(count unviable)"
cat missed.txt
[ $((caught * 100)) -ge $(((caught + missed) * goal)) ]
