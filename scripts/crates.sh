#!/usr/bin/env bash
# Whether the crates that are for others can be published: `cargo package` builds each from its own archive, and the
# archive holds its README and both licences.
set -euo pipefail
cd "$(dirname "$0")/.."

crates=(fmi2-export acroscope-orchestrator)
for crate in "${crates[@]}"; do
    cargo package --quiet --package "$crate" --target-dir target/package-build "$@"
    archive=$(ls -t target/package-build/package/"$crate"-*.crate | head -1)
    holds=$(tar -tzf "$archive")
    for file in README.md LICENSE-MIT LICENSE-APACHE; do
        grep --quiet "/$file\$" <<<"$holds" || { echo "error: $archive lacks $file"; exit 1; }
    done
    [ "$(tar -xzOf "$archive" --wildcards '*/LICENSE-APACHE' | grep --count 'Apache License')" -gt 0 ] ||
        { echo "error: LICENSE-APACHE in $archive is not that licence's text"; exit 1; }
    echo "$(basename "$archive"): $(wc -l <<<"$holds") files, $(stat -c %s "$archive") bytes, builds by itself"
done
