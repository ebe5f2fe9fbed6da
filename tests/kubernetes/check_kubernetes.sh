#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_kubernetes.sh SOURCE: builds the base and each overlay of deploy/kubernetes, and checks what comes out. Without a
# kubectl that can build them (Debian 12 has 1.20, which cannot), it checks the files of the base one by one, and is
# skipped if there is nothing wrong with them: exit status 77.
set -euo pipefail

folder=$1/deploy/kubernetes
check=$(dirname "$0")/check_manifests.py
python=/usr/bin/python3  # that of Debian, which has Debian's yaml
[ -x $python ] || { echo "skipped: there is no $python"; exit 77; }
if ! kubectl version --client 2>/dev/null | grep -q '^Kustomize Version: v[4-9]'; then
  find "$folder"/base -name '*.yaml' ! -name kustomization.yaml -exec $python "$check" --parts {} +
  echo "skipped: there is no kubectl of Kubernetes 1.25 or later to build the overlays (the files of the base were checked)"
  exit 77
fi
built=$(mktemp -d)
trap 'rm -rf "$built"' EXIT
for kustomization in "$folder"/base "$folder"/overlays/*; do
  kubectl kustomize "$kustomization" >"$built/$(basename "$kustomization").yaml"
done
[ "$(find "$built" -name '*.yaml' | wc -l)" -ge 4 ] || { echo "there are overlays missing"; exit 1; }
$python "$check" "$built"/*.yaml
