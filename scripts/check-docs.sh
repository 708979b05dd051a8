#!/usr/bin/env bash
# Every relative link in the documentation, and every file of the project it names in `backticks`, exists.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

wrong=0
complain() {
  echo "$1: $2 does not exist"
  wrong=1
}

while read -r page; do
  here=$(dirname "$page")
  while read -r link; do
    [ -e "$here/$link" ] || complain "$page" "$link"
  done < <(grep -oE '\]\([^)#:]+[)#]' "$page" | sed 's/^](//; s/[)#]$//')
  while read -r path; do
    compgen -G "$path" >/dev/null || complain "$page" "$path"
  done < <(grep -oE '`(crates|tests|docs|examples|scripts|benches|meshes)/[A-Za-z0-9_./*-]+`' "$page" | tr -d '`' | sort -u)
done < <(git ls-files '*.md')

[ "$wrong" = 0 ] && echo "All links and file names in the documentation lead somewhere."
exit "$wrong"
