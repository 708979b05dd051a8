#!/usr/bin/env bash
# Every shipped case and every example program, in release, held to its expected numbers; optimisations killed at random moments.
#
#   scripts/slow.sh [--quick]        --quick: those that take less than 15 s each on two idle cores and are not run by
#                                    the tests as they stand, as .ci/run does
#
# Cases carry their numbers themselves (`expect`); what the programs must say stands below. All of it also runs the tests that are
# larger here than per change: kills, and the adjoints of long motions.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

quick=0
[ "${1:-}" = --quick ] && quick=1
out=target/slow
# A run that was cut short left checkpoints, which an optimisation does not replace unasked.
rm -rf "$out"/case_* "$out"/new_* "$out"/template_*
mkdir -p "$out"
: >"$out/failed"

# Longer than 15 s; the others are run by --quick too. What crawler and flick show in small is in grasp, shaken and the tests of motions and contact.
slow_cases=(petal walk lift lift_block carry gripper_lift crawler flick level t_two_loads saddle two_silicones compliant_gripper)
# These end at their limit of iterations, exit code 4.
limited_cases=(walk lift crawler carry)
slow_examples=(robust_turgor t_magnet petal)

is_in() { # WORD LIST...
  local word="$1" other
  shift
  for other in "$@"; do [ "$word" = "$other" ] && return 0; done
  return 1
}

