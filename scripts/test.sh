#!/usr/bin/env bash
# All tests: unit, integration and documentation tests of every crate, and every example built.
#
#   scripts/test.sh [ARGUMENTS OF cargo test]        scripts/test.sh -p nastic-mesh quadrature
#
# Some tests read results back with Python's vtk, meshio, jsonschema and gmsh. These are installed into target/python when
# python3 is there; without them (no Python, no network) those tests are skipped, and this says so. NASTIC_PYTHON names
# another Python to use. NASTIC_REQUIRE_PYTHON=1 makes a missing one an error.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

imports="import vtk, meshio, jsonschema, gmsh"
venv="$PWD/target/python"

find_python() {
  if [ -n "${NASTIC_PYTHON:-}" ]; then
    "$NASTIC_PYTHON" -c "$imports" && return
    echo "NASTIC_PYTHON is $NASTIC_PYTHON, which cannot import vtk, meshio, jsonschema and gmsh" >&2
    exit 1
  fi
  if "$venv/bin/python" -c "$imports" 2>/dev/null; then
    export NASTIC_PYTHON="$venv/bin/python"
    return
  fi
  if python3 -c "$imports" 2>/dev/null; then
    export NASTIC_PYTHON="$(command -v python3)"
    return
  fi
  command -v python3 >/dev/null || { why="python3 is not installed"; return 1; }
  echo "Installing vtk, meshio, jsonschema and gmsh into target/python (once; about 200 MB) ..."
  mkdir -p target
  local log="target/python.log"
  rm -rf "$venv"
  python3 -m venv "$venv" >"$log" 2>&1 || { why="python3 cannot make a virtual environment, see $log"; return 1; }
  "$venv/bin/python" -m pip install --quiet --disable-pip-version-check -r scripts/requirements.txt >>"$log" 2>&1 ||
    { why="pip could not install them: $(grep -i error "$log" | tail -n 1) (all of it: $log)"; return 1; }
  "$venv/bin/python" -c "$imports" >>"$log" 2>&1 || { why="they do not load, see $log"; return 1; }
  export NASTIC_PYTHON="$venv/bin/python"
}

why=""
if find_python; then
  export PATH="$(dirname "$NASTIC_PYTHON"):$PATH"
  echo "Results are read back with $NASTIC_PYTHON"
elif [ "${NASTIC_REQUIRE_PYTHON:-0}" = 1 ]; then
  echo "FAILED: Python's vtk, meshio, jsonschema and gmsh are required here, but $why" >&2
  exit 1
else
  echo "SKIPPED: the tests that read results back with vtk, meshio, jsonschema and gmsh, because $why"
fi

if [ $# -eq 0 ]; then set -- --workspace; fi
[ -t 1 ] && export CARGO_TERM_COLOR="${CARGO_TERM_COLOR:-always}"
log="target/test.log"
mkdir -p target
status=0
cargo test --locked --no-fail-fast "$@" 2>&1 | tee "$log" || status=$?

# One closing line over all test programs.
sed 's/\x1b\[[0-9;]*m//g' "$log" | awk '
  /^test result: / { passed += $4; failed += $6; skipped += $8 }
  END { printf "%d passed, %d failed, %d skipped\n", passed, failed, skipped }' >target/test.summary
echo && cat target/test.summary
exit "$status"
