// SPDX-License-Identifier: Apache-2.0
#include "worker/upload_quota.hpp"

namespace tessera::worker {

core::Result<UploadQuota::Upload> UploadQuota::begin(const std::string& machine, const v1::PeerTicket& ticket,
                                                     std::uint64_t now_seconds) {
  const auto refuse = [](const char* why) { return core::fail(core::ErrorCode::kResourceExhausted, why); };
  const core::MutexLock lock(mutex_);
  while (!uses_.empty() && std::get<0>(uses_.begin()->first) < now_seconds) uses_.erase(uses_.begin());
  const TicketUse use{ticket.expires_seconds(), ticket.signature(), machine};
  const auto used = uses_.find(use);
  if (used != uses_.end() && used->second >= kMaxTicketUses) return refuse("the ticket is used up");
  if (used == uses_.end() && uses_.size() >= kMaxTickets) return refuse("too many tickets are in use");
  const auto of_machine = uploads_of_machine_.find(machine);
  const bool has_many = of_machine != uploads_of_machine_.end() && of_machine->second >= kMaxMachineUploads;
  if (uploads_ >= kMaxUploads || has_many) return refuse("too many segments are being sent");
  ++uses_[use];
  ++uploads_of_machine_[machine];
  ++uploads_;
  return Upload(*this, machine);
}

void UploadQuota::end(const std::string& machine) {
  const core::MutexLock lock(mutex_);
  --uploads_;
  const auto of_machine = uploads_of_machine_.find(machine);
  if (--of_machine->second == 0) uploads_of_machine_.erase(of_machine);
}

}  // namespace tessera::worker
