#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_sources.sh ROOT: reads the sources below ROOT and names every line that breaks a rule of the house.
# Exit status 0 if there is none, 1 if there are some, 2 if ROOT is not Tessera's.
set -euo pipefail

root=${1:?usage: check_sources.sh ROOT}
cd "$root"
for folder in core proto server worker client; do
  [ -d "$folder" ] || { echo "check_sources.sh: $root has no folder '$folder'" >&2; exit 2; }
done

broken=0

# forbid RULE REGEX [--but ALLOWED] GREP-ARGUMENTS...: lines that match REGEX, and not ALLOWED, break RULE.
# Lines are matched as FILE:NUMBER:TEXT by ALLOWED, and by themselves by REGEX.
forbid() {
  local rule=$1 regex=$2 allowed='^$' lines status=0
  shift 2
  if [ "$1" = --but ]; then
    allowed=$2
    shift 2
  fi
  lines=$(grep -rnE -e "$regex" "$@") || status=$?
  [ "$status" -le 1 ] || { echo "check_sources.sh: grep failed for: $rule" >&2; exit 2; }
  lines=$(grep -vE -e "$allowed" <<<"$lines") || true
  [ -n "$lines" ] || return 0
  printf '%s\n%s\n\n' "$rule" "$lines"
  broken=1
}

sources=(--include=*.hpp --include=*.cpp)
builds=(--include=CMakeLists.txt --include=*.cmake --include=CMakePresets.json --include=*.sh)
elsewhere=(--exclude-dir=build --exclude-dir=build-* --exclude-dir=out --exclude-dir=.git --exclude-dir=repository)
include='^[[:space:]]*#[[:space:]]*include[[:space:]]*[<"]'

# The arrows: client, worker -> proto -> core; server -> proto, and of core only what never traces a ray. Worker and
# server read scenes in the sandbox.
forbid "core includes nothing of the farm." \
  "${include}(proto|server|worker|client|tessera/v1|grpc|google/protobuf|sqlite3|zstd)" "${sources[@]}" core
forbid "core/cli includes of core only base." \
  "${include}(core|proto|server|worker|client|tessera/v1|grpc)/" --but '[<"]core/(base|cli)/' "${sources[@]}" core/cli
forbid "core/common includes of core only base, http and image." \
  "${include}(core|proto|server|worker|client|tessera/v1|grpc)/" --but '[<"]core/(base|http|image|common)/' "${sources[@]}" core/common
forbid "core/http includes of core only base." \
  "${include}core/" --but '[<"]core/(base|http)/' "${sources[@]}" core/http
forbid "core/view includes of core only base, film, http, image and math." \
  "${include}core/" --but '[<"]core/(base|film|http|image|math|view)/' "${sources[@]}" core/view
forbid "Only core/http includes the HTTP library." "${include}microhttpd" --but '^core/http/' "${sources[@]}" \
  core proto server worker client
forbid "proto includes neither server nor worker nor client." "${include}(server|worker|client)/" "${sources[@]}" proto
forbid "The sandbox includes of core only base, cli and the scene loader." \
  "${include}(core|proto|server|worker|client|tessera/v1|grpc|google/protobuf)/" --but '[<"]core/(base|cli|sandbox|scene/loader)/' \
  "${sources[@]}" core/sandbox
forbid "The scene includes nothing of how it is rendered." "${include}core/(guiding|shading|integrators)/" "${sources[@]}" \
  core/scene
forbid "No other part of core includes the sandbox." "${include}core/sandbox/" --but '^core/sandbox/' "${sources[@]}" core
forbid "A worker includes neither server nor client." "${include}(server|client)/" "${sources[@]}" worker
forbid "A client includes neither server nor worker; tessera demo runs both." "${include}(server|worker)/" \
  --but '^client/demo/' "${sources[@]}" client
forbid "Only the program includes the demo." "${include}client/demo/" --but '^client/(demo/|main\.cpp)' "${sources[@]}" client
forbid "The server includes of core only base, cli, common, film, http, image, math, sandbox, view, scene/settings.hpp and scene/render_record.hpp; the validator may load scenes." \
  "${include}core/" --but '^server/validator/|[<"]core/(base|cli|common|film|http|image|math|sandbox|view)/|[<"]core/scene/(settings|render_record)\.hpp' \
  "${sources[@]}" server
