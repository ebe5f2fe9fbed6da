#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# container.sh PACKAGES ROOT SOURCE: builds the last stage of deploy/container/Dockerfile with the packages of the folder
# PACKAGES, instead of those that its first stage compiles, on the root of the tar file ROOT, instead of an image of
# Debian. Looks at the image, runs coordinator and worker of compose.yaml in it, with their environment, asks for their
# health, and renders an image as its client does.
# Exit status 77 without buildah or the root.
set -euo pipefail

packages=$1
root=$2
source=$3
work=$(mktemp -d)

skip() {
  echo "container.sh: skipped: $*"
  exit 77
}

fail() {
  echo "container.sh: $*" >&2
  exit 1
}

quiet() {
  "${@:2}" >"$work/log" 2>&1 || { tail -n 60 "$work/log" >&2; fail "$1 failed"; }
}

# Images and containers are files of this test, and RUN is a chroot: no service, no images of the machine.
build() { buildah --storage-driver vfs --root "$work/storage" --runroot "$work/run" "$@"; }

clean_up() {
  build unmount --all >/dev/null 2>&1 || true
  rm -rf --one-file-system "$work"
}
trap clean_up EXIT

ls "$packages"/*.deb >/dev/null 2>&1 || skip "there are no packages (install.make_packages)"
command -v buildah >/dev/null || skip "there is no buildah"
[ -e "$root" ] || skip "there is no root of Debian (install.debian_root)"

base=$(build from scratch)
quiet "adding the root" build add "$base" "$root" /
quiet "making the base" build commit "$base" localhost/base
quiet "removing the container" build rm "$base"

context=$work/context
mkdir -p "$context/packages"
cp "$packages"/*.deb "$context/packages"
rm "$context"/packages/*-dev_*
mkdir "$context/deploy"
cp -r "$source/deploy/container" "$context/deploy"
# shellcheck disable=SC2016  # the Dockerfile's own variable
{
  printf 'FROM scratch AS build\nCOPY packages /packages\n'
  awk '/^FROM/ { ++stage } stage == 2' "$source/deploy/container/Dockerfile" | sed 's#^FROM ${BASE}#FROM localhost/base#'
} >"$context/Dockerfile"
quiet "building the image" build build --isolation chroot --network host --format docker -t localhost/tessera \
  -f "$context/Dockerfile" "$context"

container=$(build from localhost/tessera)
mounted=$(build mount "$container")
config() { build inspect --format "{{$1}}" "$container"; }
[ "$(config .Docker.Config.User)" = 10001:10001 ] || fail "its user is $(config .Docker.Config.User)"
[ "$(config .Docker.Config.Healthcheck.Test)" = '[CMD /usr/libexec/tessera/health]' ] || fail "it has no health check"
! find "$mounted" -xdev \( -path "$mounted/proc" -o -path "$mounted/usr/share/doc" \) -prune -o -name '*.deb' -print |
  grep . || fail "packages are left in it"
! ls -d "$mounted/packages" "$mounted/usr/share/tessera/scenes/go/scene.json" 2>/dev/null || fail "it has what it does not need"
echo "container.sh: $(du -sm "$mounted" | cut -f 1) MB, on $(du -sm "$root" | cut -f 1) MB of Debian"

# As container engines have it.
mkdir -p "$mounted/dev/shm"
chmod 1777 "$mounted/dev/shm"

# What runs in the container: as process 1 of its user, with its environment.
image_environment=()
while IFS= read -r variable; do [ -z "$variable" ] || image_environment+=("$variable"); done < <(
  build inspect --format '{{range .Docker.Config.Env}}{{println .}}{{end}}' "$container")
container=(unshare --mount --pid --fork --kill-child --root="$mounted" --mount-proc=/proc --setgid=10001 --setuid=10001 --wd=/tmp
  env -i PATH=/usr/bin:/bin "${image_environment[@]}")
for program in tessera tessera-coordinator tessera-worker; do
  "${container[@]}" "$program" --version | grep -q "^$program [0-9]" || fail "there is no $program"
done

# environment_of SERVICE: what compose.yaml gives to it.
environment_of() {
  python3 - "$source/deploy/container/compose.yaml" "$1" <<'END'
import sys, yaml
service = yaml.safe_load(open(sys.argv[1]))["services"][sys.argv[2]]
program = service["entrypoint"] if sys.argv[2] == "client" else service["command"]
assert program == [{"client": "tessera"}.get(sys.argv[2], "tessera-" + sys.argv[2])], service
assert service["read_only"] and service["cap_drop"] == ["ALL"], service
for name, value in service["environment"].items():
    print(f"{name}={value}")
END
}
mapfile -t of_worker < <(environment_of worker)
[ ${#of_worker[@]} -ge 2 ] || fail "compose.yaml has no environment for the worker"
quiet "the worker with the environment of compose.yaml" "${container[@]}" "${of_worker[@]}" tessera-worker --help

# In a network of its own, so that its ports are free. The name of the coordinator is that of the loopback.
echo '127.0.0.1 localhost coordinator' >"$mounted/etc/hosts"
mapfile -t of_coordinator < <(environment_of coordinator)
# shellcheck disable=SC2016  # for the inner shell
unshare --net bash -c 'ip link set lo up && exec "$@"' - \
  "${container[@]}" "${of_coordinator[@]}" tessera-coordinator >"$work/coordinator.log" 2>&1 &
outer=$!
# end PID: ends a process and those below it, which do not all die with it: a change of user takes --kill-child back.
end() {
  local child
  for child in $(pgrep -P "$1"); do end "$child"; done
  kill -KILL "$1" 2>/dev/null || true
  wait "$1" 2>/dev/null || true
}
trap 'end "$outer"; clean_up' EXIT
# health [PORT]: runs the health check beside the coordinator.
health() {
  local first
  first=$(pgrep -P "$outer" -x tessera-coordin) || return 1
  nsenter --target "$first" --pid --mount --net --root --wd --setgid=10001 --setuid=10001 /usr/libexec/tessera/health "$@"
}
for ((i = 0; i < 600; ++i)); do health >/dev/null 2>&1 && break; sleep 0.1; done
health || { cat "$work/coordinator.log" >&2; fail "the coordinator is not healthy"; }
! health 1 2>/dev/null || fail "the health check never fails"

# inside ARGUMENT...: runs it in the network of the coordinator. With the worker, whose metrics need another port there.
inside() { nsenter --target "$(pgrep -P "$outer" -x tessera-coordin)" --net "${container[@]}" "$@"; }
inside "${of_worker[@]}" TESSERA_WORKER_METRICS=127.0.0.1:9465 tessera-worker >"$work/worker.log" 2>&1 &
worker=$!
trap 'end "$worker"; end "$outer"; clean_up' EXIT
mapfile -t of_client < <(environment_of client)
options=(cornell --size 48x48 --spp 2)
quiet "rendering on the farm" inside "${of_client[@]}" timeout 120 tessera submit "${options[@]}" --insecure --wait -o /tmp/farm.exr
quiet "rendering in one process" inside tessera render "${options[@]}" -o /tmp/here.exr
cmp "$mounted/tmp/farm.exr" "$mounted/tmp/here.exr" || fail "the farm renders other bytes"
