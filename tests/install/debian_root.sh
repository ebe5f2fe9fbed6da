#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# debian_root.sh OUTPUT: makes the tar file OUTPUT of a root that has nothing but Debian 12 and takes packages from this
# machine's mirror. Exit status 77 where that is not possible: it takes root, debootstrap, and a mirror that answers.
set -euo pipefail

output=$1

skip() {
  echo "debian_root.sh: skipped: $*"
  exit 77
}

[ "$(id -u)" -eq 0 ] || skip "only root can make a root of its own"
command -v debootstrap >/dev/null || skip "there is no debootstrap"
# shellcheck disable=SC2016  # apt's own words
mirror=$(apt-get indextargets --format '$(SITE)|$(RELEASE)|$(COMPONENT)' 'Created-By: Packages' |
  sed -n 's/|bookworm|main$//p' | head -n 1)
[ -n "$mirror" ] || skip "apt names no mirror of Debian 12"

mkdir -p "$(dirname "$output")"
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
debootstrap --variant=minbase --include=ca-certificates bookworm "$work/root" "$mirror" >"$work/log" 2>&1 ||
  { tail -n 5 "$work/log"; skip "debootstrap from $mirror has failed"; }
apt-config dump | grep -E '^Acquire::https?::Proxy' >"$work/root/etc/apt/apt.conf.d/proxy" || true
rm -rf "$work/root/var/cache/apt"/*.bin "$work/root/var/cache/apt/archives"/*.deb "$work/root/var/lib/apt/lists"/*
tar -C "$work/root" -cf "$output" .
