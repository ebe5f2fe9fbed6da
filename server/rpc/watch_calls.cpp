// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/watch_calls.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <utility>

#include "proto/convert.hpp"
#include "server/jobs/image_choice.hpp"

namespace tessera::rpc {

namespace {

// Of one message, whose last tile may exceed it.
constexpr std::size_t kTileBytesAtOnce = 256 << 10;

}  // namespace

core::Result<WatchStream::Step> WatchJobCall::next() {
  auto job = coordinator().jobs().get_without_bundle(request_.job_id());
  if (!job) return core::fail(job.error());
  Step step;
  step.is_last = watch::is_final(job->state());
  std::string bytes = job->SerializeAsString();
  if (bytes == last_sent_) return step;
  last_sent_ = std::move(bytes);
  *response_.mutable_job() = std::move(*job);
  step.message = &response_;
  return step;
}

core::Result<WatchStream::Step> WatchFarmCall::next() {
  const bool is_first = !update_;
  const events::Cursor cursor = is_first ? watch::from_token(request_.resume_token()) : update_->next;
  watch::FarmFeed& feed = coordinator().farm_feed();
  auto update = feed.after(cursor);
  if (!update) return core::fail(update.error());
  Step step;
  const bool is_current = (*update)->message.is_current();
  step.has_more = !is_current || feed.has_changes_after((*update)->next);
  if (is_current && step.has_more) step.pause = WatchHub::kShortestRound;
  if ((*update)->is_empty() && !is_first) return step;
  update_ = *std::move(update);
  step.message = &update_->message;
  return step;
}

core::Result<WatchStream::Step> WatchTilesCall::next() {
  if (!has_sent_) since_ = request_.since_revision();
  if (auto known = jobs::check_channels(request_.channels()); !known) return core::fail(known.error());
  watch::TileQuery query{request_.job_id(), since_,          request_.format(), {},
                         kTileBytesAtOnce,  request_.image()};
  const auto layer = view::parse_layer(request_.layer());
  if (!layer) return core::fail(layer.error());
  query.layer = *layer;
  if (request_.has_region()) {
    const auto region = proto::from_proto(request_.region());
    if (!region) return core::fail(region.error());
    query.region = *region;
  }
  auto update = coordinator().tile_feed().update(query);
  if (!update) return core::fail(update.error());
  Step step;
  step.has_more = !update->is_current;
  step.is_last = update->is_current && watch::is_final(update->job.state());
  const bool has_new_state = std::exchange(last_state_, update->job.state()) != update->job.state();
  if (has_sent_ && !has_new_state && update->tiles.empty() && !step.is_last) {
    since_ = update->revision;
    return step;
  }
  response_.Clear();
  std::size_t bytes = 0;
  for (v1::TileImage& tile : update->tiles) {
    bytes += tile.pixels_zlib().size();
    *response_.add_tiles() = std::move(tile);
  }
  if (bytes > 0) response_.mutable_channels()->Add(update->channels.begin(), update->channels.end());
  since_ = update->revision;
  if (update->is_current) response_.set_revision(since_);
  if (!has_sent_ || has_new_state) *response_.mutable_job() = std::move(update->job);
  has_sent_ = true;
  step.message = &response_;
  step.pause = pause_after(bytes);
  return step;
}

WatchedStream::Clock::duration WatchTilesCall::pause_after(std::size_t bytes) const {
  if (request_.max_bytes_per_second() == 0) return {};
  const std::chrono::duration<double> pause(static_cast<double>(bytes) /
                                            static_cast<double>(request_.max_bytes_per_second()));
  // A rate of nearly nothing is no reason to overflow.
  return std::chrono::duration_cast<Clock::duration>(
      std::min<std::chrono::duration<double>>(pause, std::chrono::hours(1)));
}

}  // namespace tessera::rpc
