#!/usr/bin/env bash
# nastic-mpi and one body of PETSc on several hosts: network namespaces, each with a name and a network card of its own, joined by a bridge. The bits of one
# process, a host whose daemon is killed, a link that goes down, what resumes, and what messages take.
#
#   scripts/hosts.sh                          all parts
#   PARTS="bits body" scripts/hosts.sh        some of them: bits, daemon, link, body, messages
#
# Needs Linux, root, `ip` and Open MPI (Debian: iproute2, libopenmpi-dev, libclang-dev), and PETSc for `body` (petsc-dev); where one is missing nothing, or
# that part, is tested, which is said and is no success. `link` takes some four minutes: a silent link is noticed after 60 s.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

all="bits daemon link body messages"
parts=${PARTS-$all}
. scripts/mpi-cases.sh
check_parts "$parts" "$all"

skip() { echo "skipped: $1" && exit 0; }
[ "$(id -u)" = 0 ] || skip "several hosts (network namespaces need root)"
command -v ip >/dev/null && command -v unshare >/dev/null || skip "several hosts (no ip or no unshare: install iproute2 and util-linux)"
mpirun --version 2>&1 | grep -q "Open MPI" || skip "several hosts (no mpirun of Open MPI: install libopenmpi-dev)"
probe="nastic$$"
ip netns add "$probe" 2>/dev/null || skip "several hosts (network namespaces are refused here)"
ip netns delete "$probe"

hosts=4
network=10.77.77
bridge="nb$$"
out="$PWD/target/hosts_runs"
agent="$out/agent.sh"
root=(--allow-run-as-root)
keepalive=()
limit=()
asking=(--mca oob_tcp_keepalive_time 10 --mca oob_tcp_keepalive_intvl 5 --mca oob_tcp_keepalive_probes 3)
export CARGO_TARGET_DIR="$PWD/target"

prefix="nastic$$"
place() { echo "${prefix}host$1"; } # the namespace of a host

# Everything that was made goes away, however the script ends: processes of the hosts first.
clean_up() {
  local host
  for host in $(seq "$hosts"); do
    kill_all "$host"
    ip netns delete "$(place "$host")" 2>/dev/null
  done
  ip link delete "$bridge" 2>/dev/null
}
kill_all() { ip netns pids "$(place "$1")" 2>/dev/null | xargs -r kill -KILL 2>/dev/null; }
trap clean_up EXIT
trap 'exit 130' INT TERM

# Hosts 1 to 4 with the addresses .1 to .4. Nothing else is on the bridge, and the machine itself is not.
join_hosts() {
  local host
  ip link add "$bridge" type bridge && ip link set "$bridge" up || return 1
  for host in $(seq "$hosts"); do
    ip netns add "$(place "$host")" &&
      ip link add "nv$$h$host" type veth peer name eth0 netns "$(place "$host")" &&
      ip link set "nv$$h$host" master "$bridge" up &&
      ip -n "$(place "$host")" address add "$network.$host/24" dev eth0 &&
      ip -n "$(place "$host")" link set eth0 up &&
      ip -n "$(place "$host")" link set lo up || return 1
  done
}

# Whether one host reaches another by TCP: filters of bridges, as firewalls set them, may keep them apart.
hosts_reach_each_other() {
  local listening status
  timeout 10 ip netns exec "$(place 2)" python3 -c 'import socket; socket.create_server(("", 7777)).accept()' >/dev/null 2>&1 &
  listening=$!
  timeout 10 ip netns exec "$(place 1)" python3 - "$network.2" <<'PYTHON'
import socket, sys, time

for attempt in range(30):
    try:
        sys.exit(socket.create_connection((sys.argv[1], 7777), timeout=2).close())
    except ConnectionRefusedError:
        time.sleep(0.1)
    except OSError as error:
        sys.exit(str(error))
sys.exit("nothing listens")
PYTHON
  status=$?
  kill "$listening" 2>/dev/null
  wait "$listening" 2>/dev/null
  return $status
}

# Starts a command on a host, as ssh would: in its network, with its name. Open MPI starts its daemons (orted) with it.
write_agent() {
  cat >"$agent" <<AGENT
#!/bin/sh
host="\$1"
shift
exec ip netns exec "$prefix\$host" unshare --uts sh -c 'hostname "\$1"; eval "exec \$2"' sh "\$host" "\$*"
AGENT
  chmod +x "$agent"
}

# TCP alone, and no shared memory: all that hosts have in common is the file system. mpirun itself runs on host 1.
ranks() { # HOSTS RANKS PROGRAM ARGUMENTS...
  local list="$1" n="$2"
  shift 2
  "${limit[@]}" "$agent" host1 mpirun "${root[@]}" "${keepalive[@]}" -n "$n" --host "$list" --map-by node --bind-to none --mca plm_rsh_agent "$agent" \
    --mca btl tcp,self --mca btl_tcp_if_include eth0 --mca oob_tcp_if_include eth0 --mca mpi_yield_when_idle 1 "$(printf ' %q' "$@")" </dev/null
}

