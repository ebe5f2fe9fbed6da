// SPDX-License-Identifier: Apache-2.0
// A farm whose coordinator, workers and clients each have a host of an emulated network. Tests are skipped
// with the reason where there are no network namespaces. Not thread-safe.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "tests/integration/farm_processes.hpp"
#include "tests/integration/network.hpp"

namespace tessera::test {

// Enters the namespace before other threads start.
class NamespacesFirst {
 public:
  NamespacesFirst();

 protected:
  std::optional<std::string> why_not_;
  std::unique_ptr<Network> network_;
};

class NetworkFarmTest : private NamespacesFirst, public FarmTest {
 protected:
  static constexpr int kCoordinator = 2, kFirst = 3, kSecond = 4, kClient = 5, kThird = 6;

  // Makes the hosts of the coordinator, the workers "first", "second" and "third", and of clients.
  void SetUp() override;
  // A host for the processes of this name. Skips the test if that is not possible.
  void add_host(const std::string& name, int host);

  Network& network() { return *network_; }
  std::string newest_job();
  bool is_heard(const std::string& name);
};

}  // namespace tessera::test
