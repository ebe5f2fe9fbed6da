#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# write_command_line_docs.sh BIN: puts the --help of the programs in the folder BIN into docs/command-line.md, below
# the lines that ask for it: <!-- tessera render --help -->
set -euo pipefail

bin=${1:?usage: write_command_line_docs.sh BIN}
page=$(dirname "$0")/../docs/command-line.md
written=$(mktemp)
trap 'rm -f "$written"' EXIT

in_old_block=no
while IFS= read -r line; do
  if [ "$in_old_block" = yes ]; then
    [ "$line" != '```' ] || in_old_block=no
    continue
  fi
  printf '%s\n' "$line"
  if [[ $line =~ ^'<!-- '(tessera[a-z -]*)' --help -->'$ ]]; then
    read -ra command <<<"${BASH_REMATCH[1]}"
    printf '```text\n'
    "$bin/${command[0]}" "${command[@]:1}" --help
    printf '```\n'
    in_old_block=yes
  fi
done <"$page" >"$written"
cat "$written" >"$page"