# The same in the foreground, for as long as a run may take.
ranks_within() {
  local limit=("${within[@]}")
  ranks "$@"
}

# Waits until a run has left a checkpoint, and a moment more, so that it is interrupted in its midst.
underway() { # FOLDER
  local tries
  for tries in $(seq 600); do
    [ -f "$1/checkpoint.bin" ] && sleep 0.7 && return
    sleep 0.1
  done
  return 1
}

# Processes of a host by the name of their program.
processes() { # HOST NAME
  local pid
  for pid in $(ip netns pids "$(place "$1")" 2>/dev/null); do
    [ "$(cat "/proc/$pid/comm" 2>/dev/null)" = "$2" ] && echo "$pid"
  done
}

milliseconds() { date +%s%3N; }

# A run on hosts 1 to 3 is left in the background, behind its first checkpoint: $job is mpirun's.
begin() { # FOLDER ARGUMENTS...
  local folder="$1"
  shift
  rm -rf "$folder"
  ranks host1,host2,host3 3 "$program" "$@" --threads 1 --quiet --out "$folder" >"$folder.log" 2>&1 &
  job=$!
  underway "$folder"
  note "$(basename "$folder"): a checkpoint is there" $?
}

# Waits for mpirun: $status, and whether it ended within so many seconds of the moment $began. What is left some seconds later is killed.
ended_within() { # NAME SECONDS
  local host seconds
  while kill -0 "$job" 2>/dev/null; do
    if [ $(($(milliseconds) - began)) -gt $((($2 + 15) * 1000)) ]; then
      for host in $(seq "$hosts"); do kill_all "$host"; done
      break
    fi
    sleep 0.05
  done
  wait "$job" 2>/dev/null
  status=$?
  seconds=$(($(milliseconds) - began))
  [ "$seconds" -le $(($2 * 1000)) ]
  note "$1: ended after $seconds ms, exit code $status" $?
}

# What Open MPI's mpirun ends with when it has lost a daemon.
lost_a_daemon() { # NAME
  [ "$status" = 205 ]
  note "$1: Open MPI's exit code 205 ($status)" $?
}

kill_the_daemon() { # NAME HOST
  local daemon
  daemon=$(processes "$2" orted)
  [ -n "$daemon" ] && kill -KILL $daemon
  note "$1: there was one on host $2" $?
}

# What was interrupted goes on elsewhere, on another number of ranks, to the bits of a run that was not.
resumed() { # NAME UNINTERRUPTED FOLDER HOSTS RANKS
  local host
  for host in $(seq "$hosts"); do kill_all "$host"; done
  ranks_within "$4" "$5" "$program" resume "$3" --threads 1 --quiet >>"$3.log" 2>&1
  same "$2" "$3" $?
  note "$1: resumed with $5 ranks on $4, the bits of one process" $?
}

# Neither ranks nor daemons, on any host.
no_rank_left() { # NAME
  local tries host left
  for tries in $(seq 50); do
    left=$(for host in $(seq "$hosts"); do processes "$host" nastic-mpi; processes "$host" orted; done)
    [ -z "$left" ] && break
    sleep 0.1
  done
  [ -z "$left" ]
  note "$1: no rank and no daemon is left on any host" $?
}

bits() {
  local n list=(- host1 host1,host2 host1,host2,host3 host1,host2,host3,host4)
  for n in 2 3 4; do
    ranks_within "${list[n]}" "$n" "$program" "${long[@]}" --threads 1 --quiet --out "$out/turgor_$n" >"$out/turgor_$n.log" 2>&1
    same "$out/turgor" "$out/turgor_$n" $?
    note "robust_turgor on $n hosts" $?
  done
  ranks_within "${list[3]}" 3 "$program" "${motion[@]}" --threads 1 --quiet --out "$out/motion_3" >"$out/motion_3.log" 2>&1
  same "$out/motion" "$out/motion_3" $?
  note "a motion in five scenarios on 3 hosts" $?
}

daemon() {
  begin "$out/daemon" "${long[@]}"
  began=$(milliseconds)
  kill_the_daemon "a daemon is killed" 3
  ended_within "a daemon is killed" 5
  lost_a_daemon "a daemon is killed"
  no_rank_left "a daemon is killed"
  resumed "a daemon is killed" "$out/turgor" "$out/daemon" host1,host2 2
  begin "$out/daemon_motion" "${motion[@]}"
  began=$(milliseconds)
  kill_the_daemon "a daemon is killed in a motion" 2
  ended_within "a daemon is killed in a motion" 5
  lost_a_daemon "a daemon is killed in a motion"
  no_rank_left "a daemon is killed in a motion"
  resumed "a daemon is killed in a motion" "$out/motion" "$out/daemon_motion" host1,host3,host4:2 4
}

