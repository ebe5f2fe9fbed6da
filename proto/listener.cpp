// SPDX-License-Identifier: Apache-2.0
#include "proto/listener.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

#include "core/common/log.hpp"
#include "proto/peer_address.hpp"

namespace tessera::proto {

using core::ErrorCode;
using Clock = std::chrono::steady_clock;

namespace {

// The pause before a retry when descriptors or kernel memory are exhausted.
constexpr std::chrono::milliseconds kPause{20};

// Errors of accept() that concern the process or the machine, not the connection.
bool is_exhaustion(int error) {
  return error == EMFILE || error == ENFILE || error == ENOBUFS || error == ENOMEM;
}

}  // namespace

Listener::Listener(ListeningSockets listening, ConnectionSlots slots, Reasons reasons, core::OpenFile stopped)
    : port_(listening.port),
      reasons_(std::move(reasons)),
      stopped_(std::move(stopped)),
      sockets_(std::move(listening.sockets)),
      slots_(std::move(slots)) {}

Listener::~Listener() {
  stop();
}

core::Result<std::unique_ptr<Listener>> Listener::make(ListeningSockets listening, ConnectionSlots slots,
                                                       Reasons reasons) {
  core::OpenFile stopped(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!stopped)
    return core::fail(ErrorCode::kUnavailable, fmt::format("cannot listen: {}", std::strerror(errno)));
  return std::unique_ptr<Listener>(
      new Listener(std::move(listening), std::move(slots), std::move(reasons), std::move(stopped)));
}

void Listener::start(Take take) {
  thread_ = std::thread([this, take = std::move(take)] { run(take); });
}

void Listener::stop() {
  if (thread_.joinable()) {
    eventfd_write(stopped_.get(), 1);
    thread_.join();
  }
  sockets_.clear();
}

void Listener::run(const Take& take) {
  std::vector<pollfd> waiting{{stopped_.get(), POLLIN, 0}};
  for (const core::OpenFile& socket : sockets_) waiting.push_back({socket.get(), POLLIN, 0});
  while (true) {
    const int ready = poll(waiting.data(), waiting.size(), wait_ms());
    if (const auto line = log_.take_due(Clock::now())) common::log(*line);
    if (ready < 0) std::this_thread::sleep_for(kPause);  // no memory, or interrupted by a signal
    if (ready <= 0) continue;
    if (waiting.front().revents != 0) return;
    for (std::size_t i = 0; i < sockets_.size(); ++i)
      if (waiting[i + 1].revents != 0) accept_from(sockets_[i], take);
  }
}

int Listener::wait_ms() const {
  const auto wait = log_.due_in(Clock::now());
  return wait ? static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(*wait).count()) : -1;
}

void Listener::warn(std::string sentence, const std::string& machine) {
  if (const auto line = log_.note({std::move(sentence), {.peer = machine}}, Clock::now())) common::log(*line);
}

void Listener::accept_from(const core::OpenFile& socket, const Take& take) {
  sockaddr_storage peer{};
  socklen_t length = sizeof peer;
  core::OpenFile connection(
      ::accept4(socket.get(), reinterpret_cast<sockaddr*>(&peer), &length, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!connection) {
    if (!is_exhaustion(errno)) return;  // the connection is gone already
    warn(fmt::format("cannot take a connection: {}; it waits (ulimit -n, LimitNOFILE= of systemd)",
                     std::strerror(errno)),
         "");
    return std::this_thread::sleep_for(kPause);
  }
  const std::string machine = address_key(peer);
  if (!has_room(machine)) return;
  slots_.take(connection.get(), machine);
  take(connection.release());
}

bool Listener::has_room(const std::string& machine) {
  const ConnectionSlots::Room room = slots_.room_for(machine);
  if (room == ConnectionSlots::Room::kNone)
    warn(fmt::format("closed a connection of {}: there are {}, and {}", machine, slots_.most(), reasons_.all),
         machine);
  if (room == ConnectionSlots::Room::kNoneForMachine)
    warn(fmt::format("closed a connection of {}: it has {}, and {}", machine, slots_.most_of_machine(),
                     reasons_.machine),
         machine);
  return room == ConnectionSlots::Room::kYes;
}

}  // namespace tessera::proto
