// SPDX-License-Identifier: Apache-2.0
// Hosts of one network, each in a network namespace of its own, joined by a switch that this process plays:
// every frame between them passes through it, and can be held up, lost, or stopped by a pulled cable. TCP
// sees what it would see on a bad line. Everything is gone when this process ends. Needs Linux's network
// namespaces, by way of root or of user namespaces, and `ip`. Not thread-safe.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

namespace tessera::test {

// What this machine lacks for it.
class NoNetwork : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Network {
 public:
  // Takes this process into a namespace of its own, once and for all, and to be called before it has threads.
  // Why that cannot be done here, if so.
  static std::optional<std::string> enter();

  // This process is host 1. All of these throw NoNetwork.
  Network();
  ~Network();
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  static std::string address_of(int host);
  // Answers with the process in whose namespace the host's programs are to run.
  pid_t add_host(int host);

  // The host's cable: nothing passes, and nobody is told.
  void pull(int host);
  void plug_in(int host);
  // For all frames from now on, in each direction.
  void hold_up(std::chrono::milliseconds delay);
  void lose(double share);
  // Of one line that all frames take.
  void limit_rate(double bytes_per_second);

 private:
  class Switch;
  std::unique_ptr<Switch> switch_;
  std::map<int, pid_t> hosts_;
};

}  // namespace tessera::test
