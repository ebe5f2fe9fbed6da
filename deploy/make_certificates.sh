#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes what a farm needs for TLS in both directions and for tokens: an authority, certificates signed by it, tokens.
set -euo pipefail

usage() {
  cat <<'EOF_USAGE'
Usage: deploy/make_certificates.sh [--bundle] DIR HOST... [PERSON]...
       deploy/make_certificates.sh [--bundle] --add DIR [PERSON]...
       deploy/make_certificates.sh [--bundle] --renew DIR NAME...
       deploy/make_certificates.sh --revoke DIR NAME...

PERSON: --worker NAME, --user NAME, --viewer NAME (who may see everything and change nothing) or --admin NAME
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
Certificates are valid for ten years.

--bundle   also write DIR/bundles: a folder for the coordinator and for each NAME with exactly the files that it needs,
           under the same names on every machine, and say where each folder goes. None of them has ca.key
--add      add names to a DIR of an earlier call
--renew    make new certificates and tokens for names of DIR, or a new certificate for 'coordinator'. An earlier token
           stays valid for seven days
--revoke   remove names from DIR with their tokens. Whoever has one is refused from then on
After --add, --renew and --revoke, install DIR/tokens on the coordinator's machine and send the coordinator SIGHUP.
EOF_USAGE
}

fail() { echo "make_certificates.sh: $1" >&2; exit "${2:-1}"; }

mode=create bundle=
while :; do
  case ${1:-} in
    -h | --help) usage; exit 0 ;;
    --bundle) bundle=yes ;;
    --add | --renew | --revoke) mode=${1#--} ;;
    *) break ;;
  esac
  shift
done
[ $# -ge 1 ] || { usage >&2; exit 2; }
command -v openssl >/dev/null || fail "install Debian's package openssl"

directory=$1
shift
hosts=
people=()  # ROLE:NAME
changed=() # NAME, of --renew and --revoke

expect_name() {
  [[ $2 =~ ^[A-Za-z0-9._-]{1,32}$ && ! $2 =~ ^\.+$ ]] ||
    fail "$1 needs a name of letters, digits, '.', '_' and '-', at most 32" 2
}

read_person() {
  local role
  expect_name "$1" "${2:-}"
  case $2 in ca | coordinator | bundles | tokens) fail "'$2' names a file of the farm itself: choose another name" 2 ;; esac
  case $1 in --worker) role=work ;; --user) role=submit ;; --viewer) role=watch ;; --admin) role="admin" ;; esac
  people+=("$role:$2")
}

read_host() {
  case $1 in
    *[!0-9a-zA-Z.:*-]* | -*) fail "'$1' is neither a name nor an address" 2 ;;
    *:*:*) hosts+=,IP:$1 ;;
    *:*) fail "write '$1' without its port" 2 ;;
    *[!0-9.]*) hosts+=,DNS:$1 ;;
    *) hosts+=,IP:$1 ;;
  esac
}

while [ $# -gt 0 ]; do
  case $mode:$1 in
    *:--bundle) bundle=yes ;;
    create:--worker | create:--user | create:--viewer | create:--admin | \
      add:--worker | add:--user | add:--viewer | add:--admin)
      read_person "$1" "${2:-}"
      shift ;;
    create:*) read_host "$1" ;;
    add:*) fail "--add takes no HOST: the coordinator's certificate stays as it is" 2 ;;
    *) expect_name "--$mode" "$1"; changed+=("$1") ;;
  esac
  shift
done

if [ $mode = create ]; then
  [ -n "$hosts" ] || fail "name at least one HOST by which others reach the coordinator" 2
  [ ! -e "$directory" ] || fail "$directory exists already: choose a new folder, or --add to it"