down() { ip -n "$(place 3)" link set eth0 down; }
up() { ip -n "$(place 3)" link set eth0 up; }

link() {
  local keepalive=()
  # The ranks give up after 60 s with exit code 9. mpirun of Open MPI 4.1 then waits for the daemon that does not answer.
  begin "$out/link" "${long[@]}"
  began=$(milliseconds)
  down
  while [ $(($(milliseconds) - began)) -lt 90000 ] && ! grep -q "errorcode 9" "$out/link.log"; do sleep 0.2; done
  grep -q "rank 2 has sent nothing for 6[0-9] s" "$out/link.log" && grep -q "errorcode 9" "$out/link.log"
  note "a link is down: a rank says so and ends with exit code 9, after $(($(milliseconds) - began)) ms" $?
  sleep 3
  kill -0 "$job" 2>/dev/null && echo "        mpirun is there all the same; ranks left on hosts 1 and 2: $(processes 1 nastic-mpi | wc -l), $(processes 2 nastic-mpi | wc -l)"
  for host in $(seq "$hosts"); do kill_all "$host"; done
  wait "$job" 2>/dev/null
  up
  resumed "a link is down" "$out/turgor" "$out/link" host1,host2:2,host4 4
  # With these options Open MPI itself asks whether its daemons are there.
  keepalive=("${asking[@]}")
  begin "$out/link_asked" "${long[@]}"
  began=$(milliseconds)
  down
  ended_within "a link is down, with keep-alive" 60
  lost_a_daemon "a link is down, with keep-alive"
  # nor on the other side
  no_rank_left "a link is down, with keep-alive"
  up
  resumed "a link is down, with keep-alive" "$out/turgor" "$out/link_asked" host1,host2 2
}

# The fibre cantilever in three parts, with the digits of other codes (docs/development/verification.md).
body() {
  if ! ls "${PETSC_LIB_DIR:-/usr/lib/$(uname -m)-linux-gnu}/lib${PETSC_LIB:-petsc_real}.so" >/dev/null 2>&1; then
    leave_out "one body on several hosts" "no PETSc: install petsc-dev"
    return
  fi
  cargo build --release --locked --quiet --manifest-path petsc/Cargo.toml --target-dir target/petsc --examples || exit 1
  local kind n
  while read -r kind n; do
    ranks_within host1,host2,host3 3 env OPENBLAS_NUM_THREADS=1 target/petsc/release/examples/cantilever "$kind" "$n" >"$out/body_$kind.json" 2>"$out/body_$kind.log" &&
      python3 scripts/cantilever_tips.py "$out/body_$kind.json" "$kind" "$n" 3
    note "one body on 3 hosts: $kind, n = $n" $?
  done <<'EOF'
hex8 6
hex27 3
EOF
}

# What messages take on two and on four hosts against the formula of docs/development/messages-of-ranks.md. Beside other work the figures are larger, and the ratio moves by some tens of per cent.
messages() {
  cargo build --release --locked --quiet --manifest-path mpi/Cargo.toml --target-dir target/mpi_openmpi --examples || exit 1
  ranks_within host1,host2 2 target/mpi_openmpi/release/examples/messages >"$out/messages.json" 2>"$out/messages.log" &&
    ranks_within host1,host2,host3,host4 4 target/mpi_openmpi/release/examples/messages >>"$out/messages.json" 2>>"$out/messages.log" &&
    [ "$(wc -l <"$out/messages.json")" = 2 ] && python3 scripts/message_times.py "$out/messages.json"
  note "messages on two and four hosts are within 50 % of the formula" $?
}

rm -rf "$out"
mkdir -p "$out"
if wanted bits || wanted daemon || wanted link; then
  cargo build --release --workspace --locked --quiet --bins || exit 1
  cargo build --release --locked --quiet --manifest-path mpi/Cargo.toml --target-dir target/mpi_openmpi || exit 1
fi
nastic=target/release/nastic
program="$PWD/target/mpi_openmpi/release/nastic-mpi"
write_agent
join_hosts || { echo "FAILED  hosts could not be joined" && exit 1; }
hosts_reach_each_other || skip "several hosts (those on one bridge do not reach each other here: is it filtered?)"

if wanted bits || wanted daemon || wanted link; then reference "$out/turgor" "${long[@]}"; fi
if wanted bits || wanted daemon; then reference "$out/motion" "${motion[@]}"; fi
for part in $all; do
  if wanted "$part"; then "$part"; fi
done
finish "all as on one host"
