// SPDX-License-Identifier: Apache-2.0
#include "core/common/service_manager.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "core/base/open_file.hpp"
#include "core/base/printable.hpp"

namespace tessera::common {
namespace {

using std::chrono::microseconds;

constexpr timeval kSendTimeout{.tv_sec = 5, .tv_usec = 0};
constexpr microseconds kStatusPeriod = std::chrono::seconds(10);
// Signs of life in the time in which one must come.
constexpr int kSignsPerWatchdog = 3;

std::string_view variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::optional<std::int64_t> number_in(const char* name) {
  const std::string_view text = variable(name);
  std::int64_t number = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_number = error == std::errc() && rest == text.data() + text.size();
  return is_number ? std::optional(number) : std::nullopt;
}

tl::unexpected<core::Error> cannot_send(const std::string& socket, int error) {
  return core::fail(core::ErrorCode::kUnavailable,
                    fmt::format("the service manager at {} does not take messages: {}",
                                core::printable(socket), std::strerror(error)));
}

// By CLOCK_MONOTONIC, by which the manager orders reloads: Linux's steady clock.
std::int64_t monotonic_us() {
  return std::chrono::duration_cast<microseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

microseconds period_of(const ServiceManager& manager) {
  if (!manager.watchdog()) return kStatusPeriod;
  return std::min(kStatusPeriod, *manager.watchdog() / kSignsPerWatchdog);
}

}  // namespace

ServiceManager ServiceManager::from_environment() {
  ServiceManager manager;
  manager.socket_ = variable("NOTIFY_SOCKET");
  const auto limit = number_in("WATCHDOG_USEC"), process = number_in("WATCHDOG_PID");
  const bool is_ours = variable("WATCHDOG_PID").empty() || process == ::getpid();
  if (limit && *limit > 0 && is_ours) manager.watchdog_ = microseconds(*limit);
  return manager;
}

core::Status ServiceManager::send(std::string_view assignments) const {
  if (!is_present()) return {};
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (socket_.size() >= sizeof address.sun_path) return cannot_send(socket_, ENAMETOOLONG);
  std::memcpy(address.sun_path, socket_.data(), socket_.size());
  if (socket_.front() == '@') address.sun_path[0] = '\0';
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_.size());
  const core::OpenFile out(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!out.valid()) return cannot_send(socket_, errno);
  setsockopt(out.get(), SOL_SOCKET, SO_SNDTIMEO, &kSendTimeout, sizeof kSendTimeout);
  const ssize_t sent = ::sendto(out.get(), assignments.data(), assignments.size(), MSG_NOSIGNAL,
                                reinterpret_cast<const sockaddr*>(&address), length);
  if (sent < 0) return cannot_send(socket_, errno);
  return {};
}

ServiceReport::ServiceReport(GetStatus get_status, const ServiceManager& manager)
    : get_status_(std::move(get_status)), manager_(manager) {
  if (!manager_.is_present()) return;
  {
    const core::MutexLock lock(mutex_);
    send("READY=1");
  }
  thread_ = std::jthread([this](const std::stop_token& stop) { report_until(stop); });
}

ServiceReport::~ServiceReport() {
  stopping();
}

void ServiceReport::reloading() {
  const core::MutexLock lock(mutex_);
  send(fmt::format("RELOADING=1\nMONOTONIC_USEC={}", monotonic_us()));
}

void ServiceReport::reloaded() {
  const core::MutexLock lock(mutex_);
  send("READY=1");
}

void ServiceReport::stopping() {
  {
    const core::MutexLock lock(mutex_);
    send("STOPPING=1\nSTATUS=stopping");
    is_stopping_ = true;
  }
  thread_.request_stop();
}

// A manager that has gone is no reason to stop: the first failure is logged.
void ServiceReport::send(const std::string& assignments) {
  if (is_stopping_ || assignments.empty()) return;
  const core::Status sent = manager_.send(assignments);
  if (!sent && !has_failed_) spdlog::warn("{}", sent.error().message);
  has_failed_ = !sent;
}

void ServiceReport::report_until(const std::stop_token& stop) {
  const microseconds period = period_of(manager_);
  while (!stop.stop_requested()) {
    report_status();
    core::MutexLock lock(mutex_);
    changed_.wait_for(lock, stop, period, [] { return false; });
  }
}

void ServiceReport::report_status() {
  const auto status = get_status_();
  const core::MutexLock lock(mutex_);
  std::string assignments = status && manager_.watchdog() ? "WATCHDOG=1" : "";
  if (status && *status != status_) {
    assignments += (assignments.empty() ? "STATUS=" : "\nSTATUS=") + core::printable(*status);
    status_ = *status;
  }
  send(assignments);
}

}  // namespace tessera::common
