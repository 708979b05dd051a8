"""Counterparts of the survey's figures 5 to 12: runs the shipped cases, draws docs/images/reproduction, writes docs/reproduction.json
and, between their markers, the numbers and commands of docs/reproduction.md.

    python scripts/reproduce.py                  everything; needs scripts/requirements-figures.txt and target/release/nastic
    python scripts/reproduce.py --from-results   draws and writes again from the results in out/reproduction
    python scripts/reproduce.py --check          writes nothing, needs Python alone: the page against docs/reproduction.json, and that
                                                 against the last results, where they are, and the cases, where the program is
"""

import argparse
import json
import math
import re
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
OUT = ROOT / "out/reproduction"
PAGE = ROOT / "docs/reproduction.md"
NUMBERS = ROOT / "docs/reproduction.json"
IMAGES = ROOT / "docs/images/reproduction"
LARGEST_IMAGE = 150_000
DRAWS, SEED = 800, 2023

GIVEN_TENSION = "(X < 0.6 m) * (1e5 Pa * (Z < 0.1 m) - 3e5 Pa * (Z > 0.1 m) * (Z - 0.1 m) / 0.1 m)"
NODES = ("scenarios/rule/gauss=3", "expect={}")
SAMPLE = (f'scenarios/rule={{"monte_carlo": {DRAWS}}}', f"scenarios/seed={SEED}", 'scenarios/inadmissible="truncate"', "expect={}")


@dataclass
class Run:
    """One call of the program; what it writes goes to out/reproduction/NAME."""

    name: str
    case: str
    title: str = ""
    unit: str = ""  # of the cost
    command: str = "optimize"
    set: tuple = field(default_factory=tuple)
    starts_from: str = ""
    exit: int = 0

    def arguments(self):
        start = f'controls/0/start={{"file": "../../out/reproduction/{self.starts_from}/controls.json"}}'
        changes = [*self.set, *([start] if self.starts_from else [])]
        return [self.command, f"examples/cases/{self.case}.json", *(word for change in changes for word in ("--set", change))]


RUNS = [
    Run("arc", "cantilever_arc", "bar to an arc, `lbfgs`", "m", set=("output/every=1",)),
    Run("arc_gradient", "cantilever_arc", "bar to an arc, Algorithm 1", "m",
        set=("optimizer/method=projected_gradient", "output/every=1", "expect={}")),
    Run("known", "known_control", "bar to a target of known control", "m"),
    Run("known_given", "known_control", command="solve",
        set=("mesh/box/cells=[15,3,6]", f"controls/0/start={GIVEN_TENSION}", "expect={}")),
    Run("known_fine", "known_control", "bar to that target, finer mesh, nodal tension, Algorithm 1", "m",
        set=("mesh/box/cells=[20,4,8]", "controls/0/space=node", "optimizer/method=projected_gradient", "optimizer/max_iterations=40",
             "output/every=1", "expect={}"), exit=4),
    Run("stem", "turgor_stem", "stem, right half of the upper skin", "mm^2"),
    Run("tip", "tip_tracking", "bar, end face", "m^4"),
    Run("t_magnet", "t_magnet", "T, one target", "m^4"),
    Run("t_two_loads", "t_two_loads", "T, two targets", "m^4"),
    Run("petal", "petal", "petal", "m^4"),
    Run("robust", "robust_turgor", "stem, mean cost of 27 nodes", "mm^2", set=NODES),
    Run("nodes_deterministic", "robust_turgor", command="solve", set=NODES, starts_from="stem"),
    Run("draws_deterministic", "robust_turgor", command="solve", set=SAMPLE, starts_from="stem"),
    Run("draws_robust", "robust_turgor", command="solve", set=SAMPLE, starts_from="robust"),
]
BY_NAME = {run.name: run for run in RUNS}


# Runs


def run_all(program):
    for run in RUNS:
        began = time.monotonic()
        fresh = ["--restart"] if run.command == "optimize" else []
        # 800 states: their page would have 800 shapes.
        short = ["--no-report"] if run.name.startswith("draws") else []
        done = subprocess.run([program, *run.arguments(), "--out", OUT / run.name, "--quiet", *fresh, *short], cwd=ROOT)
        print(f"{time.monotonic() - began:6.1f} s  {run.name}", flush=True)
        if done.returncode != run.exit:
            sys.exit(f"{run.name}: exit code {done.returncode} instead of {run.exit} (docs/results.md says what it means)")


