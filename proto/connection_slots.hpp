// SPDX-License-Identifier: Apache-2.0
// Counts the open connections, in total and by machine. gRPC owns the descriptors and closes them without
// notice, so the sockets are checked, but only when a limit seems to be reached. For one thread at a time.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <map>
#include <string>

namespace tessera::proto {

class ConnectionSlots {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Room { kYes, kNone, kNoneForMachine };

  ConnectionSlots(std::size_t most, std::size_t most_of_machine)
      : most_(most), most_of_machine_(most_of_machine) {}

  // Whether another connection of this machine is within the limits. Checking all sockets takes at most a
  // twentieth of the time, so a closed connection is noticed with a short delay: 50 ms for 10,000.
  Room room_for(const std::string& machine);
  // Counts an open socket until it is closed, by whichever part of the process.
  void take(int descriptor, const std::string& machine);

  std::size_t most() const { return most_; }
  std::size_t most_of_machine() const { return most_of_machine_; }

 private:
  struct Slot {
    ino_t socket;  // the inode, which tells the socket from a later one with the same descriptor
    std::string machine;
  };
  using Slots = std::map<int, Slot>;  // by descriptor

  Room counted_room_for(const std::string& machine) const;
  void check();
  Slots::iterator forget(Slots::iterator slot);

  const std::size_t most_, most_of_machine_;
  Slots slots_;
  std::map<std::string, std::size_t> of_machine_;  // counts of slots_, without zeros
  Clock::time_point next_look_{};
};

}  // namespace tessera::proto
