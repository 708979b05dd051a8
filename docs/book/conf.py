"""The documentation as a book with search: scripts/book.sh."""

import pathlib
import re

from pygments.lexers.data import JsonLexer
from pygments.lexers.python import PythonLexer
from sphinx.highlighting import lexers

ROOT = pathlib.Path(__file__).resolve().parents[2]

project = "nastic"
author = "The nastic developers"
copyright = "The nastic developers"
release = re.search(r'^version = "(.+)"$', (ROOT / "Cargo.toml").read_text(), re.MULTILINE).group(1)

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
# The pages stay where they are read in the repository; the book adds its own contents, gallery and reference.
# JSON with comments is what case files are.
lexers["jsonc"] = JsonLexer()
lexers["snakemake"] = PythonLexer()

root_doc = "docs/book/index"
include_patterns = ["README.md", "CHANGELOG.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "docs/**"]
exclude_patterns = ["**/build"]
myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence"]
# Attributes named as built-in types, `slice` of controls and constraints, are found twice.
suppress_warnings = ["ref.python"]

html_theme = "furo"
html_title = f"nastic {release}"
html_static_path = []
html_show_sourcelink = False
html_copy_source = False
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
