"""The blocks of docs/python.md, one after the other; a comment behind `print(..)` is what it prints."""

import contextlib
import io
import re

import pytest
from conftest import ROOT

PAGE = (ROOT / "docs/python.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```$", PAGE, flags=re.MULTILINE | re.DOTALL)
PYTHON = [code for language, code in BLOCKS if language == "python"]
#: Packages that nastic does not need.
OPTIONAL = ["scipy", "meshio", "pyvista", "jax", "torch"]


def needed(code: str) -> list[str]:
    return [name for name in OPTIONAL if re.search(rf"^(import|from) {name}\b", code, flags=re.MULTILINE)]


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    """A directory that looks like the checkout, and the names defined so far."""
    place = tmp_path_factory.mktemp("docs")
    for name in ("examples", "meshes"):
        (place / name).symlink_to(ROOT / name)
    with contextlib.chdir(place) if hasattr(contextlib, "chdir") else _chdir(place):
        yield {}


@contextlib.contextmanager
def _chdir(place):  # Python 3.10
    import os

    before = os.getcwd()
    os.chdir(place)
    try:
        yield
    finally:
        os.chdir(before)


@pytest.mark.parametrize("index", range(len(PYTHON)))
def test_a_block_runs_and_prints_what_it_says(session, index):
    code = PYTHON[index]
    for name in needed(code):
        pytest.importorskip(name, reason=f"{name} is not installed")
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(compile(code, f"docs/python.md, block {index}", "exec"), session)
    promised = re.findall(r"print\(.*\)  # (.*)$", code, flags=re.MULTILINE)
    assert said.getvalue().splitlines() == promised


def test_the_page_has_blocks_of_these_languages_alone():
    assert len(PYTHON) >= 9 and {language for language, _ in BLOCKS} == {"python", "sh"}


def test_the_command_that_installs_is_the_one_that_the_tests_use():
    (command,) = [code.strip() for language, code in BLOCKS if language == "sh"]
    script = (ROOT / "scripts/test-python.sh").read_text(encoding="utf-8")
    assert command in script
