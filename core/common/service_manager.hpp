// SPDX-License-Identifier: Apache-2.0
// Tells the service manager that started this process how it does, by the protocol of sd_notify(3): datagrams
// to the socket that NOTIFY_SOCKET names. Without a manager nothing is sent. Thread-safe.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "core/base/error.hpp"
#include "core/base/mutex.hpp"

namespace tessera::common {

class ServiceManager {
 public:
  // Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID.
  static ServiceManager from_environment();

  bool is_present() const { return !socket_.empty(); }
  // The longest time between two signs of life (WATCHDOG=1). Empty: none are expected of this process.
  std::optional<std::chrono::microseconds> watchdog() const { return watchdog_; }
  // Sends assignments such as "READY=1\nSTATUS=idle". Waits for at most some seconds. UNAVAILABLE if the
  // manager does not take them.
  core::Status send(std::string_view assignments) const;

 private:
  std::string socket_;  // a path, or '@' and an abstract name; empty: no manager
  std::optional<std::chrono::microseconds> watchdog_;
};

// Reports to the manager from its construction, when the process is ready, to its stop. A thread sends the
// status when it has changed, and signs of life.
class ServiceReport {
 public:
  // One line for people, or nothing if the process does not work any more and should be restarted. It is
  // called by the thread: while it hangs, there is no sign of life.
  using GetStatus = std::function<std::optional<std::string>()>;

  explicit ServiceReport(GetStatus get_status,
                         const ServiceManager& manager = ServiceManager::from_environment());
  // Calls stopping(), and waits for a call of `get_status` in progress.
  ~ServiceReport();
  ServiceReport(const ServiceReport&) = delete;
  ServiceReport& operator=(const ServiceReport&) = delete;

  // The process reads its configuration again, and has done so.
  void reloading();
  void reloaded();
  // The process begins to stop. Nothing is sent afterwards. Can be called again.
  void stopping();

 private:
  void send(const std::string& assignments) TESSERA_REQUIRES(mutex_);
  void report_until(const std::stop_token& stop);
  void report_status();

  const GetStatus get_status_;
  const ServiceManager manager_;
  core::Mutex mutex_;
  std::condition_variable_any changed_;
  bool is_stopping_ TESSERA_GUARDED_BY(mutex_) = false;
  bool has_failed_ TESSERA_GUARDED_BY(mutex_) = false;
  std::string status_ TESSERA_GUARDED_BY(mutex_);  // as last sent
  std::jthread thread_;
};

}  // namespace tessera::common
