"""Plots of docs/development/performance.md from the lines of `cargo bench --bench scaling`: python scripts/plots.py scaling.jsonl (matplotlib).

Prints the same figures as Markdown tables.
"""

import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

INK, BLUE, ORANGE, GREY = "#222222", "#1f6fb2", "#d9822b", "#888888"


def read(path):
    kinds = {}
    with open(path) as lines:
        for line in lines:
            entry = json.loads(line)
            kinds.setdefault(entry["kind"], []).append(entry["result"])
    return kinds


def axes(title, x, y):
    figure, ax = plt.subplots(figsize=(5.2, 3.6))
    ax.set(title=title, xlabel=x, ylabel=y, xscale="log", yscale="log")
    ax.grid(True, which="major", alpha=0.3)
    return figure, ax


def save(figure, ax, name):
    ax.legend(frameon=False, fontsize=8)
    figure.tight_layout()
    figure.savefig(f"docs/images/{name}.png", dpi=110)
    plt.close(figure)


def forward(runs):
    print("| | unknowns | solver | setup s | forward s | Newton | factorisations | substitutions or cycles | MB |")
    print("|---|---|---|---|---|---|---|---|---|")
    for r in runs:
        work = r["back_substitutions"] + r["cycles"]
        print(
            f"| {r['element']} | {r['ndof']:,} | {r['solver']} | {r['setup_s']:.2f} | {r['forward_s']:.2f} | {r['newton']} "
            f"| {r['factorisations']} | {work} | {r['rss_mb']:.0f} |"
        )
    figure, ax = axes("Fibre cantilever, one solve, two cores", "unknowns", "seconds")
    memory, ax_memory = axes("Fibre cantilever, peak memory", "unknowns", "MB")
    for element, colour in [("hex8", BLUE), ("hex27", ORANGE)]:
        mine = [r for r in runs if r["element"] == element]
        n = [r["ndof"] for r in mine]
        ax.plot(n, [r["forward_s"] for r in mine], "o-", color=colour, label=f"nastic, {element}")
        ax_memory.plot(n, [r["rss_mb"] for r in mine], "o-", color=colour, label=f"nastic, {element}")
    first = min(runs, key=lambda r: r["ndof"])
    last = max(r["ndof"] for r in runs)
    line = [first["forward_s"], first["forward_s"] * last / first["ndof"]]
    ax.plot([first["ndof"], last], line, ":", color=GREY, label="proportional to the unknowns")
    save(figure, ax, "scaling_forward")
    save(memory, ax_memory, "scaling_memory")


def hausdorff(runs):
    print("\n| points, each cloud | seconds, value and gradient | ns per pair |")
    print("|---|---|---|")
    for r in runs:
        print(f"| {r['n']:,} | {r['median_s']:.4f} | {1e9 * r['median_s'] / r['n'] ** 2:.3f} |")
    figure, ax = axes("Smoothed Hausdorff, value and gradient, alpha = 60", "points of each cloud", "seconds")
    n, t = [r["n"] for r in runs], [r["median_s"] for r in runs]
    ax.plot(n, t, "o-", color=BLUE, label="nastic")
    ax.plot([n[0], n[-1]], [t[0], t[0] * (n[-1] / n[0]) ** 2], ":", color=GREY, label="proportional to the pairs")
    save(figure, ax, "scaling_hausdorff")


def roofline(limits, runs):
    """What the parts reach of what the machine does: a factorisation in GFLOP/s, a substitution in GB/s."""
    best = max(limits, key=lambda r: r["dgemm_gflops"])
    print(f"\nThe machine on two cores: dgemm {best['dgemm_gflops']:.0f} GFLOP/s, reads {best['read_GBs']:.0f} GB/s.\n")
    print("| | factorisation, GFLOP/s | substitution, GB/s | tangents, cells/s/core |")
    print("|---|---|---|---|")
    for r in runs:
        if r["factor_s"] is None:
            continue
        gflops = r["factor_gflop"] / r["factor_s"]
        bandwidth = 2e-3 * r["factor_mb"] / r["solve_s"]
        cells = r["cells"] / r["tangent_s"] / r["threads"]
        print(f"| {r['element']}, {r['ndof']:,} | {gflops:.0f} | {bandwidth:.1f} | {cells:,.0f} |")


def main():
    kinds = read(sys.argv[1])
    if "forward" in kinds:
        forward(kinds["forward"])
    if "limits" in kinds and "forward" in kinds:
        roofline(kinds["limits"], kinds["forward"])
    if "hausdorff" in kinds:
        hausdorff(kinds["hausdorff"])


main()
