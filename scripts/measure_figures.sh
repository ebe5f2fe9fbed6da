#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# measure_figures.sh DIR: from the images that run_all.sh rendered into DIR, the errors and times that
# docs/notebook/report.md reports, as Markdown. Errors are in linear light, against the reference of the same scene.
set -euo pipefail

[ $# -eq 1 ] || { echo "Usage: measure_figures.sh DIR" >&2; exit 2; }
images=$1
root=$(dirname "${BASH_SOURCE[0]}")/..
tessera=$root/build/release/bin/tessera
for name in small_light_{naive,nee,reference} uniform half_vector visible_normals cook_torrance_reference \
  veach_{naive,nee,mis}{,_pair_1,_pair_2} veach_reference; do
  for file in "$images/$name.exr" "$images/$name.json"; do
    [ -s "$file" ] || { echo "measure_figures.sh: there is no $file; ./run_all.sh makes it" >&2; exit 1; }
  done
done

# error_of KEY IMAGE REFERENCE [OPTIONS...]: a number of the comparison, e.g. mse.
error_of() {
  local key=$1 image=$2 reference=$3 status=0 json
  shift 3
  json=$("$tessera" compare "$images/$image.exr" "$images/$reference.exr" --json "$@") || status=$?
  [ "$status" -le 1 ] || exit "$status"
  jq -r ".$key" <<<"$json"
}

statistic() { jq -r ".$2" "$images/$1.json"; }
calculate() { awk "BEGIN { printf \"%.4g\", ${1//$'\n'/ } }"; }

# table REFERENCE IMAGE...: samples, time and errors of each.
table() {
  local reference=$1 name
  shift
  echo "| image | samples per pixel | seconds | MSE | relative MSE |"
  echo "|---|---|---|---|---|"
  for name in "$@"; do
    echo "| $name | $(statistic "$name" spp) | $(calculate "$(statistic "$name" render_seconds)") |" \
      "$(calculate "$(error_of mse "$name" "$reference")") |" \
      "$(calculate "$(error_of relative_mse "$name" "$reference")") |"
  done
  echo "| $reference | $(statistic "$reference" spp) | $(calculate "$(statistic "$reference" render_seconds)") | | |"
}

# ratio KEY A B REFERENCE: of an error of image A over that of B.
ratio() { calculate "$(error_of "$1" "$2" "$4") / $(error_of "$1" "$3" "$4")"; }

# The time to equal error is time times MSE, as the MSE falls with the number of samples.
time_ratio() {
  calculate "$(statistic "$1" render_seconds) * $(error_of mse "$1" "$3") /
    ($(statistic "$2" render_seconds) * $(error_of mse "$2" "$3"))"
}

small_light() {
  local reference=small_light_reference
  echo "## small_light"
  echo
  table "$reference" small_light_naive small_light_nee
  echo
  echo "- MSE of naive over that of nee: $(ratio mse small_light_naive small_light_nee "$reference")"
  echo "- time to equal MSE, naive over nee: $(time_ratio small_light_naive small_light_nee "$reference")"
  echo
}

cook_torrance() {
  local reference=cook_torrance_reference
  echo "## cook_torrance_sampling"
  echo
  table "$reference" uniform half_vector visible_normals
  echo
  echo "- MSE, uniform over half vector: $(ratio mse uniform half_vector "$reference")"
  echo "- MSE, half vector over visible normals: $(ratio mse half_vector visible_normals "$reference")"
  echo
}

# variance_in REGION STRATEGY: half the mean squared difference of two images of the strategy with different
# seeds, which needs no reference.
variance_in() {
  calculate "$(error_of mse "veach_$2_pair_1" "veach_$2_pair_2" --region "$1") / 2"
}

# Balance-heuristic MIS is worse than no combination of the same samples by more than half the squared mean
# (Veach 1997, theorem 9.2, with one sample of each of two strategies), per sample.
veach_regions() {
  local spp name region naive nee mis bound
  spp=$(statistic veach_mis_pair_1 spp)
  echo "Variance of a pixel at $spp samples:"
  echo
  echo "| region | naive | nee | mis | mis at most |"
  echo "|---|---|---|---|---|"
  while read -r name region; do
    naive=$(variance_in "$region" naive)
    nee=$(variance_in "$region" nee)
    mis=$(variance_in "$region" mis)
    bound=$(calculate "($naive < $nee ? $naive : $nee) +
      $(error_of reference_mean_square veach_mis_pair_1 veach_mis_pair_2 --region "$region") / (2 * $spp)")
    echo "| $name | $naive | $nee | $mis | $bound |"
  done < <(regions)
}

# The marked regions in pixels of the images at hand; the file has them in those of an image 768 wide.
regions() {
  awk -v scale="$(calculate "$(statistic veach_mis width) / 768")" '
    /^[^#]/ { printf "%s %d,%d,%dx%d\n", $1, $2 * scale, $3 * scale, $4 * scale, $5 * scale }' \
    "$root/scenes/veach_mis/regions.txt"
}

veach_mis() {
  local reference=veach_reference
  echo "## veach_mis"
  echo
  table "$reference" veach_naive veach_nee veach_mis
  echo
  echo "- MSE of mis over that of nee: $(ratio mse veach_mis veach_nee "$reference") (the report: 454.4 / 524.6 = 0.866)"
  echo
  veach_regions
}

small_light
cook_torrance
veach_mis
