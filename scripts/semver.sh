#!/usr/bin/env bash
# Whether the crates that are for others still offer what they did at the last release (the newest tag v*, or the commit given),
# as far as their version promises it: cargo-semver-checks compares the two interfaces item by item.
set -euo pipefail
cd "$(dirname "$0")/.."

crates=(fmi2-export acroscope-orchestrator)
since=${1:-$(git describe --tags --abbrev=0 --match 'v*' 2>/dev/null || true)}
if [ -z "$since" ]; then
    since=HEAD
    echo "no release yet, so nothing is promised: this tree is compared with its last commit, to try the tool; type $0 COMMIT for another"
fi
command -v cargo-semver-checks >/dev/null || { echo "error: type cargo install cargo-semver-checks --locked"; exit 1; }
broken=()
for crate in "${crates[@]}"; do
    CARGO_TARGET_DIR=target/semver cargo semver-checks --package "$crate" --baseline-rev "$since" || broken+=("$crate")
done
[ ${#broken[@]} = 0 ] || { echo "error: the version of ${broken[*]} promises more than is kept since $since"; exit 1; }
