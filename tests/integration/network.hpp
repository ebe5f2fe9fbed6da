// SPDX-License-Identifier: Apache-2.0
// An emulated network: each host has its own network namespace, and this process is the switch between them.
// It can delay or drop every frame, limit rates, and disconnect hosts, so that TCP behaves as on a bad line.
// Everything is removed when this process ends. Needs Linux network namespaces, as root or with user
// namespaces, and `ip`. Not thread-safe.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

namespace tessera::test {

// What this machine lacks for an emulated network.
class NoNetwork : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Network {
 public:
  // Moves this process into its own namespace for good. Call it before there are other threads. Returns the
  // reason if that is not possible.
  static std::optional<std::string> enter();

  // This process is host 1. All of these functions throw NoNetwork.
  Network();
  ~Network();
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  static std::string address_of(int host);
  // Each host has both addresses.
  static std::string ipv6_address_of(int host);
  // Returns the process in whose namespace the host's programs must run.
  pid_t add_host(int host);

  // Drops all frames of the host, silently.
  void pull(int host);
  void plug_in(int host);
  // Apply to all later frames, in each direction.
  void hold_up(std::chrono::milliseconds delay);
  void lose(double share);
  // The rate of one line that all frames share.
  void limit_rate(double bytes_per_second);
  // The line of one host: its delay and rate, in each direction. A rate of 0 is unlimited.
  void set_line(int host, std::chrono::milliseconds delay, double bytes_per_second);
  // The bytes of frames that the host has sent so far.
  std::uint64_t sent_bytes(int host) const;
  // Removes the IPv4 address of a host, this process included.
  void remove_ipv4(int host);

 private:
  class Switch;
  std::unique_ptr<Switch> switch_;
  std::map<int, pid_t> hosts_;
};

}  // namespace tessera::test
