#!/usr/bin/env python3
"""What messages between ranks take, by the formula of docs/development/messages-of-ranks.md: python3 scripts/message_times.py FILE, with the lines of mpi/examples/messages.rs.

Prints measured and predicted times, and fails where an iteration is more than 50 % off. A message takes L + 2 o + bytes / B (LogGP: A. Alexandrov,
M. Ionescu, K. Schauser, C. Scheiman, J. Parallel Distrib. Comput. 44, 1997, 71-79); `each` is L + 2 o.
"""

import json
import math
import sys

WITHIN = 0.5
# Bytes of the short messages that pass to and fro in messages.rs; long ones are as long as those of a sum.
SHORT = 64
# Bytes of a member in the exchanges of an iteration of one trial and one derivative, with one term of cost and two figures.
EXCHANGES = (81 + 8, 71, 1 + 16, 4, 10)


def exchange(members, ranks, size, each, bandwidth):
    """Rounds in which a rank hears of as many others as it knows. In each round ranks form rings in which some send first and some receive first: two
    messages wait for each other where these take turns, three where a ring has an odd length and messages are long."""
    waits = 2 if ranks & (ranks - 1) == 0 else 3
    rounds = math.ceil(math.log2(ranks))
    return waits * (rounds * each + (ranks - 1) / ranks * (12 * ranks + size * members) / bandwidth)


def tree_sum(levels, controls, each, bandwidth):
    """Messages one behind the other: nodes of the tree across ranks, one above the other, and the sum sent back."""
    return levels * (each + 8 * controls / bandwidth)


def iteration(members, ranks, levels, controls, each, bandwidth):
    """The messages of one trial and one derivative."""
    exchanges = sum(exchange(members, ranks, size, each, bandwidth) for size in EXCHANGES)
    return exchanges + tree_sum(levels, controls, each, bandwidth)


def main():
    wrong = False
    print("| Ranks | L + 2 o, us | o, us | B, GB/s | an exchange, ms | formula | a sum, ms | formula | an iteration, ms | formula | off |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    with open(sys.argv[1]) as lines:
        for found in map(json.loads, lines):
            ranks, members, controls = found["ranks"], found["members"], found["controls"]
            each, bandwidth = found["short"], (8 * controls - SHORT) / (found["long"] - found["short"])
            # shares are powers of two: the fewest levels
            levels = 2 * math.ceil(math.log2(ranks))
            by_formula = (
                exchange(members, ranks, EXCHANGES[0], each, bandwidth),
                tree_sum(levels, controls, each, bandwidth) + found["alone"],
                iteration(members, ranks, levels, controls, each, bandwidth) + found["alone"],
            )
            measured = [found[name] for name in ("exchange", "sum", "iteration")]
            off = by_formula[2] / measured[2] - 1
            wrong |= abs(off) > WITHIN
            pairs = " | ".join(f"{1e3 * m:.3g} | {1e3 * f:.3g}" for m, f in zip(measured, by_formula))
            print(f"| {ranks} | {1e6 * each:.3g} | {1e6 * found['overhead']:.3g} | {bandwidth / 1e9:.3g} | {pairs} | {100 * off:+.0f} % |")
    sys.exit(wrong)


if __name__ == "__main__":
    main()
