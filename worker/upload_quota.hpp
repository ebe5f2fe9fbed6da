// SPDX-License-Identifier: Apache-2.0
// Bounds what other workers fetch from this one: the segments that are sent at a time, and how often a
// machine uses a ticket. So a machine gets no more bytes than the coordinator has granted to it, a few times
// over. Thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "core/base/error.hpp"
#include "core/base/mutex.hpp"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::worker {

class UploadQuota {
 public:
  // Segments that are sent at a time: to all, and to one machine, which leaves room for others.
  static constexpr unsigned kMaxUploads = 8, kMaxMachineUploads = 6;
  // By one machine. Several of its workers may have been given the same ticket within a second.
  static constexpr unsigned kMaxTicketUses = 16;
  // Valid tickets that are remembered, for less than 10 MB of memory: more than are used in a minute.
  static constexpr std::size_t kMaxTickets = 65'536;

  // An upload in progress.
  class Upload {
   public:
    Upload(UploadQuota& quota, std::string machine) : quota_(&quota), machine_(std::move(machine)) {}
    Upload(Upload&& other) noexcept
        : quota_(std::exchange(other.quota_, nullptr)), machine_(std::move(other.machine_)) {}
    Upload& operator=(Upload&&) = delete;
    ~Upload() {
      if (quota_ != nullptr) quota_->end(machine_);
    }

   private:
    UploadQuota* quota_;
    std::string machine_;
  };

  // Begins an upload to a machine, with a ticket that is valid now. RESOURCE_EXHAUSTED beyond the limits. The
  // quota must outlive the upload.
  core::Result<Upload> begin(const std::string& machine, const v1::PeerTicket& ticket,
                             std::uint64_t now_seconds);

 private:
  using TicketUse = std::tuple<std::uint64_t, std::string, std::string>;  // expiry, signature, machine

  void end(const std::string& machine);

  core::Mutex mutex_;
  unsigned uploads_ TESSERA_GUARDED_BY(mutex_) = 0;
  std::map<std::string, unsigned> uploads_of_machine_ TESSERA_GUARDED_BY(mutex_);  // without zeros
  std::map<TicketUse, unsigned> uses_ TESSERA_GUARDED_BY(mutex_);                  // of valid tickets
};

}  // namespace tessera::worker
