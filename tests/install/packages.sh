#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# packages.sh BUILD CPACK: makes the Debian packages and the tarball, installs the packages in a root that has nothing but
# Debian, renders there, in one process and on a farm, removes them, and looks for what is left. The tarball's program then
# renders the same in the root without the packages.
# Exit status 77 where that cannot be tried: it takes root, debootstrap, and a Debian mirror that answers.
set -euo pipefail

build=$1
cpack=$2
work=$(mktemp -d)
root=$work/root
mounted=

clean_up() {
  [ -z "$mounted" ] || umount -l "$root/proc"
  rm -rf --one-file-system "$work"
}
trap clean_up EXIT

skip() {
  echo "packages.sh: skipped: $*"
  exit 77
}

fail() {
  echo "packages.sh: $*" >&2
  exit 1
}

quiet() {
  "${@:2}" >"$work/log" 2>&1 || { tail -n 60 "$work/log" >&2; fail "$1 failed"; }
}

inside() { chroot "$root" env PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 HOME=/srv "$@"; }

# traces: the files in the root that are Tessera's by their names, but for those of apt and what rendering has written.
traces() {
  inside find / -xdev \( -path /proc -o -path /srv -o -path '/var/*' \) -prune -o -type f -path '*tessera*' -print
}

[ "$(id -u)" -eq 0 ] || skip "only root can make a root of its own"
for program in debootstrap dpkg-shlibdeps; do command -v $program >/dev/null || skip "there is no $program"; done
# shellcheck disable=SC2016  # apt's own words
mirror=$(apt-get indextargets --format '$(SITE)|$(RELEASE)|$(COMPONENT)' 'Created-By: Packages' |
  sed -n 's/|bookworm|main$//p' | head -n 1)
[ -n "$mirror" ] || skip "apt names no mirror of Debian 12"

quiet "cpack" "$cpack" --config "$build/CPackConfig.cmake" -B "$work/packages"
echo "packages: $(cd "$work/packages" && echo *.deb *.tar.gz)"

debootstrap --variant=minbase --include=ca-certificates bookworm "$root" "$mirror" >"$work/log" 2>&1 ||
  { tail -n 5 "$work/log"; skip "debootstrap from $mirror has failed"; }
apt-config dump | grep -E '^Acquire::https?::Proxy' >"$root/etc/apt/apt.conf.d/proxy" || true
mount -t proc proc "$root/proc" && mounted=yes || skip "/proc cannot be mounted"
traces >"$work/before"

mkdir "$root/packages"
cp "$work"/packages/*.deb "$root/packages"
quiet "apt-get update" inside apt-get -qq update
quiet "installing" inside sh -c 'apt-get install -y --no-install-recommends /packages/*.deb'

for program in tessera tessera-coordinator tessera-validator tessera-worker tessera-scene-loader; do
  inside "$program" --version >"$work/version" || fail "$program --version failed"
  grep -q "^$program [0-9]" "$work/version" || fail "$program --version says: $(cat "$work/version")"
done
quiet "rendering" inside tessera render cornell --size 48x32 --spp 4 --quiet -o /srv/alone.pfm
quiet "rendering on a farm" inside bash -c '
  set -euo pipefail
  cd /srv
  tessera-coordinator --listen 127.0.0.1:0 --state /srv/state >coordinator.log 2>&1 &
  for ((i = 0; i < 600; ++i)); do grep -q "listening on" coordinator.log && break; sleep 0.1; done
  address=$(sed -n "s/.*listening on //p" coordinator.log)
  tessera-worker --coordinator "$address" --threads 1 --cache /srv/cache >worker.log 2>&1 &
  trap "kill \$(jobs -p); wait; cat coordinator.log worker.log" EXIT
  tessera submit cornell --coordinator "$address" --size 48x32 --spp 4 --wait -o farm.pfm'
cmp "$root/srv/alone.pfm" "$root/srv/farm.pfm" || fail "the farm renders other bytes"

quiet "removing" inside apt-get purge -y tessera tessera-coordinator tessera-worker libtessera libtessera-dev
rm -r "$root/packages"
traces >"$work/after"
cmp "$work/before" "$work/after" || fail "removing leaves $(head -n 5 "$work/after")"

# The libraries that apt installed for the packages are still there.
mkdir "$root/tree"
tar -xzf "$work"/packages/*.tar.gz -C "$root/tree" --strip-components=1
quiet "the tarball's program" inside /tree/bin/tessera render cornell --size 48x32 --spp 4 --quiet -o /srv/tree.pfm
cmp "$root/srv/alone.pfm" "$root/srv/tree.pfm" || fail "the tarball's program renders other bytes"
