#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# packages.sh PACKAGES ROOT: installs the packages of the folder PACKAGES in the root of the tar file ROOT, which has
# nothing but Debian, renders there, in one process and on a farm that is upgraded meanwhile, removes them, and looks for
# what is left. The tarball's program then renders the same in the root without the packages.
# Exit status 77 without the root.
set -euo pipefail

packages=$1
debian=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
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
  inside find / -xdev \( -path /proc -o -path /srv -o -path '/var/*' \) -prune -o ! -type d -path '*tessera*' -print
}

ls "$packages"/*.deb >/dev/null 2>&1 || skip "there are no packages (install.make_packages)"
[ -e "$debian" ] || skip "there is no root of Debian (install.debian_root)"
mkdir "$root"
tar -C "$root" -xf "$debian"
mount -t proc proc "$root/proc" && mounted=yes || skip "/proc cannot be mounted"
traces >"$work/before"

mkdir "$root/packages"
cp "$packages"/*.deb "$root/packages"
quiet "apt-get update" inside apt-get -qq update

# What the first stage of deploy/container/Dockerfile installs, whose image starts as this root does.
# shellcheck disable=SC2154  # the lists are the script's
to_compile() {
  (eval "$(sed -n '/^build=(/,/^)/p; /^package=(/,/^)/p' "$here/../../scripts/setup.sh")" && echo "${build[@]}" "${package[@]}")
}
# shellcheck disable=SC2046  # one word each
quiet "finding what compiling needs" inside apt-get install --simulate --no-install-recommends $(to_compile)
# Without the farm, the command line says what its demo lacks.
quiet "installing the command line" inside sh -c \
  'apt-get install -y --no-install-recommends /packages/tessera_*.deb /packages/libtessera[0-9]*.deb'
inside dpkg-query -W -f '${Recommends}' tessera | grep -qx 'tessera-coordinator, tessera-worker' || fail "no farm is recommended"
! inside tessera demo cornell --once >"$work/demo" 2>&1 || fail "the demo has a farm"
grep -q "apt-get install ./tessera-coordinator_\*.deb ./tessera-worker_\*.deb" "$work/demo" ||
  fail "the demo says: $(cat "$work/demo")"
quiet "installing" inside sh -c 'apt-get install -y --no-install-recommends /packages/*.deb'

for program in tessera tessera-coordinator tessera-validator tessera-worker tessera-scene-loader; do
  inside "$program" --version >"$work/version" || fail "$program --version failed"
  grep -q "^$program [0-9]" "$work/version" || fail "$program --version says: $(cat "$work/version")"
done
quiet "the demo" inside timeout 120 tessera demo cornell --once
quiet "rendering" inside tessera render cornell --size 48x32 --spp 4 --quiet -o /srv/alone.pfm
# Services are enabled for the next boot, and their options are files of the machine. There is no systemd to start them.
for service in coordinator worker; do
  [ -e "$root/usr/lib/systemd/system/tessera-$service.service" ] || fail "there is no unit of the $service"
  [ -L "$root/etc/systemd/system/multi-user.target.wants/tessera-$service.service" ] || fail "the $service is not enabled"
  grep -qx "/etc/tessera/$service.conf" "$root/var/lib/dpkg/info/tessera-$service.conffiles" || fail "no file of options"
done
printf '%s\n' 'threads = 1' 'name = edited' >>"$root/etc/tessera/worker.conf"

# A farm that is upgraded while it renders: new files under running programs, then a restart, as the packages do it.
"$here/later_release.sh" "$packages" "$root/packages/later"
cat >"$root/srv/farm.sh" <<'END'
set -euo pipefail
cd /srv
start() {
  : >coordinator.log  # not the address of an earlier one
  TESSERA_COORDINATOR_LISTEN=127.0.0.1:${1:-0} TESSERA_COORDINATOR_STATE=/srv/state TESSERA_COORDINATOR_HTTP=off \
    tessera-coordinator --config /etc/tessera/coordinator.conf >>coordinator.log 2>&1 &
  coordinator=$!
  for ((i = 0; i < 600; ++i)); do grep -q "listening on" coordinator.log && break; sleep 0.1; done
  export TESSERA_COORDINATOR=$(sed -n "s/.*listening on //p" coordinator.log)
  TESSERA_WORKER_CACHE=/srv/cache tessera-worker --config /etc/tessera/worker.conf >>worker.log 2>&1 &
  worker=$!
}
await_worker() {
  for ((i = 0; i < 600; ++i)); do tessera workers | grep -q edited && return; sleep 0.1; done
  return 1
}
trap 'kill $(jobs -p) || true; wait; cat coordinator.log worker.log' EXIT
start
job=$(tessera submit cornell --size 48x32 --spp 64 | head -n 1)
await_worker
apt-get install -y --no-install-recommends -o APT::Sandbox::User=root /packages/later/*.deb
kill "$worker" "$coordinator"
wait "$worker"
wait "$coordinator"
start "${TESSERA_COORDINATOR##*:}"
tessera watch "$job"
tessera image "$job" -o farm.pfm
await_worker
END
quiet "upgrading a farm while it renders" inside bash /srv/farm.sh
quiet "rendering the same" inside tessera render cornell --size 48x32 --spp 64 --quiet -o /srv/same.pfm
cmp "$root/srv/same.pfm" "$root/srv/farm.pfm" || fail "the farm renders other bytes"
grep -qx 'name = edited' "$root/etc/tessera/worker.conf" || fail "the upgrade has replaced a file that was edited"
[ "$(inside dpkg-query -W -f '${Version}' tessera-worker | grep -c later)" -eq 1 ] || fail "the upgrade did not happen"

mapfile -t installed < <(inside dpkg-query -W -f '${Package}\n' 'tessera*' 'libtessera*')
[ ${#installed[@]} -eq 5 ] || fail "there are ${#installed[@]} packages: ${installed[*]}"
quiet "removing" inside apt-get purge -y "${installed[@]}"
rm -r "$root/packages"
traces >"$work/after"
cmp "$work/before" "$work/after" || fail "removing leaves $(head -n 5 "$work/after")"

# The libraries that apt installed for the packages are still there.
mkdir "$root/tree"
tar -xzf "$packages"/*.tar.gz -C "$root/tree" --strip-components=1
quiet "the tarball's program" inside /tree/bin/tessera render cornell --size 48x32 --spp 4 --quiet -o /srv/tree.pfm
cmp "$root/srv/alone.pfm" "$root/srv/tree.pfm" || fail "the tarball's program renders other bytes"
