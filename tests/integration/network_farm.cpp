// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/network_farm.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>

namespace tessera::test {

NamespacesFirst::NamespacesFirst() : why_not_(Network::enter()) {
  try {
    if (!why_not_) network_ = std::make_unique<Network>();
  } catch (const NoNetwork& error) {
    why_not_ = error.what();
  }
}

void NetworkFarmTest::SetUp() {
  if (why_not_) GTEST_SKIP() << "no network namespaces: " << *why_not_;
  for (const auto& [name, host] : {std::pair<const char*, int>{"coordinator", kCoordinator},
                                   {"first", kFirst},
                                   {"second", kSecond},
                                   {"third", kThird},
                                   {"tessera", kClient}}) {
    add_host(name, host);
    if (IsSkipped()) return;
  }
  listen_ = Network::address_of(kCoordinator) + ":0";
  coordinator_options_ = {"--insecure"};
  security_.insecure = true;
}

void NetworkFarmTest::add_host(const std::string& name, int host) {
  try {
    networks_[name] = network().add_host(host);
  } catch (const NoNetwork& error) {
    GTEST_SKIP() << error.what();
  }
}

// The job that was submitted last.
std::string NetworkFarmTest::newest_job() {
  if (!poll_until(std::chrono::seconds(30), [&] { return !jobs().empty(); }))
    throw std::runtime_error("no job was submitted");
  return jobs().front().id();
}

bool NetworkFarmTest::is_heard(const std::string& name) {
  const auto known = workers();
  return std::any_of(known.begin(), known.end(),
                     [&](const auto& worker) { return worker.name() == name && !worker.silent(); });
}

}  // namespace tessera::test
