// SPDX-License-Identifier: Apache-2.0
#include "proto/connection_slots.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <utility>

namespace tessera::proto {

namespace {

// After each check of all sockets, none follows for so many times as long.
constexpr int kRest = 19;

// The inode; 0 if the descriptor is no socket.
ino_t number_of_socket(int descriptor) {
  struct ::stat status {};
  return ::fstat(descriptor, &status) == 0 && S_ISSOCK(status.st_mode) ? status.st_ino : 0;
}

}  // namespace

ConnectionSlots::Room ConnectionSlots::room_for(const std::string& machine) {
  if (counted_room_for(machine) != Room::kYes) check();
  return counted_room_for(machine);
}

void ConnectionSlots::take(int descriptor, const std::string& machine) {
  if (const auto before = slots_.find(descriptor); before != slots_.end()) forget(before);
  slots_[descriptor] = {number_of_socket(descriptor), machine};
  ++of_machine_[machine];
}

ConnectionSlots::Room ConnectionSlots::counted_room_for(const std::string& machine) const {
  if (slots_.size() >= most_) return Room::kNone;
  const auto found = of_machine_.find(machine);
  const bool has_many = found != of_machine_.end() && found->second >= most_of_machine_;
  return has_many ? Room::kNoneForMachine : Room::kYes;
}

void ConnectionSlots::check() {
  const auto begin = Clock::now();
  if (begin < next_look_) return;
  for (auto slot = slots_.begin(); slot != slots_.end();) {
    const bool is_open = number_of_socket(slot->first) == slot->second.socket;
    slot = is_open ? std::next(slot) : forget(slot);
  }
  const auto end = Clock::now();
  next_look_ = end + kRest * (end - begin);
}

ConnectionSlots::Slots::iterator ConnectionSlots::forget(Slots::iterator slot) {
  const auto machine = of_machine_.find(slot->second.machine);
  if (--machine->second == 0) of_machine_.erase(machine);
  return slots_.erase(slot);
}

}  // namespace tessera::proto
