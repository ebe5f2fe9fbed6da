#!/usr/bin/env bash
# Installs every Debian 12 package that building and testing Tessera needs. Quick when all are there already.
set -euo pipefail

packages=(
  # The compiler (with OpenMP and nm), the build system, and how it finds libraries.
  g++ binutils cmake ninja-build pkg-config
  # Results and formatted messages; hashes of content and of film tiles.
  libexpected-dev libfmt-dev libssl-dev libxxhash-dev
  # What goes in: scene files, meshes, textures, options.
  nlohmann-json3-dev libtinyobjloader-dev libstb-dev libcli11-dev
  # What comes out: OpenEXR pictures.
  libopenexr-dev libimath-dev
  # The farm: RPC and its code generators, logs, durable state, compressed film tiles.
  libabsl-dev libgrpc++-dev libprotobuf-dev protobuf-compiler protobuf-compiler-grpc
  libspdlog-dev libsqlite3-dev libzstd-dev
  # deploy/make_certificates.sh.
  openssl
  # Tests of networks that break, in network namespaces.
  iproute2
  # tests/fuzz and the preset tsan: Clang with libFuzzer, the sanitizers and OpenMP.
  clang-14 libclang-rt-14-dev libomp-14-dev
  # Tests, counts of instructions, and benchmarks (Embree only to be measured beside).
  libgtest-dev libgmock-dev libbenchmark-dev libembree-dev valgrind
  # run_all.sh: reading statistics, and putting pictures on one sheet with their names.
  jq graphicsmagick fonts-dejavu-core
)

missing=()
for package in "${packages[@]}"; do
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

echo "Installing ${#missing[@]} Debian packages: ${missing[*]}"
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=500)
"${apt[@]}" update
"${apt[@]}" install -y --no-install-recommends "${missing[@]}" >/dev/null
