#!/usr/bin/env python3
"""Writes crates/uncertainty/src/lattice_vector.rs: the generating vector of `Sample::lattice`.

One component after the other, each the odd z below 2^16 with the least value of the largest of
e_p(z)^2 / min_z e_p(z)^2 over the prefixes of 2^p points, p = 4 to 16, where

    e_p^2 = -1 + 1/2^p sum_n prod_k (1 + w(n z_k / 2^p) / k^2),    w(x) = 2 pi^2 (x^2 - x + 1/6),

is the square of the worst-case error in the weighted Korobov space of order 2. Sums for all z at once by FFT over the
group of powers of 5: Nuyens & Cools, J. Complexity 22 (2006) 4-28; embedded: Cools, Kuo & Nuyens, SIAM J. Sci.
Comput. 28 (2006) 2162-2188. Needs numpy. `--check`: only that the file is what it would write.
"""

import pathlib
import sys

import numpy as np

BITS, LEAST, DIMENSIONS = 16, 4, 256
TARGET = pathlib.Path(__file__).parent.parent / "crates/uncertainty/src/lattice_vector.rs"


def kernel(x):
    return 2 * np.pi**2 * (x * x - x + 1 / 6)


def powers(bits):
    """The powers of 5 modulo 2^bits: with their negatives all odd numbers."""
    count = max(1, 1 << max(0, bits - 2))
    out = np.ones(count, dtype=np.int64)
    for k in range(1, count):
        out[k] = out[k - 1] * 5 % (1 << bits)
    return out


def vector():
    points = 1 << BITS
    product = np.ones(points)  # at n / 2^BITS
    numbers = np.arange(points, dtype=np.int64)
    groups = {bits: powers(bits) for bits in range(1, BITS + 1)}
    spectra = {bits: np.fft.rfft(kernel(group / (1 << bits))) for bits, group in groups.items()}
    candidates = groups[BITS]
    chosen = []
    for dimension in range(1, DIMENSIONS + 1):
        # by level: the points u 2^(BITS - bits), u odd, that a prefix of 2^bits points has more than the one before
        sums = np.full(len(candidates), kernel(0.0) * product[0])
        plain = product[0]
        worst = np.zeros(len(candidates))
        for bits in range(1, BITS + 1):
            group, step = groups[bits], 1 << (BITS - bits)
            own = product[group * step]
            own = own + product[(-group) % (1 << bits) * step] if bits > 1 else own
            # sum_i own(i) w(5^(i + j) / 2^bits) for all j
            level = np.fft.irfft(np.conj(np.fft.rfft(own)) * spectra[bits], len(group))
            sums = sums + np.tile(level, len(candidates) // len(group))
            plain += own.sum()
            if bits >= LEAST:
                square = (plain + sums / dimension**2) / (1 << bits) - 1
                worst = np.maximum(worst, square / square.min())
        best = int(candidates[np.argmin(np.round(worst, 9))])
        chosen.append(best)
        product *= 1 + kernel(numbers * best % points / points) / dimension**2
    return chosen


def main():
    rows = vector()
    lines = [
        "//! The generating vector of [`Sample::lattice`](super::Sample::lattice): written by `scripts/lattice.py`.",
        "",
        "/// One odd integer below 2^16 by coordinate.",
        "#[rustfmt::skip]",
        f"pub(super) const LATTICE_VECTOR: [u16; {DIMENSIONS}] = [",
    ]
    lines += ["    " + ", ".join(f"{z}" for z in rows[k : k + 16]) + "," for k in range(0, DIMENSIONS, 16)]
    text = "\n".join(lines + ["];", ""])
    if "--check" in sys.argv[1:]:
        sys.exit(0 if TARGET.read_text() == text else f"{TARGET} is not what this writes")
    TARGET.write_text(text)


if __name__ == "__main__":
    main()
