#!/usr/bin/env python3
"""The page of all shipped cases and templates, each with its picture and its numbers, from the results of scripts/slow.sh.

python3 scripts/gallery.py RESULTS BOOK     RESULTS holds case_NAME/result.json, template_NAME/result.json; BOOK gets gallery.md and gallery/NAME.png
"""

import json
import pathlib
import re
import shutil
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def about(case):
    """Title and first paragraph of the first comment of a case file."""
    text = case.read_text()
    title = re.search(r'"title": "(.+?)"', text)
    comment = []
    for line in text.removeprefix("{\n").splitlines():
        if not line.strip().startswith("//") or line.strip() == "//":
            break
        comment.append(line.strip().lstrip("/ "))
    return (title.group(1) if title else case.stem), " ".join(comment)


def short(value):
    return f"{value:.4g}" if isinstance(value, (int, float)) else "-"


def numbers(result):
    """What a result says in one line."""
    out = [f"`nastic {result['command']}`"]
    start, end = result.get("start", {}).get("cost", {}).get("total"), result.get("cost", {}).get("total")
    if start is not None and end is not None:
        out.append(f"cost {short(start)} to {short(end)} in {result.get('iterations')} iterations")
    distance = result.get("hausdorff", {}).get("true")
    if distance is not None:
        out.append(f"true Hausdorff distance {short(distance)} {result['units']['length']}")
    for name, tracked in list(result.get("tracking", {}).items())[:1]:
        out.append(f"distance from the target {short(tracked.get('root_mean_square'))} {result['units']['length']} (root mean square)")
    out.append(f"{result.get('newton_iterations', '-')} Newton iterations, smallest J {short(result.get('min_J'))}")
    return "; ".join(out) + "."


def main():
    results, book = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    pictures = book / "gallery"
    shutil.rmtree(pictures, ignore_errors=True)
    pictures.mkdir(parents=True)
    page = ["# Gallery", "", "Every shipped case and every template with its picture and its numbers, as `scripts/slow.sh` ran it.", ""]
    missing = []
    cases = [(case, f"case_{case.stem}", f"Case: [{case.stem}.json](../../examples/cases/{case.name}).")
             for case in sorted((ROOT / "examples/cases").glob("*.json"))]
    cases += [(case, f"template_{case.stem}", f"`nastic new NAME --template {case.stem}`.")
              for case in sorted((ROOT / "crates/language/templates").glob("*.json"))]
    for case, name, whence in cases:
        title, text = about(case)
        folder = results / name
        if not (folder / "result.json").exists():
            missing.append(name)
            continue
        result = json.loads((folder / "result.json").read_text())
        page += [f"## {title}", "", text, "", numbers(result), "", whence, ""]
        picture = folder / "picture.png"
        if picture.exists():
            shutil.copy(picture, pictures / f"{name}.png")
            page += [f"![{title}](gallery/{name}.png)", ""]
    if missing:
        page += [f"Not run for this page: {', '.join(missing)}.", ""]
        print(f"gallery: not run for this page: {', '.join(missing)}")
    (book / "gallery.md").write_text("\n".join(page))


if __name__ == "__main__":
    main()
