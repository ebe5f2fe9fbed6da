// SPDX-License-Identifier: Apache-2.0
// A coordinator with its page and a worker, in this process. They speak to each other, and with clients, as
// on any farm: over a port of this machine. Their log shows errors only. One at a time.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/base/error.hpp"

namespace tessera::client {

// NOT_FOUND, with the packages to install: a program in which scenes are read is missing.
core::Status check_demo_programs();

class DemoFarm {
 public:
  // Keeps its state in this folder and serves the page at `http` (HOST:PORT). Errors name the address that
  // cannot be used. Missing parts of the sandbox are printed.
  static core::Result<std::unique_ptr<DemoFarm>> start(const std::filesystem::path& folder,
                                                       const std::string& http);
  // Ends the worker, which finishes its piece, and then the coordinator.
  ~DemoFarm();

  const std::string& address() const;  // HOST:PORT for clients
  std::string page() const;            // http://HOST:PORT/

 private:
  struct Parts;
  explicit DemoFarm(std::unique_ptr<Parts> parts);

  std::unique_ptr<Parts> parts_;
};

}  // namespace tessera::client
