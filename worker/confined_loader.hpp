// SPDX-License-Identifier: Apache-2.0
// Loads scenes in confined processes (worker/scene_loader). Files of strangers are parsed there, and nowhere
// in the worker, which has credentials and a network.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"
#include "worker/job.hpp"
#include "worker/scene_loader/flags.hpp"

namespace tessera::worker {

struct LoaderOptions {
  std::string program;       // path of tessera-scene-loader; default: beside this program
  std::uint64_t memory_mib;  // address space of the process, and the size of a loaded scene; default: all
                             // memory of this machine
  std::chrono::seconds time{20 * 60};  // processor time of the process, and its timeout
  bool require_sandbox = false;        // load nothing if a part of the sandbox is missing

  LoaderOptions();
};

// That scenes can be loaded, and how well confined. FAILED_PRECONDITION: there is no such program, or a part
// of the required sandbox is missing. Otherwise each missing part goes to `warn` as one line.
core::Status check_loader(const LoaderOptions& options,
                          const std::function<void(const std::string& line)>& warn);

// Loads the scene of these files with the messages of a local render. Blocks; `threads` read what the process
// has written. A file whose bytes are not those of its digest is removed, so that it is fetched again:
// DATA_LOSS. CANCELLED after a stop request. RESOURCE_EXHAUSTED if memory does not suffice, DEADLINE_EXCEEDED
// after the time; INTERNAL if the process fails otherwise. Throws std::bad_alloc. Thread-safe.
core::Result<core::SceneDescription> load_confined(const LoaderOptions& options, const SceneFiles& files,
                                                   int threads, const std::stop_token& stop);

}  // namespace tessera::worker
