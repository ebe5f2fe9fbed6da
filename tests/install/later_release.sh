#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# later_release.sh PACKAGES OUTPUT: makes the Debian packages of the folder PACKAGES again in the folder OUTPUT, as of a
# later release that has the same files.
set -euo pipefail

packages=$1
output=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

mkdir -p "$output"
for package in "$packages"/*.deb; do
  dpkg-deb -R "$package" "$work/tree"
  version=$(dpkg-deb -f "$package" Version)
  sed -i "s/^Version: .*/Version: $version+later/; s/(= $version)/(= $version+later)/g" "$work/tree/DEBIAN/control"
  dpkg-deb --root-owner-group -Zgzip -z1 -b "$work/tree" "$output" >/dev/null
  rm -r "$work/tree"
done
