#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# systemd_units.sh DEPLOY BIN: checks the services in DEPLOY/systemd with their drop-ins, and that in DEPLOY/slurm: systemd
# understands every line, the exposure that `systemd-analyze security` computes is below 2.5, what they name is there, and
# the programs in BIN have the options. Exit status 77 without systemd-analyze.
set -euo pipefail

units=$1/systemd
slurm=$1/slurm
bin=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  echo "systemd_units.sh: $*" >&2
  exit 1
}

command -v systemd-analyze >/dev/null || { echo "systemd_units.sh: skipped: there is no systemd-analyze"; exit 77; }

services=()
for unit in "$units"/*.service "$slurm"/*.service; do
  name=$(basename "$unit" .service)
  mkdir "$work/$name.service.d"
  # As installed: the user of the jobs is one that this machine has.
  sed "s#/usr/bin/#$bin/#; s#/usr/share/tessera/slurm/#$slurm/#; s#^User=.*#User=daemon#" "$unit" >"$work/$name.service"
  for drop_in in "$units/${name#tessera-}"-*.conf; do [ ! -e "$drop_in" ] || cp "$drop_in" "$work/$name.service.d"; done
  # Documents lie in DEPLOY/../docs, which the package tessera installs.
  while IFS= read -r page; do
    [ -e "$slurm/../../docs/${page#/usr/share/doc/tessera/docs/}" ] || fail "$unit names $page, which is not installed"
  done < <(sed -n 's/^Documentation=file://p' "$unit")
  services+=("$work/$name.service")

  # A unit that nobody has hardened has 9 and more.
  systemd-analyze security --offline=true --threshold=25 "$unit" >"$work/security" 2>&1 ||
    fail "$(tail -n 1 "$work/security")"
  tail -n 1 "$work/security"
done
[ ${#services[@]} -eq 3 ] || fail "there are ${#services[@]} services"

systemd-analyze verify --man=no "${services[@]}" >"$work/verified" 2>&1 || fail "$(cat "$work/verified")"
[ ! -s "$work/verified" ] || fail "$(cat "$work/verified")"

# The variables of the drop-ins are those of options. The programs refuse the files of options that do not exist, by name.
while IFS=: read -r file variable; do
  program=tessera-$(basename "$file" | sed 's/-.*//')
  "$bin/$program" --print-man-page >"$work/page"
  option=$(sed 's/TESSERA_COORDINATOR_\|TESSERA_//' <<<"$variable" | tr 'A-Z_' 'a-z-')
  grep -qF -- "\\-\\-${option//-/\\-}\\f" "$work/page" || fail "$file: $program has no option --$option"
  status=0
  env "$variable=/does/not/exist" "$bin/$program" --help >"$work/out" 2>"$work/err" || status=$?
  [ "$status" -eq 2 ] && grep -q "/does/not/exist" "$work/err" || fail "$file: $program does not read $variable"
done < <(grep -o '^Environment=[A-Z_]*' "$units"/*-keys.conf | sed 's/Environment=//')
