#!/usr/bin/env bash
# Every relative link in the documentation, its heading included, and every file or directory of the project it names in
# `backticks`, exists; no cell of a table has more than 200 characters; all pages together have at most `size_limit` bytes.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

cell_limit=200
# Bytes of all pages and of the notebooks without their pictures: lower it with the pages; it rises with a capability alone, by what its pages take.
size_limit=693300
wrong=0
complain() {
  echo "$1: $2"
  wrong=1
}

# The anchors that a page's headings make: lower case, no punctuation, hyphens for spaces.
anchors() { # PAGE
  awk '/^```/ { code = !code } !code && /^#+ /' "$1" |
    sed 's/^#* //; s/\[\([^]]*\)\]([^)]*)/\1/g' | tr '[:upper:]' '[:lower:]' | sed 's/[^a-z0-9_ -]//g; s/ /-/g'
}

# "LINE CHARACTERS" of the cells that are too long; a bar within a cell is written \|.
long_cells() { # PAGE
  awk -v limit="$cell_limit" '
    /^```/ { code = !code }
    !code && /^ *\|/ {
      gsub(/\\\|/, "!")
      cells = split($0, cell, "|")
      for (i = 1; i <= cells; i++) {
        gsub(/^ +| +$/, "", cell[i])
        if (length(cell[i]) > limit) print NR, length(cell[i])
      }
    }' "$1"
}

tracked=$(git ls-files | sed 's|^|/|')
# Whole paths, and ends of paths such as `solver/direct.rs`; a directory ends with a slash.
is_tracked() { # NAME
  local pattern
  pattern=$(sed 's/\./\\./g; s/\*/[^ ]*/g' <<<"$1")
  [[ "$1" == */ ]] || pattern="$pattern(/|$)"
  grep -qE "/$pattern" <<<"$tracked"
}

while read -r page; do
  here=$(dirname "$page")
  while IFS='#' read -r link heading; do
    target="$page"
    [ -z "$link" ] || target="$here/$link"
    if [ ! -e "$target" ]; then
      complain "$page" "$link does not exist"
    elif git check-ignore -q "$target"; then
      complain "$page" "$link is made by a script: a fresh checkout does not have it"
    elif [ -n "$heading" ] && [[ "$target" == *.md ]]; then
      anchors "$target" | grep -qxF -- "$heading" || complain "$page" "$target has no heading #$heading"
    fi
  done < <(tr '\n' ' ' <"$page" | grep -oE '\]\( *[^): ]+\)' | sed -E 's/^\]\( *//; s/\)$//' | sort -u)
  while read -r path; do
    is_tracked "$path" || complain "$page" "$path does not exist"
  done < <(grep -oE '`[A-Za-z0-9_.*-]+(/[A-Za-z0-9_.*-]+)*/?`' "$page" | tr -d '`' |
    grep -E '^(crates|tests|docs|examples|scripts|benches|meshes)/|\.rs$|/$' | grep -vE '^(target|out)/' | sort -u)
  while read -r line characters; do
    complain "$page:$line" "a table cell of $characters characters; $cell_limit are allowed: say it below the table"
  done < <(long_cells "$page")
done < <(git ls-files '*.md')

# As the last of the long steps (scripts/book.sh) would say of a page that no list of the book's contents holds.
contents=docs/book/index.md
while read -r page; do
  name=${page#docs/}
  grep -qxF -e "../${name%.md}" -e "../${name%/*}/*" "$contents" || complain "$page" "is in no list of $contents"
done < <(git ls-files 'docs/*.md' 'docs/**/*.md' | sort -u | grep -v '^docs/book/')

size=$(git ls-files -z '*.md' '*.ipynb' | python3 -c '
import json, pathlib, sys

def without_pictures(part):
    if isinstance(part, dict):
        return {key: without_pictures(value) for key, value in part.items() if not key.startswith("image/")}
    return [without_pictures(one) for one in part] if isinstance(part, list) else part

def size(page):
    text = pathlib.Path(page).read_bytes()
    return len(json.dumps(without_pictures(json.loads(text)), indent=1)) if page.endswith(".ipynb") else len(text)

print(sum(map(size, sys.stdin.read().split("\0")[:-1])))')
[ "$size" -le "$size_limit" ] || complain "the documentation" "$size bytes; $size_limit are allowed"

[ "$wrong" = 0 ] && echo "All links and file names in the documentation lead somewhere; no table cell is over $cell_limit characters."
exit "$wrong"
