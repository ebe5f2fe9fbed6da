#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# self_test.sh CHECK_SOURCES: plants one violation of each rule in a small tree of its own and expects
# check_sources.sh to find it, and to find none in the tree without it.
set -euo pipefail

check=${1:?usage: self_test.sh CHECK_SOURCES}
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/{core/{film,cli,common,http,sandbox,scene,view},proto,server/scheduler,server/validator,worker,client,scenes,tests/unit}
echo '#include "core/film/film.hpp"' >"$tree/server/main.cpp"
echo '#include "core/scene/loader/loader.hpp"' >"$tree/server/validator/validator.cpp"
echo 'float f(float x) { return tessera::core::sin(x) + std::sqrt(x); }' >"$tree/core/film/film.cpp"

echo '# CTest labels say what kind of test it is (unit).' >"$tree/tests/CMakeLists.txt"
echo 'set_tests_properties(core PROPERTIES LABELS unit)' >"$tree/tests/unit/CMakeLists.txt"

failures=0
report() {
  echo "self_test.sh: $*"
  failures=1
}

long=$(printf 'word %.0s' {1..30})
{
  printf '| %s |\n\n![%s](a.png)\n\n```\n%s\n```\n' "$long" "$long" "$long"
  printf 'ä%.0s' {1..120}
} >"$tree/good.md"

"$check" "$tree" >/dev/null || report "finds a violation where there is none: $("$check" "$tree" || true)"

# plant FILE LINE: the check must fail and name the file.
plant() {
  local file=$1 line=$2 output status=0
  printf '%s\n' "$line" >"$tree/$file"
  output=$("$check" "$tree") || status=$?
  [ "$status" -eq 1 ] || report "exit status $status, not 1, for '$line' in $file"
  grep -qF "$file:1:" <<<"$output" || report "does not name $file for '$line'"
  rm "$tree/$file"
}

plant core/film/bad.hpp '#include <grpcpp/grpcpp.h>'
plant core/film/bad.cpp '#include "proto/convert.hpp"'
plant core/film/bad.cpp '#include "tessera/v1/types.pb.h"'
plant core/cli/bad.cpp '#include "core/film/film.hpp"'
plant proto/bad.cpp '#include "server/store/store.hpp"'
plant core/film/bad.cpp '#include "core/sandbox/confinement.hpp"'
plant core/scene/bad.hpp '#include "core/guiding/light_guide.hpp"'
plant core/scene/bad.cpp '#include "core/integrators/render_plan.hpp"'
plant core/sandbox/bad.cpp '#include "core/scene/scene.hpp"'
plant core/sandbox/bad.hpp '#include "proto/channel.hpp"'
plant worker/bad.cpp '#include "server/scheduler/scheduler.hpp"'
plant client/bad.cpp '#include "worker/worker.hpp"'
plant client/bad.cpp '#include "client/demo/demo_farm.hpp"'
plant server/bad.cpp '#include "core/integrators/render.hpp"'
plant server/bad.cpp '#include "core/scene/scene.hpp"'
plant server/scheduler/bad.hpp '#include <sqlite3.h>'
plant server/scheduler/bad.hpp '  #  include "server/store/store.hpp"'
plant server/scheduler/bad.cpp '#include "server/any/folder.hpp"'
plant server/bad.cpp '#include <prometheus/counter.h>'
plant server/bad.cpp 'std::mutex mutex_;'
plant core/bad.cmake 'target_compile_options(x -march=na''tive)'
plant core/CMakeLists.txt 'add_compile_options(-ffast-''math)'
plant core/film/bad.cpp '#include <immintrin.h>'
plant core/film/bad.cpp 'float f(__m128 x) { return _mm_cvtss_f32(x); }'
plant core/film/bad.cpp 'float f(float x) { return std::sin(x); }'
plant core/film/bad.cpp 'float f(float x) { return 1 + ::powf(x, 2); }'
plant scenes/bad.cpp '#include <random>'
plant core/film/bad.hpp '// see /home/someone/tessera'
plant scenes/generate 'cd /home/someone/tessera'
plant scenes/bad.mtl 'map_Kd /home/someone/wood.png'
plant tests/CMakeLists.txt '# CTest labels say what kind of test it is (browser).'
plant bad.md "$long"
plant scenes/bad.md "- $long"

exit "$failures"
