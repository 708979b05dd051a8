# What scripts/mpi.sh and scripts/hosts.sh share, to be sourced: cases as arguments of nastic, and how runs are compared and noted.

cases=examples/cases
short=(--set expect={})

# Eight scenarios, a checkpoint behind every iteration: what is interrupted.
long=(optimize $cases/robust_turgor.json "${short[@]}" --set optimizer/max_iterations=12 --set optimizer/tolerance=1e-12 --set output/checkpoint=1)

# Five scenarios of one motion, of which some take longer: members that move between ranks at checkpoints are solved again where they go.
motion=(optimize $cases/flick.json "${short[@]}" --set optimizer/max_iterations=5 --set output/checkpoint=2
  --set 'mesh/box/cells=[5,1,1]' --set 'time/end=120 ms' --set 'time/step=10 ms' --set 'time/output=40 ms'
  --set 'controls/0/in_time/every=40 ms' --set 'costs/0/when={"at":["100 ms","120 ms"]}'
  --set 'scenarios=[{"set":{"materials/0/young":"0.25 MPa"}},{"set":{"materials/0/density":"900 kg/m^3"}},{"set":{"materials/0/young":"0.4 MPa"}},{"set":{"materials/0/density":"1200 kg/m^3"}},{"set":{"materials/0/maxwell/0/shear":"80 kPa"}}]')

# The longest that a run in the foreground may take; one that takes longer ends with 124.
within=(timeout --foreground --kill-after 10 400)

failed=()
skipped=()
tests=0
declare -A codes # exit codes of one process, by folder

note() { # NAME STATUS
  tests=$((tests + 1))
  if [ "$2" = 0 ]; then echo "ok      $1"; else echo "FAILED  $1" && failed+=("$1"); fi
}

leave_out() { # NAME WHY
  echo "skipped: $1 ($2)"
  skipped+=("$1")
}

# Only the parts that there are, and one at least.
check_parts() { # WANTED KNOWN
  local part
  for part in $1; do
    [[ " $2 " == *" $part "* ]] || { echo "PARTS: there is no part \"$part\"; there are $2" >&2 && exit 2; }
  done
  [ -n "${1// /}" ] || { echo "PARTS: name at least one of $2" >&2 && exit 2; }
}

wanted() { [[ " $parts " == *" $1 "* ]]; }

# What one process finds. An optimisation ends with 0, or with 4 at its limit of iterations.
reference() { # FOLDER ARGUMENTS...
  local folder="$1"
  shift
  "${within[@]}" "$nastic" "$@" --threads 2 --quiet --out "$folder" 2>"$folder.log"
  codes[$folder]=$?
  [[ "${codes[$folder]}" == [04] ]] || note "$(basename "$folder") in one process: exit code ${codes[$folder]}" 1
}

# Whether a run ended with the exit code of one process, and has its bits.
same() { # ONE_PROCESS FOLDER EXIT_CODE
  if [ "$3" != "${codes[$1]}" ]; then
    echo "        exit code $3, of one process ${codes[$1]}"
    return 1
  fi
  python3 scripts/same-results.py "$1" "$2"
}

# How all of it ended; without any test there is no success to speak of.
finish() { # SUCCESS
  if [ "${#failed[@]}" != 0 ]; then
    printf 'FAILED: %s\n' "${failed[@]}"
    exit 1
  fi
  if [ "$tests" = 0 ]; then echo "nothing was tested"; else echo "$1"; fi
  [ "${#skipped[@]}" = 0 ] || printf 'skipped: %s\n' "${skipped[@]}"
  exit 0
}
