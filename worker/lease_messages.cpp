// SPDX-License-Identifier: Apache-2.0
#include "worker/lease_messages.hpp"

#include <fmt/format.h>
#include <google/protobuf/util/time_util.h>

#include <algorithm>

#include "core/common/log.hpp"

namespace tessera::worker {
namespace {

// An upper bound on any coordinator's lease time.
constexpr std::chrono::seconds kLongestLeaseTime{3600};
constexpr int kMaxItems = 1024;

}  // namespace

v1::Lease to_proto(const HeldLease& lease) {
  v1::Lease message;
  message.set_id(lease.id());
  message.set_job_id(lease.job_id());
  message.set_token(lease.token());
  for (const WorkItem& item : lease.items()) *message.add_items() = proto::to_proto(item);
  return message;
}

v1::Rendering to_proto(const Piece& piece) {
  v1::Rendering message;
  message.set_lease_id(piece.lease_id);
  message.set_job_id(piece.job->id);
  *message.mutable_item() = proto::to_proto(piece.item);
  return message;
}

Duration heartbeat_timeout(const v1::SynchronizeResponse& response) {
  using google::protobuf::util::TimeUtil;
  const std::int64_t told_s = TimeUtil::DurationToSeconds(response.heartbeat_timeout());
  if (told_s >= kLongestLeaseTime.count()) return kLongestLeaseTime;
  return std::chrono::milliseconds(
      std::max<std::int64_t>(TimeUtil::DurationToMilliseconds(response.heartbeat_timeout()), 0));
}

std::span<const v1::Lease* const> first_leases(const google::protobuf::RepeatedPtrField<v1::Lease>& leases) {
  return {leases.data(), static_cast<std::size_t>(std::min(leases.size(), kMaxLeases))};
}

std::vector<WorkItem> readable_items(const v1::Lease& lease, const v1::JobSpec& job) {
  const v1::RenderSettings& settings = job.settings();
  const auto images = static_cast<std::uint32_t>(std::max(job.images_size(), 1));
  std::vector<WorkItem> items;
  int left_out = std::max(lease.items_size() - kMaxItems, 0);
  for (int i = 0; i < std::min(lease.items_size(), kMaxItems); ++i) {
    const v1::WorkItem& message = lease.items(i);
    const auto item = proto::from_proto(message);
    const bool inside = item && item->image < images && message.rect().x1() <= settings.width_px() &&
                        message.rect().y1() <= settings.height_px() && item->rect.width() <= core::kTilePx &&
                        item->rect.height() <= core::kTilePx;
    if (inside)
      items.push_back(*item);
    else
      ++left_out;
  }
  if (left_out > 0)
    common::log(
        spdlog::level::warn,
        fmt::format("{} items of lease {} are left out: job {} does not have their image, pixels or samples, "
                    "or they are more than a tile, or there are more than {}",
                    left_out, lease.id(), lease.job_id(), kMaxItems),
        {.job = lease.job_id()});
  return items;
}

}  // namespace tessera::worker
