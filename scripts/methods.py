"""Every optimiser on every shipped case that optimises: runs `nastic optimize`, writes the table of docs/development/optimisers.md between its markers.

    python scripts/methods.py                    all cases; needs target/release/nastic
    python scripts/methods.py strip finger       these cases alone; the others keep the rows of their last results
    python scripts/methods.py --from-results     writes the table again from the results in out/methods

As the cases stand, but with the method set, one start (`optimizer/starts=1`), one thread, and nothing expected. A run that takes more
processor time (Linux) than the limit is stopped as by Ctrl-C; what it reached until then is in the table, with the limit as its end.
"""

import argparse
import json
import os
import re
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
OUT = ROOT / "out/methods"
PAGE = ROOT / "docs/development/optimisers.md"
MARKERS = re.compile(r"(<!-- methods -->\n).*?(<!-- end -->)", re.DOTALL)
METHODS = ["projected_gradient", "spectral", "lbfgs", "gauss_newton", "newton_cg"]
CASES = [path.stem for path in sorted((ROOT / "examples/cases").glob("*.json")) if '"optimizer"' in path.read_text(encoding="utf-8")]


def run(program, case, method, limit):
    """One optimisation; its record goes to out/methods/CASE.METHOD.json."""
    out = OUT / f"{case}.{method}"
    changes = [f"optimizer/method={method}", "optimizer/starts=1", "expect={}", "output/every=0"]
    sets = [word for change in changes for word in ("--set", change)]
    arguments = ["optimize", f"examples/cases/{case}.json", *sets, "--out", out, "--threads", "1", "--no-report", "--restart", "--quiet"]
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime, time.monotonic()
    process = subprocess.Popen([program, *arguments], cwd=ROOT, stderr=subprocess.PIPE, text=True)
    cut = False
    while process.poll() is None:
        if not cut and user_seconds(process.pid) > limit:
            process.send_signal(signal.SIGINT)
            cut = True
        time.sleep(0.1)
    complaint = process.stderr.read()
    record = {"case": case, "method": method, "exit": process.returncode, "limit": limit if cut else None}
    record["user_seconds"] = round(resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, 1)
    if process.returncode in (0, 4):
        record |= figures(out)
    else:
        record["error"] = complaint.strip().splitlines()[-1] if complaint.strip() else "no message"
    (OUT / f"{case}.{method}.json").write_text(json.dumps(record) + "\n", encoding="utf-8")
    print(f"{time.monotonic() - began:6.1f} s  {case} {method}", flush=True)


def user_seconds(pid):
    """So far; of a process that ended meanwhile its last."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[11]) / os.sysconf("SC_CLK_TCK")


def figures(out):
    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    trials = [json.loads(line) for line in (out / "history.jsonl").read_text(encoding="utf-8").splitlines()]
    return {
        "iterations": result["iterations"],
        "trials": result["trials"],
        "failed": result["failed_solves"],
        "products": result.get("hessian_products", 0),
        "newton": sum(trial["newton"] or 0 for trial in trials),
        "first": trials[0]["cost"],
        "cost": result["cost"]["total"],
        "stop": result["stop"],
    }


def table():
    rows = [f"| Case | {' | '.join(f'`{method}`' for method in METHODS)} |", "|" + "---|" * (1 + len(METHODS))]
    for case in CASES:
        paths = [OUT / f"{case}.{method}.json" for method in METHODS]
        if any(path.exists() for path in paths):
            cells = [cell(json.loads(path.read_text(encoding="utf-8"))) if path.exists() else "" for path in paths]
            rows.append(f"| `{case}` | {' | '.join(cells)} |")
    return "\n".join(rows) + "\n"


def cell(of):
    """Iterations, trials, products, Newton iterations: cost (how the run ended, if it did not converge)."""
    if "error" in of:
        return of["error"].replace("|", "/")
    end = of["stop"].split(":")[0].split(" after")[0] if of["limit"] is None else f"limit of {of['limit']:g} s"
    trials = f"{of['trials']} ({of['failed']} failed)" if of["failed"] else of["trials"]
    counts = [of["iterations"], trials, *([of["products"]] if of["products"] else []), of["newton"]]
    return f"{', '.join(map(str, counts))}: {of['cost']:.5g}" + ("" if end == "converged" else f" ({end})")


def write():
    text = PAGE.read_text(encoding="utf-8")
    if len(MARKERS.findall(text)) != 1:
        sys.exit(f"{PAGE} wants one <!-- methods --> with its <!-- end -->")
    PAGE.write_text(MARKERS.sub(lambda found: found[1] + table() + found[2], text), encoding="utf-8")


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("cases", nargs="*", metavar="CASE", help=f"of {', '.join(CASES)}")
    options.add_argument("--from-results", action="store_true")
    options.add_argument("--limit", type=float, default=120, help="user seconds of a run (120)")
    options.add_argument("--nastic", type=Path, default=ROOT / "target/release/nastic", help="the program (target/release/nastic)")
    options = options.parse_args()
    if unknown := sorted(set(options.cases) - set(CASES)):
        sys.exit(f"no case {', '.join(unknown)} that optimises; there are {', '.join(CASES)}")
    OUT.mkdir(parents=True, exist_ok=True)
    if not options.from_results:
        for case in options.cases or CASES:
            for method in METHODS:
                run(options.nastic, case, method, options.limit)
    write()


if __name__ == "__main__":
    main()