def result_of(name):
    return json.loads((OUT / name / "result.json").read_text())


# Numbers: what the page shows of the results


def rounded(value):
    if isinstance(value, float):
        return float(f"{value:.6g}")
    if isinstance(value, dict):
        return {key: rounded(one) for key, one in value.items()}
    return [rounded(one) for one in value] if isinstance(value, list) else value


def collect():
    return rounded({run.name: numbers_of(run, result_of(run.name)) for run in RUNS})


def numbers_of(run, result):
    numbers = {"arguments": run.arguments(), "exit": result["exit"]}
    # Runs that start from another one's control have no hash of their own to compare: that file is no part of the project.
    if not run.starts_from:
        numbers["case_hash"] = result["case_hash"]
    if run.command == "optimize":
        numbers |= {"stop": result["stop"].split(":")[0], "iterations": result["iterations"], "trials": result["trials"]}
        numbers["members"] = members(result)
        numbers["controls"] = {
            name: {key: one[key] for key in ("unknowns", "min", "max", "lower", "upper", "active_share")}
            for name, one in result["controls"].items()
        }
    if "output/every=1" in run.set:
        numbers["true_distance"] = [line["hausdorff_true"] for line in accepted(run.name)]
    if "scenarios" in result:
        numbers["costs"] = measures(result)
    if run.name == "robust":
        numbers["nodes"] = nodes(result)
    if run.name == "draws_robust":
        numbers["left_out"] = DRAWS - len(result["scenarios"])
        numbers["saved"] = saved(result_of("draws_deterministic"), result)
    return numbers


def accepted(name):
    """The accepted trial of every iteration; that in which a stage begins has two, the same state valued by both stages."""
    lines = (OUT / name / "history.jsonl").read_text().splitlines()
    by_iteration = {line["iteration"]: line for line in map(json.loads, lines) if line["accepted"]}
    return [by_iteration[k] for k in range(len(by_iteration))]


def members(result):
    """Cost and distance (m) at start and end, of every load case; of scenarios the risk alone."""
    pairs = {"": (result["start"], result)}
    pairs |= {name: (result["start"]["load_cases"][name], end) for name, end in result.get("load_cases", {}).items()}
    return {name: {"cost": [one["cost"]["total"] for one in pair], "distance": [distance(one) for one in pair]}
            for name, pair in pairs.items()}


def distance(entry):
    """True Hausdorff distance, else root of the mean square of the first tracking term."""
    if "hausdorff" in entry:
        return entry["hausdorff"]["true"]
    terms = list(entry.get("tracking", {}).values())
    return terms[0]["root_mean_square"] if terms else None


def measures(result):
    risk = result["risk"]
    exact = {name: value if (value := risk["measures"][name]["exact"]) is not None else risk["measures"][name]["value"]
             for name in ("mean", "cvar", "worst_case")}
    return {"mean": exact["mean"], "deviation": risk["deviation"], "cvar": exact["cvar"], "worst": exact["worst_case"]}


def nodes(result):
    """The one-dimensional rules: value of each parameter and the probability of all scenarios that have it."""
    rules = {}
    for scenario in result["scenarios"].values():
        for path, value in scenario["set"].items():
            rule = rules.setdefault(path.split("/")[-1], {})
            rule[value] = rule.get(value, 0.0) + scenario["probability"]
    return {name: [[value, rule[value]] for value in sorted(rule)] for name, rule in rules.items()}


def saved(deterministic, robust):
    """What the robust control saves on the same draws: mean, its standard error, share of draws in which it is the better one."""
    pairs = [(one["cost"]["total"], robust["scenarios"][name]["cost"]["total"]) for name, one in deterministic["scenarios"].items()]
    gains = [a - b for a, b in pairs]
    mean = sum(gains) / len(gains)
    variance = sum((gain - mean) ** 2 for gain in gains) / (len(gains) - 1)
    better = sum(gain > 0 for gain in gains) / len(gains)
    return {"mean": mean, "standard_error": math.sqrt(variance / len(gains)), "better_share": better}


# Page: what stands between its markers


def block(kind, names, numbers):
    words = names.split()
    blocks = {"commands": commands, "runs": runs_table, "iterates": iterates_table, "tensions": tensions_table,
              "fields": fields_table, "nodes": nodes_table, "robust": robust_table}
    if kind not in blocks:
        sys.exit(f"docs/reproduction.md: no marker is called {kind}; there are: {', '.join(blocks)}")
    return blocks[kind](words, numbers)


