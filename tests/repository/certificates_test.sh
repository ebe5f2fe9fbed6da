#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# certificates_test.sh MAKE_CERTIFICATES: what deploy/make_certificates.sh writes, renews and revokes, and that no bundle
# has the key of the authority or a file of somebody else. Exit status 77 without openssl.
set -euo pipefail

script=$(realpath "${1:?usage: certificates_test.sh MAKE_CERTIFICATES}")
command -v openssl >/dev/null || { echo "there is no openssl"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fail() { echo "certificates_test.sh: line ${BASH_LINENO[0]}: $1" >&2; exit 1; }
expect_files() { # FOLDER NAME...
  local there
  there=$(cd "$1" && find . -type f -printf '%f\n' | sort | tr '\n' ' ')
  [ "$there" = "$(printf '%s\n' "${@:2}" | sort | tr '\n' ' ')" ] || fail "$1 has $there"
}
signed() { openssl verify -CAfile farm/ca.pem "$1" >/dev/null 2>&1 || fail "$1 is not signed by the authority"; }
lines_of() { grep -cE "^[a-z]+ $1 " farm/tokens || true; }
refused() { ! "$script" "$@" >out 2>&1 || fail "'$*' was not refused"; }

"$script" --bundle farm render.example.org 10.0.0.5 --worker node1 --worker node.2 --user alice --admin root >out
grep -q 'bundles/node1/\*  to /etc/tessera/keys on node1' out || fail "it does not say where node1's files go"
grep -q 'bundles/alice/\*  to ~/.config/tessera of alice' out || fail "it does not say where alice's files go"
expect_files farm/bundles/coordinator ca.pem coordinator.pem coordinator.key tokens
expect_files farm/bundles/node1 ca.pem worker.pem worker.key worker.token
expect_files farm/bundles/node.2 ca.pem worker.pem worker.key worker.token
expect_files farm/bundles/alice ca.pem client.pem client.key client.token
expect_files farm/bundles/root ca.pem client.pem client.key client.token
! grep -rqF "$(sed -n 2p farm/ca.key)" farm/bundles || fail "a bundle has the key of the authority"
[ -z "$(find farm -type f -perm /077)" ] || fail "others can read files"
for file in farm/bundles/*/{coordinator,worker,client}.pem; do [ ! -e "$file" ] || signed "$file"; done
grep -qF "work node1 $(cat farm/bundles/node1/worker.token)" farm/bundles/coordinator/tokens || fail "node1 has no token"

# Added: its bundle, and the tokens of the coordinator.
"$script" --add --bundle farm --user bob >out
expect_files farm/bundles/bob ca.pem client.pem client.key client.token
grep -q '^submit bob ' farm/bundles/coordinator/tokens || fail "the coordinator's bundle has no token of bob"

# A viewer is a person, too.
"$script" --add --bundle farm --viewer vera >out
expect_files farm/bundles/vera ca.pem client.pem client.key client.token
grep -q '^watch vera ' farm/bundles/coordinator/tokens || fail "the coordinator's bundle has no token of vera"

# Renewed: both tokens are valid, and the earlier one expires.
before=$(cat farm/node1.token)
cp farm/node1.pem earlier.pem
"$script" --renew --bundle farm node1 >out
[ "$(lines_of node1)" = 2 ] || fail "node1 has $(lines_of node1) tokens"
grep -qE "^work node1 $before expires=20[0-9]{2}-" farm/tokens || fail "the earlier token does not expire"
grep -qE "^work node1 $(cat farm/bundles/node1/worker.token)\$" farm/tokens || fail "the new token is not valid"
! cmp -s earlier.pem farm/bundles/node1/worker.pem || fail "the certificate is the same"
signed farm/node1.pem
[ "$(lines_of node.2)" = 1 ] || fail "another worker was changed"
cp farm/coordinator.pem earlier.pem
"$script" --renew farm coordinator >out
! cmp -s earlier.pem farm/coordinator.pem || fail "the coordinator's certificate is the same"
for host in render.example.org 10.0.0.5; do
  openssl x509 -in farm/coordinator.pem -noout -text | grep -q "$host" || fail "the certificate has lost $host"
done

# Revoked: no token is left, and nobody else loses one.
"$script" --revoke farm node1 >out
[ "$(lines_of node1)" = 0 ] || fail "node1 has tokens"
[ "$(lines_of node.2)/$(lines_of alice)/$(lines_of bob)/$(lines_of root)" = 1/1/1/1 ] || fail "others were revoked"
[ ! -e farm/node1.pem ] && [ ! -e farm/bundles/node1 ] || fail "files of node1 are left"

# Shared tokens stay shared.
"$script" open 127.0.0.1 >out
"$script" --renew open work >out
[ "$(grep -c '^work work .* shared' open/tokens)" = 2 ] || fail "the token is not shared any more"
"$script" --renew open worker >out
openssl verify -CAfile open/ca.pem open/worker.pem >/dev/null 2>&1 || fail "worker.pem was not renewed"

refused farm render.example.org
refused --add farm --worker alice
refused --add farm 10.0.0.6
refused --renew farm carol
refused --revoke farm coordinator
refused --renew farm ca
refused --bundle other 127.0.0.1
refused --worker
refused new 127.0.0.1 --worker ../x
refused new 127.0.0.1 --worker bundles
[ ! -e new ] && [ ! -e other ] || fail "a refused call left a folder"
echo "certificates: ok"
