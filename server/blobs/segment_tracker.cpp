// SPDX-License-Identifier: Apache-2.0
#include "server/blobs/segment_tracker.hpp"

#include <algorithm>
#include <functional>
#include <utility>

namespace tessera::blobs {

namespace {

// A download from another worker that has not ended by then does not count any more.
constexpr std::chrono::seconds kMaxDownloadTime{60};
constexpr std::chrono::minutes kForgetEvery{1};

}  // namespace

void SegmentTracker::Sending::end(const std::optional<Sha256>& sha256) {
  if (tracker_ != nullptr) std::exchange(tracker_, nullptr)->end(*this, sha256);
}

SegmentTracker::Source SegmentTracker::choose(const Ask& ask, Time now) {
  const core::MutexLock lock(mutex_);
  forget_workers(now);
  Worker& worker = note_worker(ask, now);
  Blob& blob = note_blob(ask);
  const Holders holders = reachable_holders(blob, ask);
  const auto unsent = next_to_send(blob, ask, holders, now);
  // What is sent to a worker that serves nobody must be sent again to the next one.
  if (unsent && ask.endpoint) return send(blob, ask, *unsent, now);
  if (auto peer = choose_peer(blob, ask, holders, now)) {
    worker.waiting_since.reset();
    worker.download = Download{ask.blob, peer->index, peer->worker_id};
    return *std::move(peer);
  }
  if (unsent) return send(blob, ask, *unsent, now);
  if (!worker.waiting_since) worker.waiting_since = now;
  if (now - *worker.waiting_since < kPatience) return Later{kAskAgainAfter};
  std::uint64_t missing = 0;
  while (ask.held.contains(missing)) ++missing;
  return send(blob, ask, missing, now);
}

void SegmentTracker::forget(const proto::Digest& blob) {
  const core::MutexLock lock(mutex_);
  if (blobs_.contains(blob)) forget_blob(blob);
}

SegmentTracker::Worker& SegmentTracker::note_worker(const Ask& ask, Time now) {
  Worker& worker = workers_[ask.worker_id];
  worker.endpoint = ask.endpoint;
  worker.is_on_loopback = ask.is_on_loopback;
  worker.last_heard = now;
  end_download(ask, worker);
  return worker;
}

// A worker asks again when it has what it was told to fetch. If it failed to, it asks for the same blob, and
// says what it has of it.
void SegmentTracker::end_download(const Ask& ask, Worker& worker) {
  if (!worker.download) return;
  const Download download = *std::exchange(worker.download, std::nullopt);
  if (const auto source = workers_.find(download.from); source != workers_.end())
    source->second.uploads.erase(ask.worker_id);
  const auto blob = blobs_.find(download.blob);
  if (blob == blobs_.end() || download.blob == ask.blob || !worker.endpoint) return;
  const auto known = blob->second.holders.find(ask.worker_id);
  proto::SegmentSet held =
      known != blob->second.holders.end() ? known->second : proto::SegmentSet(blob->second.segments.size());
  held.insert(download.index);
  note_holder(blob->second, ask.worker_id, held);
}

SegmentTracker::Blob& SegmentTracker::note_blob(const Ask& ask) {
  auto known = blobs_.find(ask.blob);
  if (known == blobs_.end()) {
    const auto count = static_cast<std::size_t>(ask.held.count());
    while (!recency_.empty() && (blobs_.size() >= bounds_.blobs || segments_ + count > bounds_.segments))
      forget_blob(recency_.back());
    known = blobs_.try_emplace(ask.blob).first;
    known->second.segments.resize(count);
    if (count == 1) known->second.segments[0].sha256 = ask.blob.sha256;
    known->second.recency = recency_.insert(recency_.begin(), ask.blob);
    segments_ += count;
  }
  Blob& blob = known->second;
  recency_.splice(recency_.begin(), recency_, blob.recency);
  blob.holders.erase(ask.worker_id);
  if (ask.endpoint && !ask.held.is_empty()) note_holder(blob, ask.worker_id, ask.held);
  return blob;
}

void SegmentTracker::note_holder(Blob& blob, const std::string& worker_id, const proto::SegmentSet& held) {
  if (blob.holders.size() < bounds_.holders_of_a_blob || blob.holders.contains(worker_id))
    blob.holders.insert_or_assign(worker_id, held);
}

void SegmentTracker::forget_blob(const proto::Digest& digest) {
  const auto blob = blobs_.find(digest);
  segments_ -= blob->second.segments.size();
  recency_.erase(blob->second.recency);
  blobs_.erase(blob);
}

void SegmentTracker::forget_workers(Time now) {
  const bool is_full = workers_.size() >= bounds_.workers;
  if (!is_full && now - last_forgotten_ < kForgetEvery) return;
  last_forgotten_ = now;
  std::erase_if(workers_, [&](const auto& entry) { return now - entry.second.last_heard > kForgetAfter; });
  if (workers_.size() < bounds_.workers) return;
  workers_.erase(std::min_element(workers_.begin(), workers_.end(), [](const auto& a, const auto& b) {
    return a.second.last_heard < b.second.last_heard;
  }));
}

SegmentTracker::Holders SegmentTracker::reachable_holders(const Blob& blob, const Ask& ask) const {
  Holders holders;
  for (const auto& [worker_id, held] : blob.holders) {
    const auto worker = workers_.find(worker_id);
    if (worker == workers_.end() || !worker->second.endpoint) continue;
    if (worker_id == ask.worker_id || ask.excluded.contains(worker_id)) continue;
    if (worker->second.is_on_loopback && !ask.is_on_loopback) continue;
    holders.emplace_back(&worker_id, &held);
  }
  return holders;
}

// The first segment that the caller lacks and will not get from others: nobody has it, or it was not sent
// since the start of the coordinator, so that its SHA-256 is not known.
std::optional<std::uint64_t> SegmentTracker::next_to_send(const Blob& blob, const Ask& ask,
                                                          const Holders& holders, Time now) const {
  if (blob.sends >= kMaxSends) return std::nullopt;
  for (std::uint64_t i = 0; i < blob.segments.size(); ++i) {
    const Segment& segment = blob.segments[i];
    if (ask.held.contains(i)) continue;
    if (segment.sends > 0 && now - segment.sending_since < kPatience) continue;
    const auto has_it = [&](const auto& holder) { return holder.second->contains(i); };
    if (!segment.sha256 || std::none_of(holders.begin(), holders.end(), has_it)) return i;
  }
  return std::nullopt;
}

// The least busy worker that has something. Callers begin at different segments, so that they soon have what
// others lack.
std::optional<SegmentTracker::Peer> SegmentTracker::choose_peer(const Blob& blob, const Ask& ask,
                                                                const Holders& holders, Time now) {
  const std::uint64_t count = blob.segments.size();
  const std::uint64_t start = std::hash<std::string>{}(ask.worker_id) % count;
  const auto first_of = [&](const proto::SegmentSet& held) -> std::optional<std::uint64_t> {
    for (std::uint64_t step = 0; step < count; ++step) {
      const std::uint64_t i = (start + step) % count;
      if (held.contains(i) && !ask.held.contains(i) && blob.segments[i].sha256) return i;
    }
    return std::nullopt;
  };
  std::optional<Peer> best;
  std::size_t fewest = kMaxUploads;
  for (const auto& [worker_id, held] : holders) {
    const std::size_t uploads = uploads_of(*worker_id, now);
    if (uploads >= fewest) continue;
    const auto index = first_of(*held);
    if (!index) continue;
    fewest = uploads;
    best = Peer{*index, *worker_id, *workers_.at(*worker_id).endpoint, *blob.segments[*index].sha256};
  }
  if (best) workers_.at(best->worker_id).uploads[ask.worker_id] = now;
  return best;
}

std::size_t SegmentTracker::uploads_of(const std::string& worker_id, Time now) {
  auto& uploads = workers_.at(worker_id).uploads;
  std::erase_if(uploads, [&](const auto& upload) { return now - upload.second > kMaxDownloadTime; });
  return uploads.size();
}

SegmentTracker::Sending SegmentTracker::send(Blob& blob, const Ask& ask, std::uint64_t index, Time now) {
  workers_.at(ask.worker_id).waiting_since.reset();
  if (ask.endpoint) {
    ++blob.sends;
    ++blob.segments[index].sends;
    blob.segments[index].sending_since = now;
  }
  return Sending(*this, ask.blob, index, ask.worker_id, ask.endpoint.has_value());
}

void SegmentTracker::end(const Sending& sending, const std::optional<Sha256>& sha256) {
  const core::MutexLock lock(mutex_);
  const auto known = blobs_.find(sending.blob_);
  if (known == blobs_.end()) return;
  Blob& blob = known->second;
  Segment& segment = blob.segments[sending.index_];
  if (sha256 && !segment.sha256) segment.sha256 = sha256;
  if (!sending.serves_) return;
  // The blob may have been forgotten and noted again meanwhile.
  if (blob.sends > 0) --blob.sends;
  if (segment.sends > 0) --segment.sends;
  if (!sha256) return;
  const auto holder = blob.holders.find(sending.worker_id_);
  proto::SegmentSet held =
      holder != blob.holders.end() ? holder->second : proto::SegmentSet(blob.segments.size());
  held.insert(sending.index_);
  note_holder(blob, sending.worker_id_, held);
}

}  // namespace tessera::blobs
