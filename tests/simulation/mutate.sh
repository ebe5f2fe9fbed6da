#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# mutate.sh BUILD [FARMS [NAME ...]]: makes the mistakes of mutations/list.txt one by one, or those that are named, in
# a copy of the source, builds simulate_farms with it, and simulates FARMS (2000) farms, which must go wrong. BUILD
# is a build directory of Ninja in which simulate_farms is built; nothing in it is changed.
# Prints for each what noticed it and the seed. Exit status: 0 if all are noticed, 1 if one is not or cannot be made.
# mutate.sh --check only looks whether all can be made: whether their texts stand in the source as they should.
set -euo pipefail

only_check=""
[ "${1:-}" != --check ] || { only_check=yes && set -- .; }
build=$(cd "${1:?usage: mutate.sh BUILD [FARMS [NAME ...]]}" && pwd)
farms=${2:-2000}
shift $(($# < 2 ? $# : 2))
wanted=" $* "
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# A mistake may keep the scheduler busy for ever. The source with the mistake is not optimised: farms without one take
# about half of that on a machine that is otherwise idle.
longest_seconds=$((300 + farms / 5))

if [ -z "$only_check" ]; then
  ninja -C "$build" -t commands simulate_farms >"$work/commands"
  link=$(tail -n 1 "$work/commands")
  [[ $link == *bin/simulate_farms* ]] || { echo "mutate.sh: $build does not build simulate_farms with Ninja" >&2; exit 1; }
fi

# change FILE OLD NEW: prints FILE with NEW for OLD, which must stand in it exactly once.
change() {
  local content rest
  content=$(<"$1")
  rest=${content//"$2"/}
  [ $((${#content} - ${#rest})) -eq ${#2} ] || return 1
  printf '%s\n' "${content/"$2"/"$3"}"
}

# unit_of FILE: what is compiled to have FILE in it, from the build directory: the file, or, where several are compiled as
# one, the source that includes it.
unit_of() {
  local units
  mapfile -t units < <(sed -nE 's#.* -c ([^ ]+)$#\1#p' "$work/commands")
  printf '%s\n' "${units[@]}" | grep -m 1 -e "$1\$" || (cd "$build" && grep -l -F "$root/$1\"" "${units[@]}")
}

# build_mutant DIRECTORY FILE: compiles the changed copy of FILE in it, and links a simulator with that in front.
build_mutant() {
  local unit source=$1/mutant.cpp compile
  unit=$(unit_of "$2") || return 1
  if [[ $unit != *"$2" ]]; then
    source=$1/unit.cpp
    (cd "$build" && sed "s#\"$root/$2\"#\"$1/mutant.cpp\"#" "$unit") >"$source" || return 1
  fi
  compile=$(grep -m 1 -F -e " -c $unit" "$work/commands") || return 1
  compile=$(sed -E "s# -MD -MT [^ ]+ -MF [^ ]+##; s# -o [^ ]+ -c [^ ]+\$# -O0 -o '$1/mutant.o' -c '$source'#" <<<"$compile")
  (cd "$build" && eval "$compile" && eval "${link/-o bin\/simulate_farms/"'$1/mutant.o' -o '$1/simulate_farms'"}") >"$1/log" 2>&1
}

# mutate NAME WHAT FILE OLD NEW: prints one line, of a check only if it cannot be made. Fails if nobody notices.
mutate() {
  local directory=$work/$1 outcome status=0
  mkdir "$directory"
  if ! change "$root/$3" "$4" "$5" >"$directory/mutant.cpp"; then
    outcome="CANNOT BE MADE: its text does not stand in $3 exactly once"
  elif [ -n "$only_check" ]; then
    return 0
  elif ! build_mutant "$directory" "$3"; then
    outcome="DOES NOT BUILD: $(grep -m 1 error "$directory/log" || tail -n 1 "$directory/log")"
  else
    # In a shell of its own, which keeps to itself how it died.
    (timeout "$longest_seconds" "$directory/simulate_farms" "$farms" >"$directory/farms" 2>&1; exit $?) \
      2>"$directory/shell" || status=$?
    case $status in
      0) outcome="NOT NOTICED in $farms farms" ;;
      124) outcome="NOT NOTICED: $farms farms are not through in $longest_seconds s" ;;
      1) outcome="noticed: $(grep -m 1 '^seed' "$directory/farms")" ;;
      *) outcome="noticed: it ends itself (status $status): $(tail -n 1 "$directory/farms")" ;;
    esac
  fi
  printf '%-28s %s\n' "$1" "$outcome"
  rm -rf "$directory"
  [[ $outcome == noticed* ]]
}

failures=0 name="" what="" file="" old="" new=""
finish() {
  if [ -n "$name" ] && { [ "$wanted" = "  " ] || [[ $wanted == *" $name "* ]]; }; then
    mutate "$name" "$what" "$file" "${old%$'\n'}" "${new%$'\n'}" || failures=$((failures + 1))
    made=$((made + 1))
  fi
  name="" old="" new=""
}

made=0
while IFS= read -r line; do
  case $line in
    "== "*)
      finish
      name=${line#== } what=${name#*: } name=${name%%:*}
      ;;
    "@ "*) file=${line#@ } ;;
    "- "*) old+=${line#- }$'\n' ;;
    "+ "*) new+=${line#+ }$'\n' ;;
  esac
done <"$here/mutations/list.txt"
finish

[ -n "$only_check" ] || echo "$made mistakes made, $((made - failures)) noticed"
[ "$made" -gt 0 ] && [ "$failures" -eq 0 ]
