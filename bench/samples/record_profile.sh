#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# record_profile.sh RENDER_SAMPLES SCENES: renders the scenes below SCENES small with a build that records what it does
# (cmake/TesseraProfile.cmake). The same every time, so that the same sources make the same program.
set -euo pipefail

render_samples=$1
scenes=$2
side=96
spp=8

for scene in cornell/scene veach_mis/scene go/scene glass_and_water/fresnel still_life/scene menagerie/scene \
  small_light/scene whitted_and_path/path whitted_and_path/whitted; do
  echo "$scene"
  "$render_samples" "$scenes/$scene.json" "$side" "$spp"
done
