#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# closing_image.sh [SPP]: what one sample of scenes/go at 3328x2048 costs on one core, measured over the whole image
# at SPP samples per pixel (4), and what 8192 would cost, as a row of Markdown.
set -euo pipefail

spp=${1:-4}
root=$(dirname "${BASH_SOURCE[0]}")/..
tessera=${TESSERA_BIN:-$root/build/profiled/bin}/tessera
[ -x "$tessera" ] || { echo "closing_image.sh: there is no $tessera; ./run.sh builds it" >&2; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

"$tessera" render go --size 3328x2048 --spp "$spp" --threads 1 --quiet \
  -o "$folder/go.pfm" --stats "$folder/go.json"
echo "| scene | µs of a core for each sample | core-hours for 8192 spp |"
echo "|---|---|---|"
jq -r '(.render_core_seconds / .samples) as $seconds |
  "| go, 3328 × 2048 | \($seconds * 1e8 | round / 100) | \($seconds * 3328 * 2048 * 8192 / 3600 | round) |"' \
  "$folder/go.json"
