#!/usr/bin/env python3
"""Efficiency of members over ranks by the formula of docs/development/messages-of-ranks.md: python3 scripts/team-efficiency.py [--plot] (NumPy; matplotlib for the plot).

Prints the estimates of that page, and with --plot draws docs/images/team_efficiency.png.

Times of members are lognormal with a spread (standard deviation over mean) of 0.35; what they will take is known from counts to 10 %. Their means are
those measured for one solve and one gradient of docs/development/performance.md. Messages are those of scripts/message_times.py. Seeded.
"""

import math
import pathlib
import sys

import numpy

import message_times

LATENCY, OVERHEAD, BANDWIDTH = 2e-6, 0.5e-6, 10e9
SPREAD, PREDICTED = 0.35, 0.1
# Unknowns of a member, and the seconds of its solve and of its gradient on a core (hex27; performance.md).
BODIES = {9_963: (0.16, 0.008), 30_927: (0.76, 0.039)}
CONTROLS, PER_MEMBER, RANKS = 10_000, 10, (10, 100, 1_000, 10_000)
REPEATS = 20


def shares(work, ranks):
    """First members of the ranks, ranges whose largest share is the smallest possible (crates/team/src/shares.rs)."""
    before = numpy.concatenate(([0.0], numpy.cumsum(work)))

    def begins(largest):
        bounds, end = [0] * ranks, len(work)
        for rank in reversed(range(ranks)):
            end = max(int(numpy.searchsorted(before, before[end] - largest)), rank)
            bounds[rank] = end
        return bounds if end == 0 else None

    low, high = max(before[-1] / ranks, work.max()), before[-1] / ranks + work.max()
    while high - low > 1e-3:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if begins(middle) else (middle, high)
    return numpy.array(begins(high))


def efficiency(ranks, solve, gradient, balanced, random):
    """Work of an iteration (a trial and a derivative) over what all ranks spend on it."""
    members = PER_MEMBER * ranks
    sigma = math.sqrt(math.log(1 + SPREAD**2))
    times = random.lognormal(-0.5 * sigma**2, sigma, members)
    counted = times * (1 + PREDICTED * random.standard_normal(members)) if balanced else numpy.ones(members)
    slowest = numpy.add.reduceat(times, shares(numpy.maximum(counted, 1e-3), ranks)).max()
    levels = math.ceil(math.log2(members)) + math.ceil(math.log2(ranks))
    messages = message_times.iteration(members, ranks, levels, CONTROLS, LATENCY + 2 * OVERHEAD, BANDWIDTH)
    own = (solve + gradient) * times.sum() / ranks
    return own / ((solve + gradient) * slowest + messages), messages


def main():
    random = numpy.random.default_rng(1)
    rows = []
    print("| Unknowns of a member | Ranks | Members | ranges of equal length | balanced by counts | messages of an iteration, ms |")
    print("|---|---|---|---|---|---|")
    for unknowns, (solve, gradient) in BODIES.items():
        for ranks in RANKS:
            of = lambda balanced: [efficiency(ranks, solve, gradient, balanced, random) for _ in range(REPEATS if ranks < 10_000 else 8)]
            even, balanced = of(False), of(True)
            rows.append((unknowns, ranks, *(float(numpy.mean([e for e, _ in found])) for found in (even, balanced))))
            milliseconds = 1e3 * balanced[0][1]
            print(f"| {unknowns:,} | {ranks:,} | {PER_MEMBER * ranks:,} | {rows[-1][2]:.2f} | {rows[-1][3]:.2f} | {milliseconds:.2g} |")
    if "--plot" in sys.argv:
        plot(rows)


def plot(rows):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, ax = plt.subplots(figsize=(5.2, 3.4))
    ax.set(xlabel="ranks, ten members each", ylabel="efficiency", xscale="log", ylim=(0, 1))
    ax.axhline(0.85, color="#888888", linewidth=0.8, linestyle=":")
    for unknowns, line in zip(BODIES, ("-", "--")):
        own = [row for row in rows if row[0] == unknowns]
        for column, colour, what in ((3, "#1f6fb2", "balanced by counts"), (2, "#d9822b", "of equal length")):
            label = f"{what}, {unknowns:,} unknowns"
            ax.plot([row[1] for row in own], [row[column] for row in own], line, color=colour, marker="o", markersize=3, label=label)
    ax.grid(True, alpha=0.3)
    ax.legend(frameon=False, fontsize=8, loc="lower left")
    figure.tight_layout()
    figure.savefig(pathlib.Path(__file__).resolve().parent.parent / "docs/images/team_efficiency.png", dpi=110)


if __name__ == "__main__":
    main()
