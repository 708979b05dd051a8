#!/usr/bin/env bash
# nastic-mpi on the ranks of MPI against nastic alone: the same bits for 1, 2, 3, 4 and 7 ranks, ranks that are killed, and what resumes.
#
#   scripts/mpi.sh [KILLS [SEED]]        KILLS: moments at which a rank is killed, 20 if absent
#   PARTS="motion starts" scripts/mpi.sh    some parts alone, of robust_turgor, load_cases, motion, risk_and_constraints, starts, slurm, faults
#
# Needs mpirun, mpicc and libclang (Debian: libopenmpi-dev or libmpich-dev, libclang-dev). Where both libraries are installed:
#
#   MPIRUN=mpirun.mpich MPICC=mpicc.mpich scripts/mpi.sh
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

kills=${1:-20}
all="robust_turgor load_cases motion risk_and_constraints starts slurm faults"
parts=${PARTS-$all}
. scripts/mpi-cases.sh
check_parts "$parts" "$all"
RANDOM=${2:-1}
mpirun=${MPIRUN:-mpirun}
library=mpich
"$mpirun" --version 2>&1 | grep -q "Open MPI" && library=openmpi
out="$PWD/target/mpi_runs_$library"
export CARGO_TARGET_DIR="$PWD/target"
rm -rf "$out"
mkdir -p "$out"

cargo build --release --workspace --locked --quiet --bins || exit 1
cargo build --release --locked --quiet --manifest-path mpi/Cargo.toml --target-dir "target/mpi_$library" || exit 1
nastic=target/release/nastic
program="target/mpi_$library/release/nastic-mpi"

options=()
if [ "$library" = openmpi ]; then
  # More ranks than processors, which give way while they wait.
  options=(--oversubscribe --mca mpi_yield_when_idle 1)
  [ "$(id -u)" = 0 ] && options+=(--allow-run-as-root)
fi

ranks() { # N ARGUMENTS...
  local n="$1"
  shift
  "${within[@]}" "$mpirun" "${options[@]}" -n "$n" "$program" "$@" --threads 1
}

# A case on 1, 2, 3, 4 and 7 ranks.
compare() { # NAME ARGUMENTS...
  local name="$1" n
  shift
  wanted "$name" || return
  reference "$out/$name" "$@"
  for n in 1 2 3 4 7; do
    ranks "$n" "$@" --quiet --out "$out/${name}_$n" >>"$out/$name.log" 2>&1
    same "$out/$name" "$out/${name}_$n" $?
    note "$name on $n ranks" $?
  done
}

# Processes of ranks that write to a directory.
ranks_in() { # DIRECTORY
  local pid
  for pid in $(pgrep -x nastic-mpi); do
    { tr '\0' '\n' <"/proc/$pid/cmdline" | grep -qxF -- "$1" && echo "$pid"; } 2>/dev/null
  done
}

# A rank is killed at a moment of the run: all end within 5 s, and any number of ranks goes on.
kill_a_rank() { # NUMBER MILLISECONDS ARGUMENTS...
  local number="$1" moment=$((RANDOM % ($2 * 4 / 5))) which=$((RANDOM % 3)) place="$out/killed_$1" job victim began gone n
  shift 2
  ranks 3 "$@" --quiet --out "$place" >"$place.log" 2>&1 &
  job=$!
  sleep "$((moment / 1000)).$(printf %03d $((moment % 1000)))"
  victim=$(ranks_in "$place" | sed -n "$((which + 1))p")
  gone=""
  began=$SECONDS
  kill -KILL "${victim:-none}" 2>/dev/null || gone=" (it had ended)"
  wait "$job" 2>/dev/null
  [ $((SECONDS - began)) -le 5 ] || note "killed $number: ended after $((SECONDS - began)) s" 1
  n=$((1 + number % 4))
  if [ -f "$place/checkpoint.bin" ]; then
    ranks "$n" resume "$place" --quiet >>"$place.log" 2>&1
  else
    ranks "$n" "$@" --quiet --restart --out "$place" >>"$place.log" 2>&1
  fi
  same "$out/uninterrupted" "$place" $?
  note "a rank killed after $moment ms${gone}, then $n ranks" $?
}

