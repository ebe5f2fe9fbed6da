#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# setup.sh [build] [package] [test] [bench]: installs the Debian 12 packages that building and rendering, packaging, testing
# or measuring Tessera need; all of them without arguments. Quick when they are there already.
set -euo pipefail

build=(
  # The compiler (with OpenMP) and the build system, and how it finds libraries.
  g++ cmake ninja-build pkg-config
  # Vectors on other processors than x86-64.
  libsimde-dev
  # Results and formatted messages; hashes of content and of film tiles.
  libexpected-dev
  libfmt-dev
  libssl-dev
  libxxhash-dev
  # What goes in: scene files, meshes, textures, options.
  nlohmann-json3-dev
  libtinyobjloader-dev
  libdraco-dev
  libmeshoptimizer-dev
  libpugixml-dev
  libstb-dev
  libcli11-dev
  # Image files, read and written.
  libopenexr-dev
  libimath-dev
  libjpeg62-turbo-dev
  libqoi-dev
  libspng-dev
  libtiff-dev
  libwebp-dev
  # Images in the terminal.
  libsixel-dev
  # The browser view: HTTP with TLS, compressed pixels.
  libmicrohttpd-dev
  libgnutls28-dev
  libdeflate-dev
  # The farm: RPC and its code generators, logs, metrics, durable state, compressed film tiles.
  libabsl-dev
  libgrpc++-dev
  libprotobuf-dev
  protobuf-compiler
  protobuf-compiler-grpc
  libspdlog-dev
  prometheus-cpp-dev
  libsqlite3-dev
  libzstd-dev
  # deploy/make_certificates.sh.
  openssl
)
package=(
  # What a package's programs depend on.
  dpkg-dev
)
test=(
  libgtest-dev
  libgmock-dev
  # Links the tests in a quarter of the time.
  lld
  # What the coordinator's binary contains; counts of instructions.
  binutils
  valgrind
  # Networks that break, in network namespaces.
  iproute2
  # promtool checks metrics and alert rules. Its server is not started (below).
  prometheus
  # Packages, checked and installed in a root of their own; the image, built without a service; services, in a container that
  # systemd boots.
  debootstrap
  lintian
  buildah
  systemd
  systemd-container
  # A cluster of several nodes on one machine: tests/cluster. Its daemons are started by the tests alone.
  slurm-wlm
  bc
  # Manifests for Kubernetes.
  python3-yaml
  # The example of a client in Python.
  python3-grpcio
  python3-protobuf
  # Tests of the scene file's JSON Schema.
  libvalijson-dev
  # The completions of the command line, in the shells that they are for.
  fish
  zsh
  # Tests of the page, with fonts for its screenshots. node and npm: below.
  chromium
  fonts-dejavu-core
  # tests/fuzz and the preset tsan: Clang with libFuzzer, the sanitizers and OpenMP.
  clang-14
  libclang-rt-14-dev
  libomp-14-dev
)
bench=(
  libbenchmark-dev
  # Measured beside.
  libembree-dev
  # run_all.sh: reading statistics, and putting images on one sheet with their names.
  jq
  graphicsmagick
  fonts-dejavu-core
  # bench/scenes: comparing images.
  python3-numpy
)

# Any node from version 18 drives the browser, also one that is not Debian's.
command -v npm >/dev/null || test+=(nodejs npm)

wanted=()
[ $# -gt 0 ] || set -- build package test bench
for purpose in "$@"; do
  case $purpose in
    build) wanted+=("${build[@]}") ;;
    package) wanted+=("${package[@]}") ;;
    test) wanted+=("${test[@]}") ;;
    bench) wanted+=("${bench[@]}") ;;
    *) echo "setup.sh: unknown purpose '$purpose'; there are build, package, test and bench" >&2; exit 2 ;;
  esac
done

missing=()
for package in "${wanted[@]}"; do
  state=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$state" = installed ] || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "setup.sh: these Debian packages are missing: ${missing[*]}" >&2
    echo "setup.sh: run scripts/setup.sh as root, or install sudo, to have them installed." >&2
    exit 1
  fi
  as_root=(sudo)
fi

# Of prometheus, promtool is wanted and the server is not: no package starts services while this script runs.
policy=/usr/sbin/policy-rc.d
if [ ! -e $policy ]; then
  trap '"${as_root[@]}" rm -f $policy' EXIT
  printf '#!/bin/sh\nexit 101\n' | "${as_root[@]}" install -m 755 /dev/stdin $policy
fi

echo "Installing ${#missing[@]} Debian packages: ${missing[*]}"
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=500)
"${apt[@]}" update
"${apt[@]}" install -y --no-install-recommends "${missing[@]}" >/dev/null
if [[ " ${missing[*]} " == *" prometheus "* ]] && command -v systemctl >/dev/null; then
  "${as_root[@]}" systemctl --quiet disable prometheus || true
fi
