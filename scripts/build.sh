# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Sourced by the scripts at the top: builds, with one line of progress, and the whole log in a file.

# progress: reads the output of CMake and Ninja and shows how far it is; on a terminal in one line that fits it, elsewhere
# a line for each tenth.
progress() {
  local line tenth=-1 tty= columns=80 shown
  if [ -t 1 ]; then
    tty=yes
    columns=$(tput cols 2>/dev/null || echo 80)
    printf '  configuring'
  fi
  while IFS= read -r line; do
    [[ $line =~ ^\[([0-9]+)/([0-9]+)\]\ (.*) ]] || continue
    if [ $tty ]; then
      shown="  $((100 * BASH_REMATCH[1] / BASH_REMATCH[2])) %, step ${BASH_REMATCH[1]} of ${BASH_REMATCH[2]}, ${SECONDS} s: ${BASH_REMATCH[3]}"
      printf '\r\033[K%s' "${shown:0:columns-1}"
    elif [ $((10 * BASH_REMATCH[1] / BASH_REMATCH[2])) -gt $tenth ]; then
      tenth=$((10 * BASH_REMATCH[1] / BASH_REMATCH[2]))
      echo "  ${BASH_REMATCH[1]} of ${BASH_REMATCH[2]} steps"
    fi
  done
  [ ! $tty ] || printf '\r\033[K'
}

# build PRESET "CMAKE OPTIONS" [TARGET ...]: configures and builds build/PRESET. Several files of a target are compiled as
# one, which takes a third of the time. Ends the script, with the end of the log, if something goes wrong.
build() {
  local preset=$1 options=$2 log=build/$1.log
  shift 2
  mkdir -p build
  # shellcheck disable=SC2086  # options are words
  if ! { cmake --preset "$preset" -DCMAKE_UNITY_BUILD=ON $options &&
    cmake --build "build/$preset" --parallel "$(nproc)" ${1:+--target "$@"}; } 2>&1 | tee "$log" | progress; then
    tail -n 60 "$log" >&2
    echo "${0##*/}: the build failed; the whole log is in $log" >&2
    exit 1
  fi
}
