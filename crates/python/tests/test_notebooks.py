"""The notebooks of docs/notebooks run, and print what they show; their pictures are not compared.

    python crates/python/tests/test_notebooks.py        runs them and writes what they print and draw
"""

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
PLACE = ROOT / "docs/notebooks"
NOTEBOOKS = sorted(PLACE.glob("*.ipynb"))
#: A picture in a notebook, in bytes as text.
LARGEST = 150_000


def executed(file: Path, directory: Path):
    import nbformat
    from nbclient import NotebookClient

    notebook = nbformat.read(file, as_version=4)
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(directory)}}).execute()
    return notebook


def cells(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def said(cell) -> str:
    """What a cell prints, or shows as text where it draws nothing."""
    texts = [out.text for out in cell.outputs if out.output_type == "stream" and out.name == "stdout"]
    shown = [out.data["text/plain"] for out in cell.outputs if out.output_type == "execute_result" and "image/png" not in out.data]
    return "".join(texts + shown)


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_a_notebook_prints_what_it_shows(file, tmp_path):
    for name in ("nbclient", "ipykernel", "matplotlib", "scipy"):
        pytest.importorskip(name, reason=f"{name} is not installed")
    import nbformat

    for name in ("examples", "meshes"):
        (tmp_path / name).symlink_to(ROOT / name)
    stored = nbformat.read(file, as_version=4)
    found = executed(file, tmp_path)
    assert [said(cell) for cell in cells(found)] == [said(cell) for cell in cells(stored)]
    errors = [out for cell in cells(found) for out in cell.outputs if out.output_type == "error" or out.get("name") == "stderr"]
    assert not errors


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_a_notebook_shows_pictures_of_a_sane_size(file):
    nbformat = pytest.importorskip("nbformat", reason="nbformat is not installed")
    stored = nbformat.read(file, as_version=4)
    pictures = [out.data["image/png"] for cell in cells(stored) for out in cell.outputs if "image/png" in out.get("data", {})]
    assert pictures and max(map(len, pictures)) < LARGEST
    assert file.name in (PLACE / "README.md").read_text(encoding="utf-8")


def write():
    import nbformat

    for file in NOTEBOOKS:
        notebook = executed(file, ROOT)
        for cell in notebook.cells:
            cell.metadata.pop("execution", None)  # when it ran
        notebook.metadata = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}}
        nbformat.write(notebook, file)


if __name__ == "__main__":
    write()
