#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_kubernetes.sh SOURCE: builds the base and each overlay of deploy/kubernetes, and checks what comes out. Without
# kubectl, it checks the files of the base one by one.
set -euo pipefail

folder=$1/deploy/kubernetes
check=$(dirname "$0")/check_manifests.py
python=/usr/bin/python3  # that of Debian, which has Debian's yaml
[ -x $python ] || { echo "skipped: there is no $python"; exit 77; }
if ! command -v kubectl >/dev/null; then
  find "$folder"/base -name '*.yaml' ! -name kustomization.yaml -exec $python "$check" --parts {} +
  exit
fi
built=$(mktemp -d)
trap 'rm -rf "$built"' EXIT
for kustomization in "$folder"/base "$folder"/overlays/*; do
  kubectl kustomize "$kustomization" >"$built/$(basename "$kustomization").yaml"
done
[ "$(find "$built" -name '*.yaml' | wc -l)" -ge 4 ] || { echo "there are overlays missing"; exit 1; }
$python "$check" "$built"/*.yaml
