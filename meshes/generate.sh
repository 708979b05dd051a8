#!/bin/sh
# Makes every .msh here from its .geo again. Needs Gmsh (the committed files came from 4.15.2); nothing else does.
set -eu
cd "$(dirname "$0")"
for geo in *.geo; do
    case "$geo" in
        strip_* | arch.* | berry.* | carry.*) dimension=2 ;;
        *) dimension=3 ;;
    esac
    ${GMSH:-gmsh} "$geo" "-$dimension" -nt 1 -o "${geo%.geo}.msh" -v 3
done
