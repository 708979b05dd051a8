"""The blocks of the pages on Python, one after the other; a comment behind `print(..)` is what it prints."""

import contextlib
import io
import re

import pytest
from conftest import ROOT


def blocks(page: str) -> list[tuple[str, str]]:
    text = (ROOT / page).read_text(encoding="utf-8")
    return re.findall(r"^```(\w*)\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL)


PAGES = {page: blocks(page) for page in ("docs/python.md", "docs/clusters.md", "docs/tutorials/8-python.md")}
PYTHON = [
    pytest.param(page, code, id=f"{page}, block {index}")
    for page, found in PAGES.items()
    for index, code in enumerate(code for language, code in found if language == "python")
]
#: Packages that nastic does not need.
OPTIONAL = ["scipy", "meshio", "pyvista", "jax", "torch", "dask"]


def needed(code: str) -> list[str]:
    return [name for name in OPTIONAL if re.search(rf"^(import|from) {name}\b", code, flags=re.MULTILINE)]


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    """A directory that looks like the checkout, and the names that the blocks of each page have defined so far."""
    place = tmp_path_factory.mktemp("docs")
    for name in ("examples", "meshes"):
        (place / name).symlink_to(ROOT / name)
    with contextlib.chdir(place) if hasattr(contextlib, "chdir") else _chdir(place):
        yield {page: {} for page in PAGES}


@contextlib.contextmanager
def _chdir(place):  # Python 3.10
    import os

    before = os.getcwd()
    os.chdir(place)
    try:
        yield
    finally:
        os.chdir(before)


@pytest.mark.parametrize(("page", "code"), PYTHON)
def test_a_block_runs_and_prints_what_it_says(session, request, page, code):
    for name in needed(code):
        pytest.importorskip(name, reason=f"{name} is not installed")
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(compile(code, request.node.name, "exec"), session[page])
    promised = re.findall(r"print\(.*\)  # (.*)$", code, flags=re.MULTILINE)
    assert said.getvalue().splitlines() == promised


def test_the_pages_have_blocks_of_these_languages_alone():
    assert len(PYTHON) >= 13
    assert [{language for language, _ in found} for found in PAGES.values()] == [{"python", "sh"}, {"python", "sh", "snakemake"}, {"python"}]


def test_the_command_that_installs_is_the_one_that_the_tests_use():
    (command,) = [code.strip() for language, code in PAGES["docs/python.md"] if language == "sh"]
    script = (ROOT / "scripts/test-python.sh").read_text(encoding="utf-8")
    assert command in script