def commands(names, _numbers):
    quoted = lambda word: word if re.fullmatch(r"[\w./=-]+", word) else f"'{word}'"
    lines = [" ".join(["nastic", *map(quoted, BY_NAME[name].arguments()), f"--out out/reproduction/{name}"]) for name in names]
    return ["```sh", *lines, "```"]


def table(head, rows):
    return [f"| {' | '.join(cells)} |" for cells in [head, ["---"] * len(head), *rows]]


def arrow(pair, form):
    return " -> ".join(form(value) for value in pair if value is not None)


def short(value):
    return f"{value:.3e}".replace("e-0", "e-").replace("e+0", "e+") if abs(value) < 1e-2 else f"{value:#.4g}"


def runs_table(names, numbers):
    rows = []
    for name in names:
        run = numbers[name]
        cases = {key: one for key, one in run["members"].items() if key} or run["members"]
        for case, member in cases.items():
            title = BY_NAME[name].title + (f": {case}" if case else "")
            cost, distance = arrow(member["cost"], short), arrow(member["distance"], lambda metres: f"{1e3 * metres:.2f}")
            rows.append([title, f"{cost} {BY_NAME[name].unit}", distance, str(run["iterations"]), run["stop"]])
    return table(["Run", "Cost", "Distance (mm)", "Iterations", "Ended"], rows)


def iterates_table(names, numbers):
    shown = [0, 1, 2, 3, 5, 10, 20, 30, -1]

    def at(distances, k):
        return f"{1e3 * distances[k]:.1f}" if k < len(distances) else ""

    rows = [[BY_NAME[name].title, *(at(numbers[name]["true_distance"], k) for k in shown)] for name in names]
    return table(["True distance (mm) at iteration", *map(str, shown[:-1]), "last"], rows)


def tensions_table(names, numbers):
    rows = []
    for name in names:
        one = numbers[name]["controls"]["tension"]
        values = [f"{1e-3 * one[key]:.1f}" for key in ("lower", "min", "max", "upper")]
        rows.append([BY_NAME[name].title, str(one["unknowns"]), *values, f"{100 * one['active_share']:.0f} %"])
    return table(["Tension (kPa)", "Unknowns", "Lower bound", "Least", "Largest", "Upper bound", "On a bound"], rows)


def fields_table(names, numbers):
    rows = []
    for name in names:
        for control, one in numbers[name]["controls"].items():
            if control.endswith("field"):
                case = control.removesuffix("magnet.field").rstrip(".")
                rows.append([BY_NAME[name].title + (f": {case}" if case else ""), f"{1e3 * one['max']:.2f}", f"{1e3 * one['upper']:.0f}"])
    return table(["Applied field (mT)", "Length", "At most"], rows)


def nodes_table(names, numbers):
    scales = {"shear": (1e-6, "MPa"), "bulk": (1e-6, "MPa"), "share": (1, "")}
    rows = []
    for parameter, rule in numbers[names[0]]["nodes"].items():
        scale, unit = scales[parameter]
        mean = sum(p * value for value, p in rule)
        deviation = math.sqrt(sum(p * (value - mean) ** 2 for value, p in rule))
        cells = [f"{scale * value:.4f} ({p:.4f})" for value, p in rule]
        rows.append([f"`{parameter}` {unit}".strip(), *cells, f"{scale * mean:.4f}", f"{scale * deviation:.4f}"])
    return table(["Parameter", "Node (probability)", "", "", "Mean", "Deviation"], rows)


def robust_table(_names, numbers):
    columns = ["nodes_deterministic", "robust", "draws_deterministic", "draws_robust"]
    rows = [[label, *(f"{numbers[name]['costs'][key]:.2f}" for name in columns)]
            for label, key in [("mean", "mean"), ("standard deviation", "deviation"), ("CVaR 0.9", "cvar"), ("worst", "worst")]]
    gain, left_out = numbers["draws_robust"]["saved"], numbers["draws_robust"]["left_out"]
    head = ["Cost (mm^2)", "27 nodes, deterministic", "27 nodes, robust", f"{DRAWS} draws, deterministic", f"{DRAWS} draws, robust"]
    line = (f"On the same draws the robust control saves {gain['mean']:.2f} +- {gain['standard_error']:.2f} mm^2 in the mean (standard error of "
            f"the pairs) and is the better one in {100 * gain['better_share']:.0f} % of them. {left_out} draws were inadmissible.")
    return [*table(head, rows), "", line]


