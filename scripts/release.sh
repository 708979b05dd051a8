#!/usr/bin/env bash
# What a release consists of, below target/release-files, each part tried by itself: the crates as packages, the Python wheel, the program, SHA-256 sums.
#
#   scripts/release.sh                     all, some twenty minutes on two cores
#   scripts/release.sh --quick             the crates without building each from its package: a minute
#
# The wheel is for every Python from 3.10 on (abi3) and for x86-64 Linux with the glibc of this machine or later: its name says which, after maturin has
# looked at what it links (manylinux_2_35 on Debian 12). The program needs no library of the system. Windows and macOS were not tried. Needs python3 with
# venv, and the network once.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

version=$(sed -n 's/^version = "\(.*\)"$/\1/p' Cargo.toml | head -n 1)
triple=x86_64-linux
out="$PWD/target/release-files"
grep -q "^version: $version\$" CITATION.cff || { echo "CITATION.cff has another version than Cargo.toml ($version)"; exit 1; }
grep -q "^publish = false" crates/python/Cargo.toml || { echo "the Python package is no crate to be published"; exit 1; }

packages() { # [--no-verify]
  # Uncommitted changes may be tried out; a release is made of a clean checkout.
  cargo package --workspace --exclude nastic-python --locked --allow-dirty --quiet "$@" 2> >(grep -v -e "no documentation, homepage" -e "^ *|" -e "^  = note" -e "^warning: ignoring" -e '^ *$' >&2)
  mkdir -p "$out/crates"
  cp target/package/*-"$version".crate "$out/crates/"
  echo "crates: $(ls "$out/crates" | wc -l) packages, $(du -sh "$out/crates" | cut -f 1)"
}

wheel() {
  local env="$PWD/target/release-env"
  [ -x "$env/bin/python" ] || python3 -m venv "$env"
  "$env/bin/python" -m pip --disable-pip-version-check --quiet install maturin==1.16.0
  (cd crates/python && "$env/bin/maturin" build --release --quiet --out "$out")
  local tried="$PWD/target/release-tried"
  rm -rf "$tried"
  python3 -m venv "$tried"
  "$tried/bin/python" -m pip --disable-pip-version-check --quiet install "$out"/nastic-"$version"-*.whl scipy meshio pytest
  (cd crates/python/tests && "$tried/bin/python" -m pytest -p no:cacheprovider -q)
}

program() {
  # Static: glibc's own parts within the program.
  cargo rustc --release --locked --quiet -p nastic-cli --bin nastic -- -C target-feature=+crt-static
  local folder="nastic-$version-$triple"
  rm -rf "${out:?}/$folder"
  mkdir -p "$out/$folder"
  cp target/release/nastic README.md CHANGELOG.md LICENSE-MIT LICENSE-APACHE NOTICE CITATION.cff "$out/$folder/"
  strip "$out/$folder/nastic"
  tar -C "$out" -czf "$out/$folder.tar.gz" "$folder"
  ldd "$out/$folder/nastic" 2>&1 | grep -q "statically linked\|not a dynamic" || { echo "the program needs libraries: $(ldd "$out/$folder/nastic")"; exit 1; }
  # Nothing of this shell, nothing but the case and its mesh.
  local place
  place=$(mktemp -d)
  mkdir -p "$place/examples/cases"
  cp -r meshes "$place/"
  cp examples/cases/cantilever_arc.json "$place/examples/cases/"
  (cd "$place" && env -i "$out/$folder/nastic" optimize examples/cases/cantilever_arc.json --out arc --quiet)
  [ -s "$place/arc/report.html" ] || { echo "the program wrote no page"; exit 1; }
  rm -rf "$place" "${out:?}/$folder"
}

rm -rf "$out"
mkdir -p "$out"
if [ "${1:-}" = --quick ]; then
  packages --no-verify
  exit
fi
packages
wheel
program
(cd "$out" && find . -type f ! -name SHA256SUMS -printf '%P\n' | sort | xargs sha256sum >SHA256SUMS && sha256sum --quiet --check SHA256SUMS)
(cd "$out" && du -h -- *.whl *.tar.gz)
echo "$out: all parts were tried"