# What tests/cases.rs and tests/examples.rs run unchanged, and hold to the same numbers.
is_tested_case() { # NAME
  # a page whose commands crates/cli/tests/tutorials.rs runs, expectations and all
  grep -qE "^nastic optimize examples/cases/$1\.json --out out/$1\$" docs/tutorials/*.md && return
  grep -qF "= shipped_case(\"$1.json\")" crates/run/tests/identify.rs && return
  grep -qE "met\(\"$1\"\)|shipped\(\"$1\.json\"\), \"$1\", &\[\]" tests/cases.rs
}

is_tested_example() { # NAME
  grep -q "run(\"$1\", &\[\])" tests/examples.rs
}

run() { # NAME COMMAND...
  local name="$1" began=$SECONDS
  shift
  if "$@"; then
    printf '%5d s  %s\n' $((SECONDS - began)) "$name"
  else
    printf '%5d s  FAILED: %s\n' $((SECONDS - began)) "$name"
    echo "$name" >>"$out/failed"
  fi
}

# With --quick as many at a time as there are cores, each on one thread.
run_one_of_many() { # NAME COMMAND...
  [ "$quick" = 0 ] && { run "$@"; return; }
  while [ "$(jobs -rp | wc -l)" -ge "$(nproc)" ]; do wait -n; done
  RAYON_NUM_THREADS=1 run "$@" &
}

# Exit code 0; 6 is a missed expectation.
case_met() { # NAME
  local file="examples/cases/$1.json" command=optimize status=0
  grep -q '"expect"' "$file" || { echo "$file has no \"expect\""; return 1; }
  grep -q '"command": "solve"' "$file" && command=solve
  grep -q '"command": "identify"' "$file" && command=identify
  grep -q '"command": "gains"' "$file" && command=gains
  target/release/nastic "$command" "$file" --quiet --out "$out/case_$1" || status=$?
  if [ "$status" != 0 ]; then
    [ "$status" = 4 ] && is_in "$1" "${limited_cases[@]}" || return
  fi
  [ "$(wc -c <"$out/case_$1/report.html")" -lt 5000000 ] || { echo "the page of $1 has 5 MB or more"; return 1; }
  [ "$1" != arch ] || target/release/nastic solve "$file" --path --quiet --out "$out/case_arch_path"
}

# What `nastic new` writes, optimised: for the gallery.
template_met() { # NAME
  target/release/nastic new "$out/new_$1" --template "$1" >/dev/null || return
  target/release/nastic optimize "$out/new_$1/new_$1.json" --quiet --out "$out/template_$1"
}

# The number that stands after the last occurrence of a text, held between two bounds.
between() { # FILE TEXT LEAST MOST
  awk -v text="$2" -v least="$3" -v most="$4" '
    { at = index($0, text); if (at) { rest = substr($0, at + length(text)); found = rest + 0; seen = 1 } }
    END {
      if (!seen) { print "no \"" text "\" in the output"; exit 1 }
      if (found < least || found > most) { print text found " is not in [" least ", " most "]"; exit 1 }
    }' "$1"
}

example_met() { # NAME
  local log="$out/example_$1.log"
  "target/release/examples/$1" >"$log" || return
  case "$1" in
    shortest) between "$log" "cost " 0.1352 0.1362 ;;
    air_finger) between "$log" "free: " 41669 41689 ;;
    own_cost) between "$log" "with the table: cost " 0 0.05 && grep -q "verdict: right" "$log" ;;
    own_energy) between "$log" "tracking cost " 0 1e-6 && grep -q "verdict: right" "$log" ;;
    tip_tracking) between "$log" "cost " 0 2.4e-8 ;;
    turgor_stem) between "$log" "mm -> " 0.7 0.9 ;;
    robust_turgor) between "$log" "saved in pairs: " 3.5 6.5 ;;
    t_magnet) between "$log" "start 0: cost 2.341e-3 -> " 0 2.34e-6 ;;
    fiber_cantilever) between "$log" "m -> " 0 0.03 ;;
    known_control) between "$log" "m -> " 0 0.01 ;;
    petal) between "$log" " -> " 0 5.26e-8 && between "$log" "negative pivots: " 0 0 ;;
    *) echo "no expected number for the example $1: give it one in scripts/slow.sh"; return 1 ;;
  esac
}

# The whole workspace, as tests are built: each `-p` has other features of dependencies, with which all would be compiled again.
cargo build --release --workspace --locked --quiet --bins --examples || exit 1
for file in examples/cases/*.json; do
  name=$(basename "$file" .json)
  [ "$quick" = 1 ] && { is_in "$name" "${slow_cases[@]}" || is_tested_case "$name"; } && continue
  run_one_of_many "case $name" case_met "$name"
done
if [ "$quick" = 0 ]; then
  for file in crates/language/templates/*.json; do
    name=$(basename "$file" .json)
    run "template $name" template_met "$name"
  done
fi
for file in examples/*.rs; do
  name=$(basename "$file" .rs)
  [ "$quick" = 1 ] && { is_in "$name" "${slow_examples[@]}" || is_tested_example "$name"; } && continue
  run_one_of_many "example $name" example_met "$name"
done
wait
# Random problems of contact against an independent judge: two of each family, or all.
battery() { cargo bench --workspace --locked --quiet --bench contact_battery -- "$@"; }
run "24 random problems of contact" battery count=2 failures=1
if [ "$quick" = 0 ]; then
  run "420 random problems of contact" battery count=35 failures=1
  run "every check of their judge fails where an answer is wrong" battery spoil=1 count=3
  # Optimisations killed at random moments; the tests do it 10 times.
  NASTIC_KILLS=30 run "30 kills and stops of motions" cargo test --release --workspace --locked --quiet --test all stopped_motions::
  NASTIC_KILLS=200 run "200 kills of each kind of case" cargo test --release --workspace --locked --quiet --test all resume::
  # What of docs/clusters.md needs Dask or Snakemake.
  NASTIC_PYTHON_EXTRA="dask[distributed] snakemake" run "sweeps under Dask" scripts/test-python.sh -k "sweep or clusters"
  PATH="$PWD/target/python-package/bin:$PATH" run "a sweep under Snakemake" \
    cargo test --release --workspace --locked --quiet --test all clusters::
  if command -v mpirun >/dev/null && command -v mpicc >/dev/null; then
    run "nastic-mpi on 1 to 7 ranks, and killed" scripts/mpi.sh
  else
    echo "skipped: nastic-mpi (scripts/mpi.sh), there is no mpirun or no mpicc"
  fi
  run "nastic-mpi and nastic-petsc on several hosts, where root and Open MPI are" scripts/hosts.sh
  run "nastic-petsc on 1 to 8 ranks, where there is PETSc" scripts/test-petsc.sh
  run "the container recipe, where docker or mmdebstrap is" scripts/test-container.sh
  NASTIC_SLOW=1 run "pressures between bodies" cargo test --release --workspace --locked --quiet --test all body_pressures::
  NASTIC_SLOW=1 run "surfaces of further cells" cargo test --release --workspace --locked --quiet --test all surface_contact::
  NASTIC_SLOW=1 run "starts that were interrupted" cargo test --release --workspace --locked --quiet --test all starts::
  NASTIC_SLOW=1 run "adjoints of long motions" cargo test --release --workspace --locked --quiet --test all motion_adjoint::
fi
[ ! -s "$out/failed" ] && echo "all as expected" && exit 0
sed 's/^/FAILED: /' "$out/failed"
exit 1