MARKERS = re.compile(r"(<!-- (\w+): ([\w ]+) -->\n).*?(<!-- end -->)", re.DOTALL)


def page_with(numbers, text):
    return MARKERS.sub(lambda found: found[1] + "\n".join(block(found[2], found[3], numbers)) + "\n" + found[4], text)


def write():
    numbers = collect()
    lines = [f"{json.dumps(name)}: {json.dumps(one, ensure_ascii=False)}" for name, one in numbers.items()]
    NUMBERS.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
    PAGE.write_text(page_with(numbers, PAGE.read_text(encoding="utf-8")), encoding="utf-8")


# Check


def check(program):
    numbers, text = json.loads(NUMBERS.read_text(encoding="utf-8")), PAGE.read_text(encoding="utf-8")
    wrong = [*check_names(text), *check_page(numbers, text), *check_results(numbers), *check_cases(numbers, program)]
    for line in wrong:
        print(f"docs/reproduction.md: {line}")
    if wrong:
        sys.exit("run scripts/reproduce.py again, and see whether what the page says still holds")
    print("The page of reproductions shows what docs/reproduction.json says.")


def check_names(text):
    for case in sorted(set(re.findall(r"examples/cases/\w+\.json", text))):
        if not (ROOT / case).exists():
            yield f"{case} does not exist"
    shown = set(re.findall(r"images/reproduction/([\w.]+)", text))
    there = {path.name: path.stat().st_size for path in IMAGES.glob("*")}
    yield from (f"the picture {name} does not exist" for name in sorted(shown - set(there)))
    yield from (f"the picture {name} is not shown" for name in sorted(set(there) - shown))
    yield from (f"the picture {name} has {size} bytes, more than {LARGEST_IMAGE}" for name, size in there.items() if size > LARGEST_IMAGE)


def check_page(numbers, text):
    if list(numbers) != [run.name for run in RUNS] or any(numbers[run.name]["arguments"] != run.arguments() for run in RUNS):
        yield "docs/reproduction.json has other runs than scripts/reproduce.py"
        return
    if len(MARKERS.findall(text)) != text.count("<!-- ") // 2 or "<!-- runs:" not in text:
        yield "a marker is missing or misspelt"
    due, shown = page_with(numbers, text).splitlines(), text.splitlines()
    yield from (f"shows\n  {a}\ninstead of\n  {b}" for a, b in zip(shown, due) if a != b)
    if len(due) != len(shown):
        yield f"has {len(shown)} lines instead of {len(due)}"


def check_results(numbers):
    if not all((OUT / run.name / "result.json").exists() for run in RUNS):
        print("SKIPPED: the numbers against those of the last run, because out/reproduction has no results.")
        return
    found = collect()
    yield from (f"the last run of {name} gave\n  {found[name]}\nthe page has\n  {numbers[name]}"
                for name in found if found[name] != numbers[name])


def check_cases(numbers, program):
    """A case that has changed since has another hash, which covers the files it names."""
    if not program.exists():
        print(f"SKIPPED: whether the cases are still those of the page, because {program} is not built.")
        return
    for run in RUNS:
        if "case_hash" in numbers[run.name]:
            arguments = ["check", *run.arguments()[1:], "--json"]
            done = subprocess.run([program, *arguments], cwd=ROOT, capture_output=True, text=True)
            if done.returncode != 0:
                yield f"{run.name}: {done.stderr.strip()}"
            elif json.loads(done.stdout)["case_hash"] != numbers[run.name]["case_hash"]:
                yield f"the case {run.case}, or a file it names, has changed since {run.name} was run"


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--check", action="store_true")
    options.add_argument("--from-results", action="store_true")
    options.add_argument("--nastic", type=Path, default=ROOT / "target/release/nastic", help="the program (target/release/nastic)")
    options = options.parse_args()
    if options.check:
        check(options.nastic)
        return
    if not options.from_results:
        run_all(options.nastic)
    from reproduce_figures import draw_all

    draw_all(OUT, IMAGES)
    write()
    print("drawn and written; read what the page says beside its numbers")


if __name__ == "__main__":
    main()
