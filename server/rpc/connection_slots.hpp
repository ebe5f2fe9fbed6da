// SPDX-License-Identifier: Apache-2.0
// How many connections there are, all together and of each machine. Whoever was given their descriptors
// closes them without a word: they are looked at, but only where there seem to be too many. For one thread at
// a time.
#pragma once

#include <sys/socket.h>
#include <sys/types.h>

#include <chrono>
#include <map>
#include <string>

namespace tessera::rpc {

// "10.0.0.5", or the 64 bits of an IPv6 address that its network gives: their owner has all that follow.
std::string client_key(const sockaddr_storage& peer);
// The same of a peer as gRPC names it: "ipv4:10.0.0.5:4242", "ipv6:[2001:db8::5]:4242" or with %5B and %5D
// for the brackets. What is neither, without what follows the last colon.
std::string client_key(const std::string& peer);

class ConnectionSlots {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Room { kYes, kNone, kNoneForMachine };

  ConnectionSlots(std::size_t most, std::size_t most_of_machine)
      : most_(most), most_of_machine_(most_of_machine) {}

  // Whether a connection more of this machine is within the limits. Looking at all takes at most a twentieth
  // of the time: a slot that was given back is found a little later, 50 ms for 10,000.
  Room room_for(const std::string& machine);
  // Counts an open socket until it is closed, by whomever.
  void take(int descriptor, const std::string& machine);

  std::size_t most() const { return most_; }
  std::size_t most_of_machine() const { return most_of_machine_; }

 private:
  struct Slot {
    ino_t socket;  // the kernel's number, which tells it from what has the same descriptor later
    std::string machine;
  };
  using Slots = std::map<int, Slot>;  // by descriptor

  Room counted_room_for(const std::string& machine) const;
  void check();
  Slots::iterator forget(Slots::iterator slot);

  const std::size_t most_, most_of_machine_;
  Slots slots_;
  std::map<std::string, std::size_t> of_machine_;  // those of slots_, none with 0
  Clock::time_point next_look_{};
};

}  // namespace tessera::rpc
