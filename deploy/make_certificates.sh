#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes what a farm needs for TLS in both directions and for tokens: an authority, certificates signed by it, tokens.
set -euo pipefail

usage() {
  cat <<'EOF_USAGE'
Usage: deploy/make_certificates.sh DIR HOST...

HOST: names and addresses by which others reach the coordinator, e.g. render.example.org 10.0.0.5

Writes into DIR, which must not exist yet:
  ca.pem, ca.key                     the farm's own authority. Keep ca.key off the farm's machines
  coordinator.pem, coordinator.key   for tessera-coordinator --tls-certificate, --tls-key
  worker.pem, worker.key             for tessera-worker, the same options
  client.pem, client.key             for tessera, the same options
  tokens                             for tessera-coordinator --tokens
  submit.token, work.token, admin.token   for --token-file
Everybody needs ca.pem: clients and workers as --tls-ca, the coordinator as --tls-client-ca.
Certificates are valid for ten years.
EOF_USAGE
}

case ${1:-} in
  -h | --help) usage; exit 0 ;;
esac
[ $# -ge 2 ] || { usage >&2; exit 2; }
command -v openssl >/dev/null || { echo "make_certificates.sh: install Debian's package openssl" >&2; exit 1; }

directory=$1
shift
[ ! -e "$directory" ] || { echo "make_certificates.sh: $directory exists already: choose a new folder" >&2; exit 1; }

names=
for host in "$@"; do
  case $host in
    *[!0-9a-zA-Z.:*-]*) echo "make_certificates.sh: '$host' is neither a name nor an address" >&2; exit 2 ;;
    *:*:*) names+=,IP:$host ;;
    *:*) echo "make_certificates.sh: write '$host' without its port" >&2; exit 2 ;;
    *[!0-9.]*) names+=,DNS:$host ;;
    *) names+=,IP:$host ;;
  esac
done

# Made beside where it will be, so that it is there whole or not at all.
umask 077
mkdir -p "$(dirname "$directory")"
made=$(mktemp -d "$directory.XXXXXX")
trap 'rm -rf "$made"' EXIT
cd "$made"

quietly() {
  "$@" 2>openssl.log || { cat openssl.log >&2; exit 1; }
  rm -f openssl.log
}

new_key() { quietly openssl ecparam -name prime256v1 -genkey -noout -out "$1.key"; }

# certificate NAME USAGE [SUBJECT-ALTERNATIVE-NAMES]
certificate() {
  new_key "$1"
  quietly openssl req -new -key "$1.key" -subj "/O=Tessera farm/CN=$1" -out "$1.csr"
  quietly openssl x509 -req -in "$1.csr" -CA ca.pem -CAkey ca.key -CAcreateserial -days 3650 -sha256 -out "$1.pem" \
    -extfile <(printf 'basicConstraints=critical,CA:FALSE\nkeyUsage=critical,digitalSignature\nextendedKeyUsage=%s\n%s\n' \
      "$2" "${3:+subjectAltName=$3}")
  rm "$1.csr"
}

new_key ca
quietly openssl req -x509 -new -key ca.key -sha256 -days 3650 -subj "/O=Tessera farm/CN=authority" -out ca.pem \
  -addext 'basicConstraints=critical,CA:TRUE' -addext 'keyUsage=critical,keyCertSign,cRLSign'
certificate coordinator serverAuth "${names#,}"
certificate worker clientAuth
certificate client clientAuth
rm -f ca.srl

echo "# ROLE NAME TOKEN" >tokens
for role in submit work admin; do
  openssl rand -hex 32 >"$role.token"
  echo "$role $role $(cat "$role.token")" >>tokens
done

cd - >/dev/null
mv "$made" "$directory"
trap - EXIT

echo "$directory holds the certificates and tokens. Start the coordinator with"
echo "  --tls-certificate coordinator.pem --tls-key coordinator.key --tls-client-ca ca.pem --tokens tokens"
echo "workers with"
echo "  --tls-ca ca.pem --tls-certificate worker.pem --tls-key worker.key --token-file work.token"
echo "and the command line with"
echo "  --tls-ca ca.pem --tls-certificate client.pem --tls-key client.key --token-file submit.token"
