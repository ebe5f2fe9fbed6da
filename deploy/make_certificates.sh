#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes what a farm needs for TLS in both directions and for tokens: an authority, certificates signed by it, tokens.
set -euo pipefail

usage() {
  cat <<'EOF_USAGE'
Usage: deploy/make_certificates.sh DIR HOST... [--worker NAME]... [--user NAME]... [--admin NAME]...
       deploy/make_certificates.sh --add DIR [--worker NAME]... [--user NAME]... [--admin NAME]...

HOST: names and addresses by which others reach the coordinator, e.g. render.example.org 10.0.0.5
NAME: a machine that renders, or a person; letters, digits, '.', '_' and '-', at most 32

Writes into DIR, which must not exist yet:
  ca.pem, ca.key                     the farm's own authority. Keep ca.key off the farm's machines
  coordinator.pem, coordinator.key   for tessera-coordinator --tls-certificate, --tls-key
  tokens                             for tessera-coordinator --tokens
and for each NAME
  NAME.pem, NAME.key, NAME.token     for --tls-certificate, --tls-key, --token-file of tessera-worker or tessera
Without a NAME, it writes worker.pem, worker.key, client.pem, client.key, and submit.token, work.token, admin.token.
Everybody needs ca.pem: clients and workers as --tls-ca, the coordinator as --tls-client-ca.
Certificates are valid for ten years. With --add, DIR must exist, ca.key included; send the coordinator SIGHUP after it.
EOF_USAGE
}

fail() { echo "make_certificates.sh: $1" >&2; exit "${2:-1}"; }

add=
case ${1:-} in
  -h | --help) usage; exit 0 ;;
  --add) add=yes; shift ;;
esac
[ $# -ge 1 ] || { usage >&2; exit 2; }
command -v openssl >/dev/null || fail "install Debian's package openssl"

directory=$1
shift
names=
people=()  # ROLE:NAME
while [ $# -gt 0 ]; do
  case $1 in
    --worker | --user | --admin)
      [[ ${2:-} =~ ^[A-Za-z0-9._-]{1,32}$ ]] || fail "$1 needs a name of letters, digits, '.', '_' and '-', at most 32" 2
      case $2 in ca | coordinator) fail "'$2' names a file of the farm itself: choose another name" 2 ;; esac
      case $1 in --worker) role=work ;; --user) role=submit ;; --admin) role=admin ;; esac
      people+=("$role:$2")
      shift ;;
    *[!0-9a-zA-Z.:*-]* | -*) fail "'$1' is neither a name nor an address" 2 ;;
    *:*:*) names+=,IP:$1 ;;
    *:*) fail "write '$1' without its port" 2 ;;
    *[!0-9.]*) names+=,DNS:$1 ;;
    *) names+=,IP:$1 ;;
  esac
  shift
done
if [ -n "$add" ]; then
  [ -z "$names" ] || fail "--add takes no HOST: the coordinator's certificate stays as it is" 2
  [ ${#people[@]} -gt 0 ] || fail "--add needs --worker, --user or --admin" 2
  [ -f "$directory/ca.key" ] || fail "$directory/ca.key is missing: name the folder that this script made"
  for person in "${people[@]}"; do
    [ ! -e "$directory/${person#*:}.pem" ] || fail "$directory/${person#*:}.pem exists already: choose another name"
  done
else
  [ -n "$names" ] || fail "name at least one HOST by which others reach the coordinator" 2
  [ ! -e "$directory" ] || fail "$directory exists already: choose a new folder, or --add to it"
fi

# A new folder is made beside where it will be, so that it is there whole or not at all.
umask 077
if [ -n "$add" ]; then
  cd "$directory"
else
  mkdir -p "$(dirname "$directory")"
  made=$(mktemp -d "$directory.XXXXXX")
  trap 'rm -rf "$made"' EXIT
  cd "$made"
fi

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

# token ROLE NAME [shared]
token() {
  openssl rand -hex 32 >"$2.token"
  echo "$1 $2 $(cat "$2.token")${3:+ $3}" >>tokens
}

if [ -z "$add" ]; then
  new_key ca
  quietly openssl req -x509 -new -key ca.key -sha256 -days 3650 -subj "/O=Tessera farm/CN=authority" -out ca.pem \
    -addext 'basicConstraints=critical,CA:TRUE' -addext 'keyUsage=critical,keyCertSign,cRLSign'
  certificate coordinator serverAuth "${names#,}"
  echo "# ROLE NAME TOKEN [shared] [expires=2027-01-31]" >tokens
fi
for person in "${people[@]}"; do
  certificate "${person#*:}" clientAuth
  token "${person%%:*}" "${person#*:}"
done
if [ ${#people[@]} -eq 0 ]; then
  certificate worker clientAuth
  certificate client clientAuth
  for role in submit work admin; do token $role $role shared; done
fi
rm -f ca.srl

cd - >/dev/null
if [ -n "$add" ]; then
  echo "$directory has what ${#people[@]} more need. Send the coordinator SIGHUP: it then reads tokens again."
  exit 0
fi
mv "$made" "$directory"
trap - EXIT

example_worker=worker example_work=work example_client=client example_submit=submit
for person in "${people[@]}"; do
  case $person in
    work:*) example_worker=${person#*:} example_work=$example_worker ;;
    *) example_client=${person#*:} example_submit=$example_client ;;
  esac
done
echo "$directory holds the certificates and tokens. Start the coordinator with"
echo "  --tls-certificate coordinator.pem --tls-key coordinator.key --tls-client-ca ca.pem --tokens tokens"
echo "workers with"
echo "  --tls-ca ca.pem --tls-certificate $example_worker.pem --tls-key $example_worker.key --token-file $example_work.token"
echo "and the command line with"
echo "  --tls-ca ca.pem --tls-certificate $example_client.pem --tls-key $example_client.key --token-file $example_submit.token"
