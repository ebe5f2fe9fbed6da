#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What services.sh runs as a service, beside those of the packages, in a booted root. Writes /srv/status, /srv/log and
# /srv/journal, and ends the system.
set -euo pipefail
exec >/srv/log 2>&1

finish() {
  local status=$?
  journalctl --no-pager -o short-monotonic -n 300 >/srv/journal || true
  echo "$status" >/srv/status
  systemctl poweroff
}
trap finish EXIT

fail() {
  echo "services_inside.sh: $*"
  exit 1
}

# eventually COMMAND...: tries it for a minute.
eventually() {
  for ((i = 0; i < 600; ++i)); do
    if "$@" >/dev/null 2>&1; then return; fi
    sleep 0.1
  done
  fail "it never came to: $*"
}

property() { systemctl show -P "$2" "tessera-$1"; }
is_registered() { [ "$(tessera workers --json | wc -l)" -ge 1 ]; }
# shellcheck disable=SC2053  # a pattern
status_says() { [[ $(property "$1" StatusText) == $2 ]]; }

eventually systemctl -q is-active tessera-coordinator
eventually systemctl -q is-active tessera-worker
eventually is_registered
eventually status_says coordinator '* 1 workers, *'
eventually status_says worker 'connected to 127.0.0.1:7420, *'
for service in coordinator worker; do
  [ "$(ps -o user= -p "$(property $service MainPID)")" != root ] || fail "the $service runs as root"
  # Every line has its priority, and none shows it.
  journalctl -u tessera-$service -o json >/srv/lines
  grep -q '"PRIORITY":"6"' /srv/lines || fail "lines of the $service have no priority"
  ! grep '"MESSAGE":"<' /srv/lines || fail "the journal shows prefixes"
done

# The hardening of the services takes nothing from the sandbox.
if [ ! -s /srv/missing_of_sandbox ]; then
  ! journalctl -u tessera-coordinator -u tessera-worker | grep 'sandbox' || fail "the sandbox is incomplete in the services"
fi

job=$(tessera submit cornell --size 48x32 --spp 64 | head -n 1)
systemctl reload tessera-coordinator tessera-worker
systemctl -q is-active tessera-coordinator || fail "a reload ends the coordinator"

before="$(property coordinator MainPID) $(property worker MainPID)"
dpkg -i /packages/later/*.deb
after="$(property coordinator MainPID) $(property worker MainPID)"
for pid in $before; do [[ " $after " != *" $pid "* ]] || fail "the upgrade has not restarted process $pid"; done
eventually systemctl -q is-active tessera-coordinator
tessera watch "$job"
tessera image "$job" -o /srv/farm.pfm

# A worker that does nothing any more is ended and started again.
restarted() { [ "$(property worker NRestarts)" -ge 1 ] && systemctl -q is-active tessera-worker; }
kill -STOP "$(property worker MainPID)"
eventually restarted
[ "$(property coordinator NRestarts)" -eq 0 ] || fail "the coordinator was restarted"

systemctl stop tessera-worker tessera-coordinator
for service in coordinator worker; do
  [ "$(property $service Result)" = success ] || fail "the $service ends with $(property $service Result)"
done
systemctl start tessera-worker tessera-coordinator

dpkg -P tessera-worker tessera-coordinator
for service in coordinator worker; do
  ! systemctl -q is-active tessera-$service || fail "the $service runs on without its package"
  ! pgrep tessera- >/dev/null || fail "processes are left: $(pgrep -l tessera-)"
  [ ! -L /etc/systemd/system/multi-user.target.wants/tessera-$service.service ] || fail "the $service is still enabled"
done
[ ! -e /var/cache/tessera-worker ] && [ ! -e /var/cache/private/tessera-worker ] || fail "the cache is left"
[ -e /var/lib/private/tessera-coordinator/tessera.db ] || fail "purging has removed jobs"
echo "services: active, reloaded, upgraded, restarted by the watchdog, purged"
