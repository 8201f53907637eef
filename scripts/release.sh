#!/usr/bin/env bash
# Makes and checks the files of a release in dist/: the wheel with units for all platforms, and for each platform an archive
# with the program (bin/acroscope) and what it needs (share/acroscope). Takes an hour on two cores.
set -euo pipefail
cd "$(dirname "$0")/.."

version=$(cargo metadata --no-deps --format-version 1 | python3 -c \
    'import json, sys; print(next(p["version"] for p in json.load(sys.stdin)["packages"] if p["name"] == "acroscope"))')
rm -rf dist
./scripts/platforms.sh
./scripts/wheel.sh all
./scripts/test-wheel.sh
./scripts/crates.sh

# FMI's name of the platform, zig's target, the folder cargo puts it in, the program's ending.
for line in "linux64 x86_64-unknown-linux-gnu.2.17 x86_64-unknown-linux-gnu -" \
    "aarch64-linux aarch64-unknown-linux-gnu.2.17 aarch64-unknown-linux-gnu -" \
    "win64 x86_64-pc-windows-gnu x86_64-pc-windows-gnu .exe" \
    "darwin64 universal2-apple-darwin universal2-apple-darwin -"; do
    read -r platform target folder ending <<<"$line"
    PATH="$PWD/.venv/bin:$PATH" MACOSX_DEPLOYMENT_TARGET=11.0 \
        CARGO_TARGET_AARCH64_APPLE_DARWIN_RUSTFLAGS="-Lframework=$PWD/scripts/darwin" \
        CARGO_TARGET_X86_64_APPLE_DARWIN_RUSTFLAGS="-Lframework=$PWD/scripts/darwin" cargo zigbuild --quiet --release --package acroscope \
        --target "$target" --target-dir target/programs
    name=acroscope-$version-$platform
    rm -rf "target/archives/$name"
    mkdir -p "target/archives/$name/bin" "target/archives/$name/share/acroscope/fmus"
    cp "target/programs/$folder/release/acroscope${ending#-}" "target/archives/$name/bin"
    cp target/fmus/*.fmu "target/archives/$name/share/acroscope/fmus"
    cp -R examples docs README.md CHANGELOG.md NOTATION.md LICENSE-MIT LICENSE-APACHE "target/archives/$name"
    if [ "$platform" = win64 ]; then
        (cd target/archives && python3 -m zipfile -c "../../dist/$name.zip" "$name")
    else
        tar -C target/archives --sort=name --mtime=@315532800 --owner=0 --group=0 --numeric-owner -czf "dist/$name.tar.gz" "$name"
    fi
done
(cd dist && sha256sum -- * >SHA256SUMS)
ls -l dist
