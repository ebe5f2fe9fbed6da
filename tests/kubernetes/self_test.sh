#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# self_test.sh SOURCE: check_manifests.py finds mistakes. Each is made in a copy of the base.
set -euo pipefail

source=$1
check=$(dirname "$0")/check_manifests.py
python=/usr/bin/python3
$python -c 'import yaml' 2>/dev/null || { echo "skipped: Python's yaml is not installed (Debian: python3-yaml)"; exit 77; }
copy=$(mktemp)
old=$(mktemp -d)
trap 'rm -rf "$copy" "$old"' EXIT

base() { for file in "$source"/deploy/kubernetes/base/[^k]*.yaml; do echo "---"; cat "$file"; done; }

# finds MESSAGE SED-COMMAND: the message that follows from the mistake.
finds() {
  local said
  base | sed "$2" >"$copy"
  if said=$($python "$check" "$copy"); then
    echo "not found: $2"
    exit 1
  fi
  grep -qF "$1" <<<"$said" || { printf '%s\nsays\n%s\ninstead of: %s\n' "$2" "$said" "$1"; exit 1; }
}

base >"$copy"
$python "$check" "$copy"
finds "there is no field terminationGraceSeconds" 's/terminationGracePeriodSeconds/terminationGraceSeconds/'
finds "is no integer" 's/periodSeconds: 20/periodSeconds: "20"/'
finds "lacks selector" 's/^  selector:/  selectors:/'
finds "must be a list" 's/accessModes: .*/accessModes: ReadWriteOnce/'
finds "no kind Deployment of apps/v1beta1" 's/apps\/v1$/apps\/v1beta1/'
finds "selects no pods" '/^kind: Service$/,/^---/s/component: coordinator/component: boss/'
finds "names port peers, which those pods have not" 's/name: peers/name: others/'
finds "may run as root" 's/runAsNonRoot: true/runAsNonRoot: false/'
finds "can be written" '/readOnlyRootFilesystem/d'
finds "keeps privileges" 's/drop: \[ALL\]/drop: [NET_RAW]/'
finds "requests no resources" '/requests: {cpu/d'
finds "livenessProbe asks for metrics" 's#/healthz#/metrics#'
finds "there is no volume" 's/- name: tmp/- name: temporary/'
finds "is no quantity" 's/memory: 8Gi/memory: 8 GB/'

# What cannot be built is not said to be checked.
printf '#!/bin/sh\necho "Client Version: v1.20.2"\n' >"$old/kubectl"
chmod +x "$old/kubectl"
status=0
said=$(PATH=$old:$PATH "$(dirname "$0")/check_kubernetes.sh" "$source") || status=$?
[ $status -eq 77 ] && grep -q "^skipped: there is no kubectl" <<<"$said" ||
  { printf 'without kubectl: status %s, and\n%s\n' "$status" "$said"; exit 1; }
