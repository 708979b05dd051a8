#!/usr/bin/env bash
# Makes the vendored libraries of the report again, from the packages of npm that package-lock.json names by version and
# checksum, and says whether they are those of SHA256SUMS. Needs node and npm.
#
#   crates/report/vendor/make.sh            compares
#   crates/report/vendor/make.sh --write    replaces the files and their checksums: after a change of package.json
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$here"/package.json "$here"/package-lock.json "$here"/three.entry.js "$work"
cd "$work"

# esbuild's own program comes with its package: no script of a package is run.
npm ci --ignore-scripts --no-audit --no-fund --silent
mkdir made
node_modules/.bin/esbuild three.entry.js --bundle --minify --format=iife --global-name=THREE --target=es2020 \
  --legal-comments=inline --log-level=warning --outfile=made/three.min.js
cp node_modules/uplot/dist/uPlot.iife.min.js made/uPlot.min.js
cp node_modules/uplot/dist/uPlot.min.css made/uPlot.min.css
cp node_modules/three/LICENSE made/three.LICENSE
cp node_modules/uplot/LICENSE made/uPlot.LICENSE
(cd made && sha256sum -- * >SHA256SUMS)

if [ "${1:-}" = --write ]; then
  cp made/* "$here"
  echo "written"
else
  diff "$here/SHA256SUMS" made/SHA256SUMS && echo "The vendored files are those that npm's packages give."
fi
