#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds Tessera, renders every scene that comes with it, measures what docs/notebook/report.md reports, and puts all
# images on one sheet. Needs Debian 12.
set -euo pipefail
started_in=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")"

usage() {
  cat <<'EOF_USAGE'
Usage: ./run_all.sh [--quick] [--out DIR]

Renders every scene of scenes/, with one line for each image, into out/report (or DIR):
  NAME.png, NAME.exr     the images
  NAME.json              their statistics: times, rays, memory
  measurements.md        the errors and times that docs/notebook/report.md reports
  contact_sheet.png      all images on one sheet

  --quick     smaller images with fewer samples: under five minutes on two cores; without it, many times that
EOF_USAGE
}

quick=false
out=$PWD/out/report
while [ $# -gt 0 ]; do
  case $1 in
    --quick) quick=true ;;
    --out)
      [ -n "${2:-}" ] || { echo "run_all.sh: --out needs a folder" >&2; exit 2; }
      case $2 in /*) out=$2 ;; *) out=$started_in/$2 ;; esac
      shift
      ;;
    -h | --help) usage; exit 0 ;;
    *) echo "run_all.sh: unknown option '$1'" >&2; usage >&2; exit 2 ;;
  esac
  shift
done

# Every image: name, scene file, then size and samples per pixel, in full and with --quick, then options.
# References have another seed than what is measured against them.
images=(
  "whitted                 whitted_and_path/whitted.json                640x400 128   320x200 16"
  "path                    whitted_and_path/path.json                   640x400 128   320x200 128"
  "small_light_naive       small_light/scene.json                       320x200 128   160x100 128   --integrator naive"
  "small_light_nee         small_light/scene.json                       320x200 16    160x100 16    --integrator nee"
  "small_light_reference   small_light/scene.json                       320x200 2048  160x100 1024  --integrator mis --seed 1"
  "uniform                 cook_torrance_sampling/uniform.json          320x200 128   160x100 128"
  "half_vector             cook_torrance_sampling/half_vector.json      320x200 128   160x100 128"
  "visible_normals         cook_torrance_sampling/visible_normals.json  320x200 128   160x100 128"
  "cook_torrance_reference cook_torrance_sampling/visible_normals.json  320x200 2048  160x100 1024  --integrator mis --seed 1"
  "veach_naive             veach_mis/scene.json                         384x256 16    192x128 16    --integrator naive"
  "veach_nee               veach_mis/scene.json                         384x256 16    192x128 16    --integrator nee"
  "veach_mis               veach_mis/scene.json                         384x256 16    192x128 16    --integrator mis"
  "veach_reference         veach_mis/scene.json                         384x256 8192  192x128 2048  --integrator naive --seed 1"
  "veach_naive_pair_1      veach_mis/scene.json                         384x256 256   192x128 256   --integrator naive --seed 2"
  "veach_naive_pair_2      veach_mis/scene.json                         384x256 256   192x128 256   --integrator naive --seed 3"
  "veach_nee_pair_1        veach_mis/scene.json                         384x256 256   192x128 256   --integrator nee --seed 2"
  "veach_nee_pair_2        veach_mis/scene.json                         384x256 256   192x128 256   --integrator nee --seed 3"
  "veach_mis_pair_1        veach_mis/scene.json                         384x256 256   192x128 256   --integrator mis --seed 2"
  "veach_mis_pair_2        veach_mis/scene.json                         384x256 256   192x128 256   --integrator mis --seed 3"
  "water_no_fresnel        glass_and_water/no_fresnel.json              640x400 256   320x200 64"
  "water_fresnel           glass_and_water/fresnel.json                 640x400 256   320x200 64"
  "menagerie               menagerie/scene.json                         640x400 256   320x200 64"
  "go                      go/scene.json                                832x512 256   416x256 64"
  "cornell                 cornell/scene.json                           512x512 256   256x256 64"
  "still_life              still_life/scene.json                        960x640 256   300x200 64"
)

bin=build/release/bin
log=build/release.log

# image NUMBER NAME SCENE SIZE SPP [OPTIONS...]: renders it and says how long it took.
image() {
  local number=$1 name=$2 scene=$3 size=$4 spp=$5
  shift 5
  printf '[%2d/%d] %-24s %-8s %5s spp  ' "$number" ${#images[@]} "$name" "$size" "$spp"
  "$bin/tessera" render "build/release/share/tessera/scenes/$scene" --size "$size" --spp "$spp" "$@" --quiet \
    -o "$out/$name.png" -o "$out/$name.exr" --stats "$out/$name.json"
  jq -r '"\(.render_seconds * 10 | round / 10) s, \(.samples_per_second / 1e4 | round / 100) million samples/s"' \
    "$out/$name.json"
}

render_all() {
  local i name scene full_size full_spp quick_size quick_spp options
  for i in "${!images[@]}"; do
    read -r name scene full_size full_spp quick_size quick_spp options <<<"${images[i]}"
    # shellcheck disable=SC2086  # options are words
    if "$quick"; then
      image $((i + 1)) "$name" "$scene" "$quick_size" "$quick_spp" $options
    else
      image $((i + 1)) "$name" "$scene" "$full_size" "$full_spp" $options
    fi
  done
}

contact_sheet() {
  local i name tiles=()
  for i in "${!images[@]}"; do
    read -r name _ <<<"${images[i]}"
    tiles+=(-label "$name" "$out/$name.png")
  done
  gm montage -font /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf -pointsize 13 \
    -background '#202020' -fill '#e0e0e0' -geometry '320x240+8+8' -tile 4x "${tiles[@]}" "$out/contact_sheet.png"
}

echo "== Packages"
scripts/setup.sh

echo "== Build (some minutes the first time)"
mkdir -p build "$out"
if ! { cmake --preset release && cmake --build --preset release --parallel "$(nproc)" --target tessera scene_files; } \
  >"$log" 2>&1; then
  tail -n 60 "$log" >&2
  echo "run_all.sh: the build failed; the whole log is in $log" >&2
  exit 1
fi

echo "== Images"
render_all

echo "== Measurements"
scripts/measure_figures.sh "$out" | tee "$out/measurements.md"

contact_sheet
echo "== Done"
echo "All images on one sheet: $out/contact_sheet.png"
