#!/usr/bin/env bash
# Counts the instructions of fixed work with callgrind and compares them with benches/instructions.txt: a regression
# shows on any machine, however busy. `--update` writes the counts anew. Needs valgrind; some 30 s after the build.
#
# The tolerance is 3 %: the same program counts the same to 0.01 %, but another version of the C library or of the
# compiler moves single functions by a percent or two; so does CARGO_INCREMENTAL=1, which is turned off here. Valgrind
# hides AVX-512, so that it is the AVX2 paths that count. The temporary folder is an empty one, since the first unit that
# is opened sweeps it: a thousand files in it are 0.8 million instructions.
set -euo pipefail
cd "$(dirname "$0")/.."
TMPDIR=$(mktemp -d)
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT

file=benches/instructions.txt
tolerance_percent=3
works=(a b16 c d master mixed texts plant large)
# Short runs of the closed loop need the packed units (cargo xtask pack).
if [ -n "${ACROSCOPE_FMUS:-}" ] || [ -d target/fmus ]; then works+=(opening again runs); fi

CARGO_INCREMENTAL=0 cargo build --quiet --release -p benches --bin counted
collected() {
    valgrind --tool=callgrind --callgrind-out-file=/dev/null target/release/counted "$1" 2>&1 |
        sed -n 's/.*Collected : \([0-9]*\).*/\1/p'
}
# What comes after the opening, which grows with the units' files: a second run, before which each unit is tried for its reset, and
# twenty more.
count() {
    case "$1" in
        again) echo $(($(collected again) - $(collected opening))) ;;
        runs) echo $(($(collected runs) - $(collected again))) ;;
        *) collected "$1" ;;
    esac
}

if [ "${1:-}" = --update ]; then
    head='# Instructions of benches/src/counted.rs; written by scripts/instructions.sh --update, which keeps the reasons behind #.'
    lines=("$head")
    for work in "${works[@]}"; do
        reason=$(sed -n "s/^$work [0-9]*//p" "$file")
        lines+=("$work $(count "$work")$reason")
        echo "${lines[-1]}"
    done
    printf '%s\n' "${lines[@]}" >"$file"
    exit
fi

failed=0
for work in "${works[@]}"; do
    expected=$(awk -v work="$work" '$1 == work { print $2 }' "$file")
    found=$(count "$work")
    awk -v work="$work" -v found="$found" -v expected="$expected" -v most="$tolerance_percent" 'BEGIN {
        change = 100 * (found / expected - 1)
        printf "%-8s %12d, expected %12d: %+.2f %%\n", work, found, expected, change
        if (change > most) { print "  more than " most " % more: a regression"; exit 1 }
        if (change < -most) print "  much less: scripts/instructions.sh --update keeps what was gained"
    }' || failed=1
done
exit $failed
