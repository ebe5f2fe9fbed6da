// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/connection_slots.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/stat.h>

#include <algorithm>
#include <iterator>
#include <regex>
#include <utility>

namespace tessera::rpc {

namespace {

// After each check of all sockets, none follows for so many times as long.
constexpr int kRest = 19;
constexpr std::size_t kNetworkBytes = 8;  // of an IPv6 address

// The inode; 0 if the descriptor is no socket.
ino_t number_of_socket(int descriptor) {
  struct ::stat status {};
  return ::fstat(descriptor, &status) == 0 && S_ISSOCK(status.st_mode) ? status.st_ino : 0;
}

}  // namespace

std::string client_key(const sockaddr_storage& peer) {
  char text[INET6_ADDRSTRLEN] = "";
  if (peer.ss_family == AF_INET) {
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in&>(peer).sin_addr, text, sizeof text);
    return text;
  }
  in6_addr network = reinterpret_cast<const sockaddr_in6&>(peer).sin6_addr;
  std::fill(std::begin(network.s6_addr) + kNetworkBytes, std::end(network.s6_addr), std::uint8_t{0});
  inet_ntop(AF_INET6, &network, text, sizeof text);
  return std::string(text) + "/64";
}

std::string client_key(const std::string& peer) {
  if (peer.starts_with("ipv4:")) return peer.substr(0, peer.find_last_of(':'));  // the common case
  static const std::regex kIpv6(R"(ipv6:(?:\[|%5B)([0-9a-f:.]+)(?:\]|%5D):\d+)", std::regex::icase);
  std::smatch parts;
  sockaddr_storage address{};
  auto& ipv6 = reinterpret_cast<sockaddr_in6&>(address);
  ipv6.sin6_family = AF_INET6;
  if (std::regex_match(peer, parts, kIpv6) && inet_pton(AF_INET6, parts.str(1).c_str(), &ipv6.sin6_addr) == 1)
    return client_key(address);
  return peer.substr(0, peer.find_last_of(':'));
}

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

}  // namespace tessera::rpc
