// SPDX-License-Identifier: Apache-2.0
// tessera-scene-loader: reads the files of a scene for a worker, confined. The worker starts one for every
// scene that is not in its cache, so that a hostile file can take over only this process.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <exception>
#include <new>
#include <optional>
#include <string>

#include "core/base/version.hpp"
#include "core/cli/help.hpp"
#include "core/cli/parse.hpp"
#include "core/sandbox/bundle_files.hpp"
#include "core/sandbox/options.hpp"
#include "core/scene/cache/loaded_scene.hpp"
#include "core/scene/loader/loader.hpp"
#include "worker/scene_loader/flags.hpp"

namespace {

using namespace tessera;

const cli::HelpText kHelp{
    .notes =
        R"(Reads a request on stdin, asks the worker for files and writes the scene to stdout. The worker starts one process
for every scene that is not in its cache. The process gives up all rights that it does not need, loads the scene and
ends.)",
    .exit_statuses = {{cli::kExitOk, "has written the scene, or why there is none"},
                      {cli::kExitFailed, "failed"},
                      {cli::kExitUsage, "wrong command line"},
                      {worker::kExitNoMemory, "not enough memory"}}};

// The exit status if the program should end now.
std::optional<int> parse(int argc, char** argv, sandbox::Options& options) {
  CLI::App app("Load a scene for tessera-worker", worker::kSceneLoaderName);
  cli::set_help(app, kHelp);
  app.set_version_flag("--version",
                       std::string(worker::kSceneLoaderName) + " " + std::string(core::version()),
                       "Print the version");
  sandbox::add_flags(app, options,
                     {.memory_mib = worker::kSceneMemoryFlag, .cpu_seconds = worker::kSceneSecondsFlag});
  return cli::parse(app, argc, argv, worker::kSceneLoaderName);
}

int fail(const std::string& why) {
  return cli::print_error(worker::kSceneLoaderName, why);
}

core::Result<core::SceneDescription> load(const core::LoadRequest& request) {
  core::BundleAssets assets = sandbox::bundle_files(request.names);
  try {
    return core::load_scene(assets, request.scene_path, request.scene_path);
  } catch (const std::bad_alloc&) {
    return core::fail(core::ErrorCode::kResourceExhausted, "the scene does not fit into memory");
  } catch (const std::exception& error) {
    return core::fail(core::ErrorCode::kInternal, error.what());
  }
}

}  // namespace

#ifdef TESSERA_SANITIZED
// A confined process may not trace its own threads, as the leak check at exit does.
extern "C" int __lsan_is_turned_off() {
  return 1;
}
#endif

int main(int argc, char** argv) {
  sandbox::Options options;
  if (const auto ended = parse(argc, argv, options)) return *ended;
  // Its answer is the scene.
  options.confinement.output_bytes = options.confinement.memory_mib << 20;
  if (const auto ended = sandbox::confine_or_end(options, worker::kSceneLoaderName)) return *ended;
  try {
    const auto request = core::read_load_request(core::OpenFile(STDIN_FILENO));
    if (!request) return fail(request.error().message + "; the worker starts it");
    const core::Status written = core::write_loaded(core::OpenFile(STDOUT_FILENO), load(*request));
    return written ? cli::kExitOk : fail(written.error().message);
  } catch (const std::bad_alloc&) {
    return worker::kExitNoMemory;
  }
}
