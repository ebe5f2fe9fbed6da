#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Renders the images of the documentation into docs/images, by the commands in docs/images/commands.txt.
set -euo pipefail

usage() {
  cat <<'EOF_USAGE'
Usage: scripts/render_docs_images.sh BIN [NAME]...

Renders docs/images/NAME.png, or all of them, with the tessera in the folder BIN. The example scenes must be built
(target scene_files). All images take more than an hour of one core. Look at them before you commit them.
EOF_USAGE
}

case ${1:-} in
  '') usage >&2; exit 2 ;;
  -h | --help) usage; exit 0 ;;
esac
bin=$(realpath "$1")
shift
docs=$(realpath "$(dirname "$0")/../docs")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# The scene that docs/scene-format.md begins with.
awk '/^```jsonc$/ { inside = 1; next } inside && /^```$/ { exit } inside' "$docs/scene-format.md" >first.json

is_wanted() {
  local image=$1 name
  shift
  [ $# -gt 0 ] || return 0
  for name; do [ "$image" != "$name.png" ] || return 0; done
  return 1
}

while read -r -a command; do
  image=${command[-1]}
  is_wanted "$image" "$@" || continue
  echo "${command[*]}"
  "$bin/${command[0]}" "${command[@]:1}"
  mv "$image" "$docs/images/"
done < <(grep -v '^#' "$docs/images/commands.txt")
