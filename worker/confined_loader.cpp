// SPDX-License-Identifier: Apache-2.0
#include "worker/confined_loader.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>

#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/available_resources.hpp"
#include "core/sandbox/check.hpp"
#include "core/sandbox/flags.hpp"
#include "core/sandbox/memory_file.hpp"
#include "core/sandbox/process.hpp"
#include "core/scene/cache/loaded_scene.hpp"
#include "worker/blob_cache.hpp"

namespace tessera::worker {
namespace {

using core::ErrorCode;
using sandbox::Ending;

// The files that the process may ask for, in the order of their names.
class CheckedFiles {
 public:
  explicit CheckedFiles(const SceneFiles& files) : files_(files) {
    for (const auto& [name, path] : files.blob_paths) names_.push_back(name);
  }

  const std::vector<std::string>& names() const { return names_; }
  // The last file whose bytes were not those of its digest.
  const std::optional<core::Error>& damage() const { return damage_; }

  // Checks that the bytes match the digest, since the file may have changed after it was fetched.
  core::Result<core::OpenFile> open(std::uint32_t number) {
    if (number >= names_.size()) return core::fail(ErrorCode::kInvalidArgument, "there is no such file");
    const std::string& name = names_[number];
    const std::string& path = files_.blob_paths.at(name);
    auto file = sandbox::open_to_send(path);
    const auto digest = files_.digests.find(name);
    if (!file || digest == files_.digests.end() || holds(*file, digest->second)) return file;
    std::remove(path.c_str());
    damage_ = core::Error{ErrorCode::kDataLoss, path + " has changed since it was fetched"};
    return core::fail(*damage_);
  }

 private:
  const SceneFiles& files_;
  std::vector<std::string> names_;
  std::optional<core::Error> damage_;
};

sandbox::Program program_of(const LoaderOptions& options, const std::stop_token& stop) {
  sandbox::Program program{.path = options.program,
                           .arguments = {kSceneMemoryFlag, std::to_string(options.memory_mib),
                                         kSceneSecondsFlag, std::to_string(options.time.count())},
                           .timeout = options.time,
                           .stop = stop};
  if (options.require_sandbox) program.arguments.emplace_back(sandbox::kCompleteFlag);
  return program;
}

core::Error takes_too_much(const std::string& what, const LoaderOptions& options) {
  return {ErrorCode::kResourceExhausted,
          fmt::format("{}; this worker loads scenes within {} MiB (tessera-worker {})", what,
                      options.memory_mib, kSceneMemoryFlag)};
}

// Why the process has written no scene; nothing if it should have.
std::optional<core::Error> failure_of(const Ending& ending, const LoaderOptions& options) {
  if (ending.cause == Ending::Cause::kStopRequest)
    return core::Error{ErrorCode::kCancelled, "the worker is stopping"};
  if (ending.cause == Ending::Cause::kTimeout || ending.by_signal(SIGXCPU))
    return core::Error{ErrorCode::kDeadlineExceeded,
                       fmt::format("the scene was not loaded within the {} s that this worker allows "
                                   "(tessera-worker {})",
                                   options.time.count(), kSceneSecondsFlag)};
  const bool no_memory = WIFEXITED(ending.status) && WEXITSTATUS(ending.status) == kExitNoMemory;
  if (no_memory || ending.by_signal(SIGKILL) || ending.by_signal(SIGXFSZ))
    return takes_too_much("the scene does not fit into memory", options);
  if (ending.succeeded()) return std::nullopt;
  return core::Error{ErrorCode::kInternal,
                     "the scene could not be loaded: " + sandbox::describe(ending, kSceneLoaderName)};
}

}  // namespace

LoaderOptions::LoaderOptions()
    : program(sandbox::path_beside_this(kSceneLoaderName)),
      memory_mib(core::available_memory_bytes() >> 20) {}

core::Status check_loader(const LoaderOptions& options,
                          const std::function<void(const std::string& line)>& warn) {
  if (core::Status found = sandbox::check_program(options.program, kSceneLoaderName, "--scene-loader");
      !found)
    return found;
  return sandbox::check_sandbox(options.program, options.require_sandbox, warn);
}

core::Result<core::SceneDescription> load_confined(const LoaderOptions& options, const SceneFiles& files,
                                                   int threads, const std::stop_token& stop) {
  CheckedFiles checked(files);
  auto in = sandbox::create_memory_file("load request"), out = sandbox::create_memory_file("loaded scene");
  if (!in) return core::fail(in.error());
  if (!out) return core::fail(out.error());
  const core::LoadRequest request{files.scene_path, checked.names()};
  if (const core::Status written = core::write_load_request(core::OpenFile(dup(in->get())), request);
      !written)
    return core::fail(written.error());
  const auto ending = sandbox::run(program_of(options, stop),
                                   {*in, *out, [&](std::uint32_t number) { return checked.open(number); }});
  if (!ending) return core::fail(ending.error());
  if (const auto failure = failure_of(*ending, options)) return core::fail(*failure);
  auto loaded = core::read_loaded(*std::move(out), threads);
  if (!loaded && checked.damage()) return core::fail(*checked.damage());
  if (!loaded && loaded.error().code == ErrorCode::kResourceExhausted)
    return core::fail(takes_too_much(loaded.error().message, options));
  return loaded;
}

}  // namespace tessera::worker
