#!/usr/bin/env python3
"""Faults planted one by one, each of which the tests of its own crate must catch.

python3 scripts/planted-faults.py [NAME ..]     all of them, or those whose crate or text has a NAME

A fault is one line changed; a fault whose line is no longer there, or stands in two places, is reported as an error, so that
the list stays true. Every crate's tests run in release with the faulty line alone; the file is put back whatever happens.
"""

import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent

# crate, file below its src, what stands there, what is planted; a fifth entry names the crate whose tests must catch it, if it is another.
FAULTS = [
    ("tensor", "cross.rs", "- a[(k, n)] * b[(m, l)] + a[(m, n)]", "+ a[(k, n)] * b[(m, l)] + a[(m, n)]"),
    ("numeric", "format.rs", "{exponent:0>2}", "{exponent:0>3}"),
    ("energy", "material/yeoh.rs", "2.0 * c20 + 6.0 * x * c30,", "2.0 * c20 + 5.0 * x * c30,"),
    ("energy", "material/gent.rs", "let first = 0.5 * mu * jm / left;", "let first = 0.49 * mu * jm / left;"),
    ("energy", "design/weighted.rs", "stress[q] * (curvature * v_s)", "stress[q] * (slope * v_s)"),
    ("energy", "growth/grown.rs", "inverse * block * inverse.transpose() * volume;", "inverse * block * inverse.transpose();"),
    ("mesh", "locate.rs", "*out += weight * value", "*out += value"),
    ("io", "pvd.rs", "map_or(0, |(_, part)| part + 1)", "map_or(0, |(_, part)| part)"),
    ("linear", "factor/symmetric.rs", "map(|pivot| pivot.negative()).sum()", "map(|pivot| pivot.negative()).sum::<usize>().min(1)"),
    ("team", "tree.rs", "joined(left, node_alone(first + size / 2,", "joined(left, node_alone(first + size / 4,"),
    ("body", "body_energy/product.rs", "*stress += change * *v", "*stress -= change * *v", "control"),
    ("equilibrium", "linear_systems/saddle_point.rs", "|negative: usize| negative.saturating_sub(self.members().count())", "|negative: usize| negative", "fem"),
    ("motion", "catalogue.rs", "u(-2.0, NOW), u(0.5, BEFORE)", "u(-2.0, NOW), u(0.4, BEFORE)", "fem"),
    ("motion", "reverse_sweep.rs", "acceleration: (0.0, acceleration.to_vec())", "acceleration: (0.0, vec![0.0; acceleration.len()])", "control"),
    ("forces", "filled_mass.rs", "+= share * fill(point);", "+= fill(point);", "control"),
    ("forces", "contact/friction.rs", "(2.0 / e - s / (e * e), -s / (e * e))", "(2.0 / e - s / (e * e), s / (e * e))", "fem"),
    ("forces", "contact/law.rs", "slope: -2.0 / delta * t,", "slope: -1.0 / delta * t,", "fem"),
    ("control", "cost/tracking.rs", "let value = 0.5 * self.weight * squares;", "let value = self.weight * squares;"),
    ("control", "cost/regularization.rs", "let own = 0.5 * m.iter()", "let own = 0.6 * m.iter()"),
    ("control", "reduced/instant.rs", "(&self.motion, n.checked_sub(1))", "(&self.motion, n.checked_sub(0))", "run"),
    ("ensemble", "blocks.rs", "*out += weight * d)", "*out += d)"),
    ("hausdorff", "smoothing.rs", "self.phi.length() / self.alpha", "self.phi.length() / self.beta"),
    ("uncertainty", "risk/cvar.rs", "(t + width * excess / self.tail())", "(t + width * excess * self.tail())"),
    ("opt", "saved.rs", "Ok(value) if at == bytes.len() => Ok(value),", "Ok(value) if at <= bytes.len() => Ok(value),"),
    ("opt", "line_search.rs", "cost <= reference + self.armijo * predicted + slack", "cost <= reference + slack"),
    ("opt", "admissible/sphere.rs", "let factor = -dot(derivative, m) / (radius * radius);", "let factor = -dot(derivative, m) / radius;"),
    ("fit", "statistics.rs", "2.0 * k * (k + 1.0) / room", "2.0 * k * k / room"),
    ("language", "schema/expectation.rs", "self.absolute.unwrap_or(0.0).max(relative)", "self.absolute.unwrap_or(0.0).min(relative)"),
    ("language", "expression/parser.rs", "self.nested(Self::signed)?;", "self.nested(Self::operand)?;"),
    ("case", "lower/control_start.rs", "(sum / weights[k / n])", "(sum / weights[k])", "run"),
    ("run", "run/error.rs", "Self::NotConverged => 4,", "Self::NotConverged => 0,"),
    ("result", "controls.rs", "value <= lower || value >= upper", "value < lower || value > upper", "run"),
    ("report", "csv.rs", "text.replace('\"', \"\\\"\\\"\")", "text.replace('\"', \"\\\"\")"),
    ("picture", "colour.rs", "(s * 255.0).round() as u8", "(s * 250.0).round() as u8"),
]


def tests_of(crate):
    command = ["cargo", "test", "--release", "--locked", "--quiet", "-p", f"nastic-{crate}"]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True)


def plant(crate, name, before, after, tested=None):
    """What became of a fault: caught, missed, or why it could not be planted."""
    file = ROOT / "crates" / crate / "src" / name
    text = file.read_text()
    if text.count(before) != 1:
        return f"ERROR: the line stands there {text.count(before)} times"
    began = time.monotonic()
    try:
        file.write_text(text.replace(before, after))
        ran = tests_of(tested or crate)
    finally:
        file.write_text(text)
    seconds = time.monotonic() - began
    if "error: could not compile" in ran.stderr:
        return "ERROR: it does not compile"
    if ran.returncode == 0:
        return f"MISSED ({seconds:.0f} s)"
    failed = [line[5:-12] for line in ran.stdout.splitlines() if line.startswith("---- ") and line.endswith(" stdout ----")]
    return f"caught by {len(failed)} ({failed[0]}; {seconds:.0f} s)" if failed else f"ERROR: {ran.stderr[-200:]}"


def main():
    wanted = sys.argv[1:]
    chosen = [fault for fault in FAULTS if not wanted or any(name in " ".join(fault[:4]) for name in wanted)]
    bad = 0
    for fault in chosen:
        found = plant(*fault)
        bad += not found.startswith("caught")
        print(f"{fault[0]:<12} {fault[1]:<38} {fault[3][:44]:<46} {found}", flush=True)
    print(f"{len(chosen) - bad} of {len(chosen)} caught")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
