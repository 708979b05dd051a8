#!/usr/bin/env bash
# The documentation as a book with search: target/book/index.html. Warnings are errors, so that every link between pages leads somewhere.
#
#   scripts/book.sh
#
# Beside the pages it has what is there: a gallery of the cases that scripts/slow.sh ran, the reference of the library (cargo doc --workspace --no-deps),
# the reference of the Python package (scripts/test-python.sh installs it). What is not there is named. Needs python3 with venv, and the network once.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

env="$PWD/target/book-env"
[ -x "$env/bin/python" ] || python3 -m venv "$env"
"$env/bin/python" -m pip --disable-pip-version-check --quiet install -r scripts/requirements-book.txt

package=$(target/python-package/bin/python -c 'import nastic, pathlib; print(pathlib.Path(nastic.__file__).parents[1])' 2>/dev/null || true)
{
  printf '# Python reference\n\n[How to use the package](../python.md).\n\n'
  if [ -n "$package" ]; then
    printf '```{eval-rst}\n.. automodule:: nastic\n   :members:\n   :imported-members:\n```\n'
  else
    echo "Not part of this copy of the book: the package was not installed when it was made."
    echo "without the reference of the Python package: scripts/test-python.sh has not installed it" >&2
  fi
} >docs/book/python.md
python3 scripts/gallery.py target/slow docs/book
keys() { # PAGE TITLE OPTIONS
  if [ -x target/release/nastic ]; then
    target/release/nastic schema "${@:3}" --markdown >"docs/book/$1.md"
  else
    printf '# %s\n\nNot part of this copy of the book: the program was not built when it was made.\n' "$2" >"docs/book/$1.md"
    echo "without the $1: cargo build --release has not made the program" >&2
  fi
}
keys keys-of-case-files "Keys of case files"
keys keys-of-results "Keys of results" --results

rm -rf target/book
PYTHONPATH="$package" "$env/bin/sphinx-build" -W --keep-going -q -E -b html -d target/book-doctrees -c docs/book . target/book
cat >target/book/index.html <<'PAGE'
<!DOCTYPE html><meta charset="utf-8"><title>nastic</title><meta http-equiv="refresh" content="0; url=docs/book/index.html"><a href="docs/book/index.html">nastic</a>
PAGE
if [ -f target/doc/nastic/index.html ]; then
  cp -r target/doc target/book/rust
else
  echo "without the reference of the library: cargo doc --release --workspace --no-deps has not made it"
fi
echo "target/book/index.html: $(find target/book/docs target/book/*.html -name '*.html' | wc -l) pages"