else
  [ -f "$directory/ca.key" ] || fail "$directory/ca.key is missing: name the folder that this script made"
  [ $mode != add ] || [ ${#people[@]} -gt 0 ] || fail "--add needs --worker, --user, --viewer or --admin" 2
  [ $mode = add ] || [ ${#changed[@]} -gt 0 ] || fail "--$mode needs a NAME" 2
fi
for person in "${people[@]}"; do
  [ ! -e "$directory/${person#*:}.pem" ] || fail "$directory/${person#*:}.pem exists already: choose another name"
done
for name in "${changed[@]}"; do
  case $mode:$name in
    *:ca | revoke:coordinator) fail "the farm cannot do without '$name': make a new folder for a new farm" 2 ;;
  esac
  [ -e "$directory/$name.pem" ] || [ -e "$directory/$name.token" ] || fail "$directory has nothing of '$name'"
done

# A new folder is made beside where it will be, so that it is there whole or not at all.
umask 077
if [ $mode = create ]; then
  mkdir -p "$(dirname "$directory")"
  made=$(mktemp -d "$directory.XXXXXX")
  trap 'rm -rf "$made"' EXIT
  cd "$made"
else
  cd "$directory"
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

# The names of a certificate as openssl reads them: DNS:NAME,IP:ADDRESS.
names_in() {
  openssl x509 -in "$1" -noout -ext subjectAltName | sed -n '2s/IP Address:/IP:/g; 2s/[[:space:]]//gp'
}

# rewrite_tokens AWK-PROGRAM NAME: replaces the file at once; the program sees a line of this name as `mine`.
rewrite_tokens() {
  awk -v name="$2" -v expires="expires=$(date -u -d '+7 days' +%Y-%m-%dT%H:%M:%SZ)" \
    '{ mine = !/^[[:space:]]*#/ && $2 == name }'" $1" tokens >tokens.new
  mv tokens.new tokens
}

renew() {
  local role shared=
  if [ "$1" = coordinator ]; then
    certificate coordinator serverAuth "$(names_in coordinator.pem)"
    return
  fi
  [ ! -e "$1.pem" ] || certificate "$1" clientAuth
  [ -e "$1.token" ] || return 0
  role=$(awk -v name="$1" '!/^[[:space:]]*#/ && $2 == name { print $1; exit }' tokens)
  [ -n "$role" ] || fail "tokens has no line of '$1': add it with --add"
  ! grep -qE "^[[:space:]]*$role[[:space:]]+${1//./\\.}[[:space:]].*[[:space:]]shared" tokens || shared=shared
  rewrite_tokens 'mine && !/ expires=/ { $0 = $0 " " expires } { print }' "$1"
  token "$role" "$1" $shared
}

revoke() {
  rewrite_tokens '!mine { print }' "$1"
  rm -rf "$1.pem" "$1.key" "$1.token" "bundles/$1"
}

# put BUNDLE FILE NAME-IN-BUNDLE
put() {
  [ -e "$2" ] || fail "$2 is missing"
  install -m 600 "$2" "bundles/$1/$3"
}

# bundle NAME: what the machine or person needs. The names of the files are those of the services.
bundle() {
  local as=client
  rm -rf "bundles/$1"
  mkdir -p "bundles/$1"
  put "$1" ca.pem ca.pem
  if [ "$1" = coordinator ]; then
    put "$1" coordinator.pem coordinator.pem
    put "$1" coordinator.key coordinator.key
    put "$1" tokens tokens
    return
  fi
  grep -qE "^[[:space:]]*(watch|submit|admin)[[:space:]]+${1//./\\.}[[:space:]]" tokens || as=worker
  put "$1" "$1.pem" $as.pem
  put "$1" "$1.key" $as.key
  put "$1" "$1.token" $as.token
}

# The bundles of all that this call has made or changed.
bundled=()
make_bundles() {
  bundled=(coordinator)
  local person
  for person in "${people[@]}"; do bundled+=("${person#*:}"); done
  for person in "${changed[@]}"; do
    [ "$person" = coordinator ] || [ $mode = revoke ] || bundled+=("$person")
  done
  for person in "${bundled[@]}"; do bundle "$person"; done
}

case $mode in
  create)
    new_key ca
    quietly openssl req -x509 -new -key ca.key -sha256 -days 3650 -subj "/O=Tessera farm/CN=authority" -out ca.pem \
      -addext 'basicConstraints=critical,CA:TRUE' -addext 'keyUsage=critical,keyCertSign,cRLSign'
    certificate coordinator serverAuth "${hosts#,}"
    echo "# ROLE NAME TOKEN [shared] [expires=2027-01-31]" >tokens ;;
  renew) for name in "${changed[@]}"; do renew "$name"; done ;;
  revoke) for name in "${changed[@]}"; do revoke "$name"; done ;;
esac
for person in "${people[@]}"; do
  certificate "${person#*:}" clientAuth
  token "${person%%:*}" "${person#*:}"
done
if [ $mode = create ] && [ ${#people[@]} -eq 0 ]; then
  [ -z "$bundle" ] || fail "--bundle needs --worker, --user, --viewer or --admin: each bundle is for one machine or person" 2
  certificate worker clientAuth
  certificate client clientAuth
  for role in submit work admin; do token $role $role shared; done
fi
[ -z "$bundle" ] || make_bundles
rm -f ca.srl

cd - >/dev/null
if [ $mode = create ]; then
  mv "$made" "$directory"
  trap - EXIT
fi

describe_bundles() {
  local name where
  echo "Copy, and keep the files to their owner (mode 0600):"
  for name in "${bundled[@]}"; do
    case $name in
      coordinator) where="/etc/tessera/keys on the coordinator's machine" ;;
      *) if [ -e "$directory/bundles/$name/worker.pem" ]; then where="/etc/tessera/keys on $name"; else
           where="~/.config/tessera of $name"; fi ;;
    esac
    echo "  $directory/bundles/$name/*  to $where"
  done
  echo "$directory/ca.key stays here: it signs certificates, and no machine of the farm needs it."
}

describe_options() {
  local worker=worker work=work client=client submit=submit person
  for person in "${people[@]}"; do
    case $person in
      work:*) worker=${person#*:} work=$worker ;;
      *) client=${person#*:} submit=$client ;;
    esac
  done
  echo "$directory holds the certificates and tokens. Start the coordinator with"
  echo "  --tls-certificate coordinator.pem --tls-key coordinator.key --tls-client-ca ca.pem --tokens tokens"
  echo "workers with"
  echo "  --tls-ca ca.pem --tls-certificate $worker.pem --tls-key $worker.key --token-file $work.token"
  echo "and the command line with"
  echo "  --tls-ca ca.pem --tls-certificate $client.pem --tls-key $client.key --token-file $submit.token"
}

case $mode in
  create) [ -n "$bundle" ] || describe_options ;;
  add) echo "$directory has what ${#people[@]} more need." ;;
  renew) echo "$directory has new files of ${changed[*]}. Earlier tokens are valid for seven days." ;;
  revoke) echo "$directory has no token of ${changed[*]} any more." ;;
esac
[ -z "$bundle" ] || describe_bundles
[ $mode = create ] ||
  echo "Install $directory/tokens on the coordinator's machine, and send the coordinator SIGHUP: it then reads tokens again."
