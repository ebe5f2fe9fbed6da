#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_alerts.sh ROOT: checks the alert rules in deploy/prometheus: that promtool reads them, that they name documented
# metrics only, that each has a case in which it fires and one in which it does not, and that these hold.
# Exit status 0 if all is well, 1 if not, 77 if there is no promtool.
set -euo pipefail

root=${1:?usage: check_alerts.sh ROOT}
command -v promtool >/dev/null || { echo "check_alerts.sh: there is no promtool (scripts/setup.sh test)"; exit 77; }
rules=$root/deploy/prometheus/tessera.rules.yml
cases=$root/tests/alerts/tessera_test.yml
status=0

promtool check rules "$rules" || status=1

while read -r metric; do
  family=$(sed -E 's/_(sum|count|bucket)$//' <<<"$metric")
  grep -q "^| \`$family\` |" "$root/docs/metrics.md" || { echo "docs/metrics.md has no metric $family"; status=1; }
done < <(grep -oE '\<tessera_[a-z_]+' "$rules" | sort -u)

while read -r alert; do
  grep -qE "alertname: $alert(, exp_alerts: \[\])?\}" "$cases" || { echo "no case in which $alert is silent"; status=1; }
  grep -qE "^        alertname: $alert$" "$cases" || { echo "no case in which $alert fires"; status=1; }
done < <(sed -n 's/^ *- alert: //p' "$rules")

(cd "$(dirname "$cases")" && promtool test rules "$(basename "$cases")") || status=1
exit $status
