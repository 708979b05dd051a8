#!/usr/bin/env bash
# The container recipe, containers/Containerfile: built and run where there is a docker or podman that answers. Elsewhere, with root and mmdebstrap, its
# final stage is made as a directory, of the same packages of Debian, with the programs of this checkout; what is installed to build is resolved and not installed.
#
#   scripts/test-container.sh
#
# Programs that were built here need what Debian 12 has: on another system the second way is skipped.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

recipe=containers/Containerfile
out="$PWD/target/container"
failed=()
rm -rf "$out" && mkdir -p "$out" || exit 1

note() { # NAME STATUS
  if [ "$2" = 0 ]; then echo "ok      $1"; else echo "FAILED  $1" && failed+=("$1"); fi
}

stop() { # WHY
  echo "FAILED  $1"
  exit 1
}

# The packages of the stages of the recipe, which are the words behind --no-install-recommends.
packages() { # STAGE
  awk -v stage="$1" '/^FROM/ { n++ } n == stage' "$recipe" | sed -e :join -e '/\\$/N; s/\\\n//; tjoin' |
    sed -n 's/.*--no-install-recommends \(.*\)/\1/p' | sed 's/&&.*//' | xargs
}

# What is run in the image, whose /tmp/cases and /meshes are there: members on two ranks, and a body of PETSc on two.
checked() { # NAME COMMAND_PREFIX...
  local name="$1" place ranks alone status
  local members=(optimize /tmp/cases/robust_turgor.json --threads 1 --quiet --set optimizer/max_iterations=4 --set 'expect={}')
  shift
  place=$("$@" mktemp -d) || stop "$name: no directory for results"
  "$@" mpirun --allow-run-as-root --oversubscribe -n 2 nastic-mpi "${members[@]}" --out "$place/ranks" >"$out/run.log" 2>&1
  ranks=$?
  "$@" nastic "${members[@]}" --out "$place/alone" >>"$out/run.log" 2>&1
  alone=$?
  # 4 is the limit of iterations
  [[ "$alone" = [04] && "$ranks" = "$alone" ]]
  note "$name: nastic-mpi on two ranks has the exit code of nastic ($ranks, $alone)" $?
  "$@" cmp "$place/ranks/controls.json" "$place/alone/controls.json"
  note "$name: nastic-mpi on two ranks has the bits of nastic" $?
  "$@" mpirun --allow-run-as-root --oversubscribe -n 2 /usr/local/lib/nastic/cantilever hex8 2 >"$out/body.json" 2>"$out/body.log"
  status=$?
  [ "$status" = 0 ] && python3 scripts/cantilever_tips.py "$out/body.json" hex8 2 2
  note "$name: a body of PETSc on two ranks has the digits of other codes (exit code $status)" $?
}

ended() {
  [ "${#failed[@]}" = 0 ] && echo "$1" && exit 0
  printf 'FAILED: %s\n' "${failed[@]}"
  exit 1
}

# In one container, which goes away with its image however the script ends.
in_an_image() { # ENGINE
  local engine="$1" name="nastic-test-$$"
  trap '"'"$engine"'" rm --force "'"$name"'" >/dev/null 2>&1; "'"$engine"'" rmi --force "'"$name"'" >/dev/null 2>&1' EXIT
  "$engine" build -f "$recipe" -t "$name" . || stop "the image is not built"
  "$engine" run --detach --name "$name" "$name" sleep infinity >/dev/null || stop "the image does not run"
  "$engine" cp examples/cases "$name:/tmp/cases" && "$engine" cp meshes "$name:/meshes" || stop "cases are not copied"
  checked "$engine" "$engine" exec "$name"
  ended "the image is as the recipe says"
}

for engine in docker podman; do
  if command -v "$engine" >/dev/null && "$engine" info >/dev/null 2>&1; then in_an_image "$engine"; fi
done
echo "skipped: building the image (no docker or podman that answers)"

grep -q '^VERSION_CODENAME=bookworm' /etc/os-release 2>/dev/null || { echo "skipped: the image as a directory (this is no Debian 12)" && exit 0; }
[ "$(id -u)" = 0 ] && command -v mmdebstrap >/dev/null || { echo "skipped: the image as a directory (no root, or no mmdebstrap)" && exit 0; }
root=$(mktemp -d) || stop "no directory for the image"
trap 'rm -rf --one-file-system "$root"' EXIT

# A command in the directory, with mounts that go when it ends.
inside() {
  unshare --mount --propagation private sh -c 'root="$1" && shift && mount -t proc proc "$root/proc" && mount --bind /dev "$root/dev" &&
    mount -t tmpfs tmpfs "$root/dev/shm" && exec chroot "$root" "$@"' sh "$root" "$@"
}

mmdebstrap --quiet --variant=minbase --include="$(packages 2 | tr ' ' ,)" bookworm "$root" "deb http://deb.debian.org/debian bookworm main" \
  "deb http://deb.debian.org/debian bookworm-updates main" "deb http://deb.debian.org/debian-security bookworm-security main" ||
  stop "the packages of the image are not installed: $(packages 2)"
note "the packages of the image are installed: $(packages 2)" 0
inside apt-get update -qq >"$out/build-packages.log" 2>&1 || stop "apt-get update"
# gcc and cargo are those of the image of Rust
inside apt-get install --simulate --no-install-recommends $(packages 1) >>"$out/build-packages.log" 2>&1
note "the packages to build with are there: $(packages 1)" $?

export CARGO_TARGET_DIR="$PWD/target"
cargo build --release --workspace --locked --quiet --bins &&
  cargo build --release --locked --quiet --manifest-path mpi/Cargo.toml --target-dir target/mpi_openmpi &&
  cargo build --release --locked --quiet --manifest-path petsc/Cargo.toml --target-dir target/petsc --examples || stop "the programs are not built"
mkdir -p "$root/usr/local/lib/nastic" "$root/tmp/cases" &&
  cp target/release/nastic target/mpi_openmpi/release/nastic-mpi "$root/usr/local/bin/" &&
  cp target/petsc/release/examples/cantilever "$root/usr/local/lib/nastic/" &&
  cp examples/cases/robust_turgor.json "$root/tmp/cases/" &&
  cp -r meshes "$root/meshes" || stop "the programs are not copied"
checked "a directory" inside env OPENBLAS_NUM_THREADS=1
ended "the packages of the recipe run the programs; the image itself was not built"