forbid "The scheduler includes neither RPC nor SQLite, nor any other folder of the server." \
  "${include}(grpc|google/protobuf|tessera/v1|proto/|sqlite3|server/)" --but '[<"]server/scheduler/' \
  "${sources[@]}" server/scheduler
forbid "Only the metrics include the library of Prometheus." "${include}prometheus/" \
  --but '^(core/common/metric|server/metrics/|worker/metrics\.)' "${sources[@]}" core proto server worker client

# The same bytes on every machine.
forbid "Nothing is built for the building machine alone, or with inexact arithmetic." \
  '-m(arch|tune)=native|-f(fast|unsafe)-math|-Ofast|-ffp-contract=(fast|on)' "${builds[@]}" "${elsewhere[@]}" .
forbid "Vector instructions are called in core/math alone, so that core compiles for any processor." \
  "\b_mm[0-9]*_|${include}[a-z]*intrin\.h" --but '^core/math/' "${sources[@]}" core scenes client
# (A comparison of images may: it reports to people.)
forbid "Core calls none of the C library's elementary functions: core/math/elementary.hpp has ours." \
  '(std::|[^a-zA-Z0-9_:.>]::)(sin|cos|tan|asin|acos|atan|atan2|sinh|cosh|tanh|exp|exp2|expm1|log|log2|log10|log1p|pow|cbrt|hypot)f?\(' \
  --but '^core/image/compare\.cpp:' "${sources[@]}" core scenes
forbid "Random numbers come from counters, not from the C++ library, whose distributions differ between machines." \
  "${include}(random|ctime)>|std::rand\(|[^a-z_]s?rand\(" "${sources[@]}" core scenes

forbid "The farm's mutexes are core::Mutex, whose use Clang checks (core/base/mutex.hpp)." \
  'std::(mutex|lock_guard|scoped_lock|unique_lock)' "${sources[@]}" core/common proto server worker

# What is committed speaks of no single machine.
forbid "No path of one machine." '(^|[^a-zA-Z0-9_.}])/(home|root|work|Users)/[a-zA-Z0-9_]' \
  "${sources[@]}" "${builds[@]}" --include=*.md --include=*.json --include=*.proto --include=generate \
  --include=*.txt --include=*.mtl --include=*.sgf "${elsewhere[@]}" .

# Lines of Markdown wrap at 120 characters. Tables, code and links by themselves cannot be wrapped.
prose() {
  find . \( -path ./build -o -path './build-*' -o -path ./out -o -path ./.git \) -prune -o -name '*.md' -print0 |
    xargs -0r awk '
      FNR == 1 { code = 0 }
      /^[[:space:]]*```/ { code = !code; next }
      !code && !/^[[:space:]]*\|/ && !/^[[:space:]]*([-*] )?!?\[[^]]*\]\([^)]*\)[.,;]?$/ {
        print substr(FILENAME, 3) ":" FNR ":" $0
      }'
}
long=$(prose | LC_ALL=C.UTF-8 grep -E '^[^:]+:[0-9]+:.{121}') || true
if [ -n "$long" ]; then
  printf '%s\n%s\n\n' "Prose of Markdown wraps at 120 characters." "$long"
  broken=1
fi

# The head of tests/CMakeLists.txt names the labels of tests.
if [ -e tests/CMakeLists.txt ]; then
  labels=$(sed 's/^# //' tests/CMakeLists.txt | tr '\n' ' ' | grep -oP 'what kind of test it is \(\K[^)]+' | tr -d ' ' | tr , ' ') || true
  tests=$(grep -rhE '^[^#]*(LABELS|tessera_[a-z_]*test[a-z_]*\()' --include=CMakeLists.txt tests) || true
  for label in $labels; do
    if ! grep -qw -e "$label" <<<"$tests"; then
      printf '%s\n%s\n\n' "A label that is named has tests." "$(grep -nHw -m 1 -e "$label" tests/CMakeLists.txt)"
      broken=1
    fi
  done
fi

exit "$broken"
