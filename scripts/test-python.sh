#!/usr/bin/env bash
# Installs the Python package into an environment of its own, by the documented command, and runs its tests.
#
#   scripts/test-python.sh [ARGUMENTS OF pytest]        scripts/test-python.sh -k scipy
#
# Needs python3 with venv, and the network once. The build is that of users (release) and shares target/release. JAX, PyTorch, PyVista and Dask are
# tested where NASTIC_PYTHON_EXTRA names them: NASTIC_PYTHON_EXTRA="jax torch pyvista dask[distributed]" scripts/test-python.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

venv="$PWD/target/python-package"
requirements=(numpy scipy meshio pytest)
notebooks=(nbclient ipykernel matplotlib) # what runs docs/notebooks

[ -x "$venv/bin/python" ] || python3 -m venv "$venv"
pip() { "$venv/bin/python" -m pip --disable-pip-version-check --quiet "$@"; }
# shellcheck disable=SC2086 # a list of packages
pip install "${requirements[@]}" ${NASTIC_PYTHON_EXTRA:-}
pip install "${notebooks[@]}" || echo "SKIPPED: the notebooks of docs/notebooks, because ${notebooks[*]} cannot be installed"
pip install ./crates/python
# Not from the checkout: what is tested is what was installed.
cd crates/python/tests
exec "$venv/bin/python" -m pytest -p no:cacheprovider -q -rs "$@"
