#!/usr/bin/env python3
"""The tip of the fibre cantilever by other codes: python3 scripts/cantilever_tips.py FILE KIND N RANKS, with what petsc/examples/cantilever.rs printed.

Fails where the tip is off by 1e-9 m or more, or other ranks than these have found it.
"""

import json
import sys

# docs/development/verification.md: FEniCSx, NGSolve, JAX-FEM and others
DIGITS = {
    ("hex8", 2): (-0.186179761, 0.008186681, 0.235506464),
    ("hex8", 6): (-0.216627256, 0.007904082, 0.276875271),
    ("hex27", 2): (-0.221675516, 0.007753715, 0.282876107),
    ("hex27", 3): (-0.222542559, 0.007727853, 0.284295574),
}
CLOSE = 1e-9


def off(tip, kind, n):
    return max(abs(a - b) for a, b in zip(tip, DIGITS[kind, n], strict=True))


def main():
    file, kind, n, ranks = sys.argv[1:]
    with open(file) as lines:
        found = json.load(lines)
    distance = off(found["tip"], kind, int(n))
    said = f"{found['newton']} Newton and {found['iterations']} CG iterations, tip off by {distance:.0e}"
    print(f"        {found['unknowns']} unknowns on {found['ranks']} ranks, {said}")
    sys.exit(not (distance < CLOSE and found["ranks"] == int(ranks)))


if __name__ == "__main__":
    main()
