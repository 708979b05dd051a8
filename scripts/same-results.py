#!/usr/bin/env python3
"""Whether two result folders are the same, to the byte but for times: python3 scripts/same-results.py FOLDER OTHER."""

import json
import pathlib
import sys

# What differs from one run to the next, and from one number of ranks to another.
TIMED = {"seconds", "threads", "peak_memory", "resumed"}
# history.jsonl and result.json are compared without their times; the page shows them, and checkpoints are blocks by ranks.
LEFT_OUT = {"history.jsonl", "result.json", "checkpoint.bin", "report.html"}


def history(folder):
    lines = (folder / "history.jsonl").read_text().splitlines()
    return [{key: value for key, value in json.loads(line).items() if key != "seconds"} for line in lines]


def result(folder):
    found = json.loads((folder / "result.json").read_text())
    return {key: value for key, value in found.items() if key not in TIMED}


def files(folder):
    names = {file.name for file in folder.iterdir() if not file.name.startswith((".", "checkpoint_"))} - LEFT_OUT
    return {name: (folder / name).read_bytes() for name in names}


def main():
    one, other = map(pathlib.Path, sys.argv[1:])
    for what in (history, result, files):
        try:
            same = what(one) == what(other)
        except FileNotFoundError as error:
            sys.exit(f"{what.__name__} of {one} and {other}: {error}")
        if not same:
            sys.exit(f"{what.__name__} of {one} and {other} differ")


if __name__ == "__main__":
    main()
