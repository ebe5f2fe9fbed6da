// SPDX-License-Identifier: Apache-2.0
#include "core/view/tile_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace tessera::view {
namespace {

using std::chrono::milliseconds;

// The first image is sent at a level of this many more before the wanted one.
constexpr int kCoarser = 3;
static_assert(kFirstJoinedLevel + kCoarser <= kMaxLevel);
constexpr std::size_t kChangesOfRound = 1024;
constexpr milliseconds kHeaderInterval{500};
constexpr milliseconds kRevisionInterval{1000};
constexpr milliseconds kKeepAliveInterval{15'000};
constexpr milliseconds kRetryInterval{500};
constexpr milliseconds kShortestWait{5};

bool touches(const core::PixelRect& a, const core::PixelRect& b) {
  return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

bool is_temporary(const core::Error& error) {
  return error.code == core::ErrorCode::kUnavailable;
}

}  // namespace

TileStream::TileStream(std::shared_ptr<TileSource> source, const StreamQuery& query,
                       const StreamSettings& settings)
    : source_(std::move(source)),
      query_(query),
      settings_(settings),
      share_(settings.budget, settings.now()),
      seen_(query.since),
      reported_(query.since) {}

void TileStream::find_grid() {
  if (grid_) return;
  grid_ = source_->grid();
  if (!grid_) return;
  const core::PixelRect seen = query_.region.value_or(grid_->window());
  queue_.emplace(*grid_, seen.x0 + seen.width() / 2, seen.y0 + seen.height() / 2);
}

bool TileStream::is_wanted(int tile) const {
  return tile >= 0 && tile < grid_->tile_count() &&
         (!query_.region || touches(grid_->rect(tile), *query_.region));
}

// Whether the job is over is asked first: everything is read then.
bool TileStream::poll(Clock::time_point now, std::string& out) {
  if (now < next_poll_) return true;
  next_poll_ = now + settings_.budget.poll_interval();
  const bool is_over = source_->is_over();
  if (is_over != is_over_) next_header_ = now;
  is_over_ = is_over;
  if (!poll_header(now, out)) return false;
  find_grid();
  return !grid_ || poll_changes();
}

bool TileStream::poll_header(Clock::time_point now, std::string& out) {
  if (now < next_header_) return true;
  next_header_ = now + kHeaderInterval;
  const auto header = source_->header();
  if (!header) return is_temporary(header.error());
  if (has_header_ && header->revision == header_) return true;
  has_header_ = true;
  header_ = header->revision;
  append_frame(out, fmt::format(R"({{"type":"job","job":{}}})", header->json));
  return true;
}

bool TileStream::poll_changes() {
  // Coarse tiles are so small that to read and send them twice takes longer than to send them at once.
  const bool with_coarse = is_first_poll_ && query_.since == 0 && query_.level < kFirstJoinedLevel;
  for (;;) {
    const auto changes = source_->changes_since(seen_, kChangesOfRound);
    if (!changes) {
      is_over_ = false;  // not everything is read
      return is_temporary(changes.error());
    }
    for (const TileChange& change : *changes) {
      seen_ = change.revision;
      if (is_wanted(change.tile)) queue_->add(change, with_coarse, is_first_poll_);
    }
    if (changes->size() < kChangesOfRound) break;
  }
  is_first_poll_ = false;
  return true;
}

bool TileStream::write_tiles(std::string& out, std::size_t max_bytes, Clock::time_point now) {
  JoinedTiles joined;
  const auto size = [&] { return out.size() + joined.size_bytes(); };
  bool continues = true;
  while (continues && queue_ && size() < max_bytes && now >= retry_at_) {
    const bool is_first = is_next_first();
    if (!share_.may_send(now, is_first)) break;
    const auto next = queue_->take(now);
    if (!next) break;
    const std::size_t before = size();
    continues = write_tile(*next, joined, out, now);
    share_.note_sent(size() - before, is_first);
  }
  joined.append_to(out);
  return continues;
}

bool TileStream::write_tile(const TileQueue::Next& next, JoinedTiles& joined, std::string& out,
                            Clock::time_point now) {
  const TileChange& change = next.change;
  const int level = next.is_coarse ? query_.level + kCoarser : query_.level;
  const core::PixelRect rect = grid_->rect(change.tile);
  const auto tile =
      settings_.tiles.get({source_->id(), change.tile, format_of_level(level), level, query_.layer},
                          change.revision, rect, [&] { return source_->read(change); });
  if (!tile) {
    if (!next.is_coarse) queue_->add(change, false, false);
    retry_at_ = now + kRetryInterval;
    return is_temporary(tile.error());
  }
  if (level < kFirstJoinedLevel) {
    joined.append_to(out);  // in the order of the queue
    append_tile(out, rect, level, **tile);
  } else {
    joined.add(out, rect, level, **tile);
  }
  if (!next.is_coarse) queue_->note_sent(change.tile, (*tile)->revision, now);
  return true;
}

void TileStream::write_revision(std::string& out, Clock::time_point now) {
  if (!queue_) return;
  const bool is_whole = !is_first_poll_ && queue_->has_sent_first();
  const bool is_newly_whole = is_whole && !reported_whole_;
  if (!is_newly_whole && !queue_->is_empty() && now < next_revision_) return;
  next_revision_ = now + kRevisionInterval;
  const Revision complete = queue_->complete_until(seen_);
  if (!is_newly_whole && complete <= reported_) return;
  reported_ = complete;
  reported_whole_ = is_whole;
  append_frame(out, fmt::format(R"({{"type":"revision","revision":{},"whole":{}}})", complete, is_whole));
}

http::BodySource::State TileStream::read(std::string& out, std::size_t max_bytes) {
  const Clock::time_point now = settings_.now();
  if (last_written_ == Clock::time_point{}) last_written_ = now;
  if (!poll(now, out) || !write_tiles(out, max_bytes, now)) return State::kFailed;
  write_revision(out, now);
  if (is_over_ && (!queue_ || queue_->is_empty())) {
    append_frame(out, R"({"type":"end"})");
    return State::kEnd;
  }
  if (out.empty() && now >= last_written_ + kKeepAliveInterval) append_frame(out, R"({"type":"keepalive"})");
  if (!out.empty()) {
    last_written_ = now;
    return State::kMore;
  }
  wait_ = time_until_next(now);
  return State::kWait;
}

milliseconds TileStream::time_until_next(Clock::time_point now) const {
  Clock::time_point next = std::min(next_poll_, last_written_ + kKeepAliveInterval);
  if (queue_) {
    const auto tile = queue_->next_time();
    if (tile) next = std::min(next, std::max({*tile, share_.next_time(is_next_first()), retry_at_}));
  }
  return std::max(std::chrono::ceil<milliseconds>(settings_.budget.joint_time(next) - now), kShortestWait);
}

}  // namespace tessera::view
