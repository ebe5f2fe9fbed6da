#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_licenses.sh ROOT [--fix]: names every source file below ROOT that does not say its licence at its head, in the first
# line or in the second where the first starts an interpreter. With --fix writes the line into them.
# Exit status 0 if all say it, 1 if some do not.
set -euo pipefail

root=${1:?usage: check_licenses.sh ROOT [--fix]}
fix=${2:-}
cd "$root"
identifier='SPDX-License-Identifier: Apache-2.0'

# The source files, each ended by a 0 byte: by their names, and by the first line where a name has no ending.
sources() {
  local -a outside=(-path ./build -o -path './build-*' -o -path ./out -o -path ./.git -o -path ./tests/fuzz/corpus
    -o -name __pycache__)
  find . \( "${outside[@]}" \) -prune -o -type f \( -name '*.?pp' -o -name '*.proto' -o -name '*.cmake' \
    -o -name '*.cmake.in' -o -name CMakeLists.txt -o -name '*.sh' -o -name '*.py' \) -print0
  find . \( "${outside[@]}" \) -prune -o -type f ! -name '*.*' -size +0 -print0 |
    xargs -0 -r awk '{ if (/^#!/) print FILENAME; nextfile }' | tr '\n' '\0'
}

# Of the files that are read, those without the identifier in their first two lines.
without_identifier() {
  # shellcheck disable=SC2016  # awk's fields
  xargs -0 -r awk -v identifier="$identifier" '
    FNR == 1 { if (file != "") print file; file = FILENAME }
    index($0, identifier) { file = ""; nextfile }
    FNR == 2 { nextfile }
    END { if (file != "") print file }' | LC_ALL=C sort
}

missing=0
while IFS= read -r file; do
  if [ "$fix" = --fix ]; then
    case $file in *.?pp | *.proto) mark=// ;; *) mark='#' ;; esac
    line=1
    ! head -n 1 "$file" | grep -q '^#!' || line=2
    if [ $line -gt "$(wc -l <"$file")" ]; then
      printf '%s %s\n' "$mark" "$identifier" >>"$file"
    else
      sed -i "${line}i $mark $identifier" "$file"
    fi
  else
    echo "$file does not say its licence"
    missing=1
  fi
done < <(sources | without_identifier)
[ $missing = 0 ] || echo "tests/repository/check_licenses.sh . --fix writes '$identifier' into them"
exit $missing
