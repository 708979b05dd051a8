#!/usr/bin/env bash
# One body over the ranks of MPI, solved by PETSc: the fibre cantilever on 1, 2, 3 and 4 ranks against the digits of other codes, the gradient against
# that of one process and against differences, optimisations of its tension against those of one process.
#
#   scripts/test-petsc.sh
#
# Needs PETSc with real numbers and Open MPI (Debian: petsc-dev, libopenmpi-dev); without them nothing is tested, which is said.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

library="lib${PETSC_LIB:-petsc_real}.so"
if ! command -v mpirun > /dev/null || ! ls "${PETSC_LIB_DIR:-/usr/lib/$(uname -m)-linux-gnu}/$library" > /dev/null 2>&1; then
  echo "skipped: nastic-petsc (no mpirun, or no $library: install petsc-dev and libopenmpi-dev)"
  exit 0
fi
export CARGO_TARGET_DIR="$PWD/target/petsc"
cargo test --release --locked --quiet --manifest-path petsc/Cargo.toml --lib || exit 1
cargo build --release --locked --quiet --manifest-path petsc/Cargo.toml --examples || exit 1
# MPI ranks share the processors: no threads of BLAS beside them.
export OPENBLAS_NUM_THREADS=1
root=()
[ "$(id -u)" = 0 ] && root=(--allow-run-as-root)

python3 - "$CARGO_TARGET_DIR/release/examples" "${root[@]}" <<'PYTHON'
import json, math, os, subprocess, sys, tempfile

sys.path.insert(0, "scripts")
from cantilever_tips import CLOSE, DIGITS, off

programs, *root = sys.argv[1:]
failed = 0


def run(ranks, *arguments, program="cantilever", most=300):
    command = ["mpirun", *root, "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "-n", str(ranks), f"{programs}/{program}"]
    done = subprocess.run([*command, *map(str, arguments)], capture_output=True, text=True, timeout=most)
    return json.loads(done.stdout) if done.returncode == 0 else {"error": done.stderr}


def note(name, right, said=""):
    global failed
    failed += not right
    print(f"{'ok     ' if right else 'FAILED '} {name} {said}", flush=True)


for kind, n in DIGITS:
    serial = run(1, kind, n, 1.0, "serial")
    for ranks in 1, 2, 3, 4:
        found = run(ranks, kind, n)
        if "error" in found:
            note(f"{kind} {n} on {ranks}", False, found["error"])
            continue
        digits = off(found["tip"], kind, n)
        slope = abs(found["slope"] / serial["slope"] - 1)
        said = f"{found['newton']} Newton, {found['iterations']} CG iterations, tip off by {digits:.0e}, gradient by {slope:.0e}"
        note(f"{kind} {n} on {ranks}", digits < CLOSE and slope < 1e-8, said)

# remainders of the cost by the tension fall with the square of the step
steps = 4e-2, 2e-2
at = run(3, "hex8", 2, 0.7)
remainder = [abs(run(3, "hex8", 2, 0.7 + h)["cost"] - at["cost"] - h * at["slope"]) for h in steps]
order = math.log(remainder[0] / remainder[1]) / math.log(2)
note("Taylor order on 3", order > 1.95, f"{order:.3f}")

# ten iterations, which end at the cost of one process, with the same bits on all ranks; five of "shared", whose runs
# part afterwards: 5e-10 of the costs after five iterations, 2e-3 after ten, for systems are solved to the accuracy asked
for cost, iterations in ("tracking", 10), ("sprung", 10), ("shared", 5), ("hausdorff", 10):
    serial = run(1, cost, 2, iterations, "serial", program="optimise")
    for ranks in 1, 2, 3:
        with tempfile.TemporaryDirectory() as directory:
            found = run(ranks, cost, 2, iterations, directory, program="optimise")
            parts = [name for name in sorted(os.listdir(directory)) if name.endswith(".vtu")]
            index = os.path.join(directory, "optimised.pvtu")
            written = os.path.exists(index) and len(parts) == ranks and all(name in open(index).read() for name in parts)
        if "error" in found or "error" in serial:
            note(f"optimisation, {cost}, on {ranks}", False, found.get("error", serial.get("error")))
            continue
        start, size, end = (abs(found[key] / serial[key] - 1) for key in ("start", "size", "cost"))
        right = start < 1e-9 and size < 1e-8 and end < 1e-6 and found["same"] == ranks and written
        said = f"{found['iterations']} iterations, start off by {start:.0e}, gradient by {size:.0e}, end by {end:.0e}"
        note(f"optimisation, {cost}, on {ranks}", right, said)

few, many = (run(ranks, "hex8", 6) for ranks in (1, 8))
ratio = (many["iterations"] / many["systems"]) / (few["iterations"] / few["systems"])
note("CG iterations on 8 ranks over those on 1", ratio < 1.3, f"{ratio:.2f}")
for name, options in {
    "hypre": ["-nastic_pc_type", "hypre"],
    "MUMPS": ["-nastic_pc_type", "cholesky", "-nastic_pc_factor_mat_solver_type", "mumps"],
}.items():
    found = run(2, "hex8", 2, 1.0, *options)
    right = "tip" in found and off(found["tip"], "hex8", 2) < CLOSE
    note(f"{name} on 2", right, found.get("error", ""))

# a column shortened beyond buckling: its negative eigenvalues
for ranks in 1, 2, 3:
    found = run(ranks, program="column")
    right = "negative" in found and 0 < found["negative"] == found["expected"]
    note(f"negative eigenvalues on {ranks}", right, found.get("negative", found.get("error")))
    for kind in [], ["jacobi"], ["hypre"], ["cholesky", "-nastic_pc_factor_mat_solver_type", "mumps"]:
        options = ["-nastic_pc_type", *kind] if kind else []
        ended = run(ranks, *options, program="column").get("ended", "")
        note(f"indefinite with {' '.join(kind[:1]) or 'gamg'} on {ranks}", "positive definite" in ended, ended)
for how in "fail", "panic":
    try:
        ended = run(3, how, program="column", most=60).get("error", "it went on")
    except subprocess.TimeoutExpired:
        ended = "the others wait"
    note(f"a rank that does {how} ends the job", "as it was told" in ended, ended[:70])
for option, value in {"-nastic_ksp_type": "gmres", "-nastic_pc_type": "lu"}.items():
    ended = run(1, option, value, program="column").get("ended", "")
    note(f"{value} is refused", option in ended, ended)
sys.exit(failed > 0)
PYTHON