# A disk becomes full on the way, and has space again.
fill_a_disk() { # ARGUMENTS...
  local disk="$out/disk" place="$out/disk/run" status
  mkdir -p "$disk"
  if ! mount -t tmpfs -o size=760k tmpfs "$disk" 2>/dev/null; then
    leave_out "a full disk" "there is no right to mount one"
    return
  fi
  ranks 3 "$@" --quiet --out "$place" >"$out/disk.log" 2>&1
  status=$?
  [ "$status" = 7 ]
  note "a full disk: exit code 7 ($status)" $?
  mount -o remount,size=64m "$disk"
  ranks 2 resume "$place" --quiet >>"$out/disk.log" 2>&1
  same "$out/uninterrupted" "$place" $?
  note "a full disk, then 2 ranks" $?
  umount "$disk"
}

# The script for SLURM of docs/clusters.md, by a shell that sets SLURM's variables, which finds the mpirun of this run: a rank is killed, and the script is sent again.
run_the_script() {
  local place="$out/slurm" status job
  mkdir -p "$place/bin"
  sed -n '/^# ranks.sh$/,/^```$/{/^```$/!p}' docs/clusters.md >"$place/ranks.sh"
  printf '#!/bin/sh\nexec %s %s "$@"\n' "$(command -v "$mpirun")" "${options[*]}" >"$place/bin/mpirun"
  chmod +x "$place/bin/mpirun"
  ln -s "$PWD/$program" "$place/bin/nastic-mpi"
  sed -e "s|\.\./\.\./meshes|$PWD/meshes|" -e 's|"max_iterations": 100, "tolerance": 2e-3|"max_iterations": 12, "tolerance": 1e-12|' \
    -e '/"expect"/d' -e 's|"output": .*|"output": { "checkpoint": 1 }|' "$cases/robust_turgor.json" >"$place/robust.json"
  # the result names the case as it was given
  (cd "$place" && "$OLDPWD/$nastic" optimize robust.json --threads 2 --quiet --out one 2>one.log)
  codes[$place/one]=$?
  sent() { (cd "$place" && PATH="$place/bin:$PATH" SLURM_NTASKS=3 SLURM_CPUS_PER_TASK=1 "${within[@]}" bash ranks.sh >>log 2>&1); }
  sent &
  job=$!
  for _ in $(seq 200); do
    [ -f "$place/out/robust/checkpoint_b0.bin" ] && break # of the first iteration
    sleep 0.1
  done
  kill -KILL "$(ranks_in out/robust | sed -n 2p)"
  note "the script for SLURM, a rank of which is killed" $?
  wait "$job"
  sent
  status=$?
  same "$place/one" "$place/out/robust" "$status" && grep -q '"resumed"' "$place/out/robust/result.json"
  note "the script for SLURM, sent again" $?
}

compare robust_turgor optimize $cases/robust_turgor.json "${short[@]}" --set optimizer/max_iterations=6
compare load_cases optimize $cases/t_two_loads.json "${short[@]}" --set optimizer/max_iterations=6
compare motion "${motion[@]}"
compare risk_and_constraints optimize $cases/robust_turgor.json "${short[@]}" --set optimizer/max_iterations=6 --set output/checkpoint=2 \
  --set 'risk={"cvar":{"level":0.6,"smoothing":0.05}}' \
  --set 'constraints=[{"name":"reach","cost":{"kind":"position","surface":"track","target":{"x":0.05}},"at_most":1e-4}]'
compare starts optimize $cases/t_two_loads.json "${short[@]}" --set optimizer/max_iterations=6 --set optimizer/starts=7
if wanted slurm; then run_the_script; fi
if wanted faults; then
  reference "$out/uninterrupted" "${long[@]}"
  began=$(date +%s%3N)
  ranks 3 "${long[@]}" --quiet --out "$out/timed" >"$out/timed.log" 2>&1
  status=$?
  length=$(($(date +%s%3N) - began))
  same "$out/uninterrupted" "$out/timed" $status
  note "the run whose ranks are killed, $length ms" $?
  fill_a_disk "${long[@]}"
  for number in $(seq "$kills"); do kill_a_rank "$number" "$length" "${long[@]}"; done
fi

finish "all as on one rank"
