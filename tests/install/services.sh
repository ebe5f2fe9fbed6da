#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# services.sh PACKAGES ROOT: boots systemd in the root of the tar file ROOT with the packages of the folder PACKAGES, as
# systemd-nspawn does, without a network. There the services render, are reloaded, upgraded while they render, ended by
# their watchdog, and purged (services_inside.sh).
# Exit status 77 without the root or systemd-nspawn, or where it cannot boot.
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
  echo "services.sh: skipped: $*"
  exit 77
}

fail() {
  echo "services.sh: $*" >&2
  exit 1
}

quiet() {
  "${@:2}" >"$work/log" 2>&1 || { tail -n 60 "$work/log" >&2; fail "$1 failed"; }
}

inside() { chroot "$root" env PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 HOME=/srv "$@"; }

ls "$packages"/*.deb >/dev/null 2>&1 || skip "there are no packages (install.make_packages)"
[ -e "$debian" ] || skip "there is no root of Debian (install.debian_root)"
command -v systemd-nspawn >/dev/null || skip "there is no systemd-nspawn"
mkdir "$root"
tar -C "$root" -xf "$debian"
if mount -t proc proc "$root/proc"; then mounted=yes; else skip "/proc cannot be mounted"; fi

mkdir -p "$root/packages/later"
cp "$packages"/*.deb "$root/packages"
rm "$root"/packages/*-dev_*
quiet "apt-get update" inside apt-get -qq update
quiet "installing systemd" inside apt-get install -y --no-install-recommends systemd systemd-sysv dbus procps
quiet "installing" inside sh -c 'apt-get install -y --no-install-recommends /packages/*.deb'
quiet "rendering" inside tessera render cornell --size 48x32 --spp 64 --quiet -o /srv/alone.pfm
inside tessera-validator --check-sandbox >"$root/srv/missing_of_sandbox" 2>&1 || true
umount "$root/proc"
mounted=
"$here/later_release.sh" "$root/packages" "$root/packages/later"

cp "$here/services_inside.sh" "$root/srv"
cat >"$root/etc/systemd/system/services-test.service" <<'END'
[Unit]
After=tessera-coordinator.service tessera-worker.service
[Service]
Type=exec
ExecStart=/bin/bash /srv/services_inside.sh
Environment=HOME=/srv LC_ALL=C.UTF-8
[Install]
WantedBy=multi-user.target
END
ln -s ../services-test.service "$root/etc/systemd/system/multi-user.target.wants/"
# Signs of life are due sooner than in the packages.
for service in coordinator worker; do
  mkdir "$root/etc/systemd/system/tessera-$service.service.d"
  printf '[Service]\nWatchdogSec=10s\nTimeoutAbortSec=1s\n' >"$root/etc/systemd/system/tessera-$service.service.d/test.conf"
done

timeout --kill-after=10 400 systemd-nspawn --quiet --directory="$root" --machine="tessera-$$" --boot --register=no --keep-unit \
  --private-network --system-call-filter='landlock_create_ruleset landlock_add_rule landlock_restrict_self' --console=pipe --notify-ready=no </dev/null >"$work/boot.log" 2>&1 || true
[ -e "$root/srv/log" ] || { tail -n 5 "$work/boot.log"; skip "systemd does not boot in a container here"; }
if [ "$(cat "$root/srv/status" 2>/dev/null)" != 0 ]; then
  cat "$root/srv/log" "$root/srv/journal" >&2 || true
  fail "the services fail"
fi
cmp "$root/srv/alone.pfm" "$root/srv/farm.pfm" || fail "the farm renders other bytes"
cat "$root/srv/log"
