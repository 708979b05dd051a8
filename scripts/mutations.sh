#!/usr/bin/env bash
# Mutated meshes and cases through the readers, seed after seed, for so many minutes (tests/mutation.rs).
#
#   scripts/mutations.sh [MINUTES]        30 by default; ends at the first mutant that fails, which stands in target/tmp
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

minutes="${1:-30}"
seed=1
until [ $((SECONDS / 60)) -ge "$minutes" ]; do
  NASTIC_SEED=$seed NASTIC_MUTATIONS=1000000 cargo test --quiet --locked --release -p nastic --test all mutation
  echo "seed $seed: 1,000,000 meshes of either format and 100,000 cases, $((SECONDS / 60)) minutes"
  seed=$((seed + 1))
done
