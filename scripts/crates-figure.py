"""The figure of the crates and their arrows, from their manifests: python scripts/crates-figure.py [--check] (no packages).

Writes docs/images/crates.svg; with --check, as in .ci/run, it says whether the figure is that of the manifests. Arrows that
others imply are left out; a crate stands one row below the lowest one that depends on it."""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FIGURE = ROOT / "docs/images/crates.svg"
WIDTH, HEIGHT, ROW, COLUMN, MARGIN = 104, 26, 52, 132, 14

# Groups with their colours, and the columns of their crates.
GROUPS = {
    "programs": ("#d9e8f5", {"mpi": 2, "cli": 2, "python": 1, "nastic": 3}),
    "cases": ("#e4ecd3", {"remesh": 2, "run": 2, "result": 2, "case": 2, "language": 2}),
    "files and pictures": ("#f3e9d2", {"report": 0, "picture": 0, "io": 0}),
    "optimisation": ("#ecdff0", {"control": 2, "fields": 2, "ensemble": 1, "opt": 5, "hausdorff": 3, "uncertainty": 1}),
    "equilibria and motions": (
        "#f6dcd6",
        {"petsc": 5, "fem": 2, "motion": 2, "equilibrium": 2, "forces": 2, "body": 2},
    ),
    "laws, meshes, matrices": ("#e3e3e3", {"fit": 4, "energy": 3, "mesh": 1, "linear": 2}),
    "foundations": ("#ffffff", {"numeric": 1.4, "team": 2.3, "tensor": 3.2}),
}


def manifests():
    """Path of the manifest of every crate, by its name without `nastic-`."""
    found = {path.parent.name: path for path in ROOT.glob("crates/*/Cargo.toml")}
    return found | {name: ROOT / name / "Cargo.toml" for name in ("mpi", "petsc")} | {"nastic": ROOT / "Cargo.toml"}


def arrows():
    """The crates of the project that each one names in its dependencies."""
    tables = {name: re.search(r"^\[dependencies\]\n(.*?)(?=^\[|\Z)", path.read_text(), re.M | re.S) for name, path in manifests().items()}
    return {name: set(re.findall(r"^nastic-([a-z]+)", table[1], re.M)) if table else set() for name, table in tables.items()}


def reached(graph, name):
    """All that a crate depends on, itself left out."""
    return set().union(*({other} | reached(graph, other) for other in graph[name])) if graph[name] else set()


def direct(graph):
    """The arrows that no chain of others implies."""
    implied = {name: set().union(*(reached(graph, other) for other in graph[name])) for name in graph}
    return {name: graph[name] - implied[name] for name in graph}


def rows(graph):
    """Row of every crate, from the lowest: that of what it depends on and one, then as high as what depends on it lets it."""
    lowest = {}

    def row(name):
        if name not in lowest:
            lowest[name] = 1 + max(map(row, graph[name]), default=-1)
        return lowest[name]

    for name in sorted(graph, key=row, reverse=True):
        above = [lowest[other] for other in graph if name in graph[other]]
        lowest[name] = min(above) - 1 if above else lowest[name]
    return lowest


def drawing(graph):
    """The figure as SVG."""
    place = {name: column for _, columns in GROUPS.values() for name, column in columns.items()}
    if place.keys() != graph.keys():
        sys.exit(f"scripts/crates-figure.py: name the column of {sorted(place.keys() ^ graph.keys())} in GROUPS")
    row = rows(graph)
    top = max(row.values())
    at = {name: (MARGIN + place[name] * COLUMN, MARGIN + (top - row[name]) * ROW) for name in graph}
    crowded = {place: [name for name in at if at[name] == place] for place in at.values()}
    if any(len(names) > 1 for names in crowded.values()):
        sys.exit(f"scripts/crates-figure.py: other columns for {[names for names in crowded.values() if len(names) > 1]} in GROUPS")
    lines = []
    for name, others in sorted(direct(graph).items()):
        for other in sorted(others):
            (x, y), (u, v) = at[name], at[other]
            x, u, y = x + WIDTH / 2, u + WIDTH / 2, y + HEIGHT
            lines.append(f'<path d="M{x:g} {y:g}V{v - ROW + HEIGHT:g}C{x:g} {v - 4:g} {u:g} {v - ROW + HEIGHT:g} {u:g} {v - 4:g}" marker-end="url(#tip)"/>')
    boxes = []
    for colour, columns in GROUPS.values():
        for name in columns:
            x, y = at[name]
            boxes.append(f'<rect x="{x:g}" y="{y:g}" width="{WIDTH}" height="{HEIGHT}" rx="4" fill="{colour}"/>')
            boxes.append(f'<text x="{x + WIDTH / 2:g}" y="{y + 17:g}">{name}</text>')
    key = []
    for index, (group, (colour, _)) in enumerate(GROUPS.items()):
        x, y = MARGIN + 4.4 * COLUMN, MARGIN + index * 22
        key.append(f'<rect x="{x:g}" y="{y:g}" width="16" height="14" rx="3" fill="{colour}"/>')
        key.append(f'<text x="{x + 22:g}" y="{y + 11:g}" text-anchor="start">{group}</text>')
    width, height = 2 * MARGIN + 5.8 * COLUMN, 2 * MARGIN + top * ROW + HEIGHT
    return "\n".join([
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" width="{width:g}" font-family="sans-serif" font-size="13" text-anchor="middle">',
        '<defs><marker id="tip" viewBox="0 0 8 8" refX="5" refY="4" markerWidth="7" markerHeight="7" orient="auto"><path d="M0 0L8 4L0 8z" fill="#666"/></marker></defs>',
        f'<rect width="{width:g}" height="{height:g}" fill="#fff"/>',
        '<g fill="none" stroke="#666">', *lines, "</g>",
        '<g stroke="#888" stroke-width="0.8">', *[one for one in boxes + key if one.startswith("<rect")], "</g>",
        *[one for one in boxes + key if one.startswith("<text")],
        "</svg>\n",
    ])


def main():
    figure = drawing(arrows())
    if "--check" not in sys.argv[1:]:
        FIGURE.write_text(figure)
    elif not FIGURE.exists() or FIGURE.read_text() != figure:
        sys.exit("docs/images/crates.svg is not the figure of the manifests: python scripts/crates-figure.py")


if __name__ == "__main__":
    main()
