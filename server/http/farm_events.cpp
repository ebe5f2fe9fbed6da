// SPDX-License-Identifier: Apache-2.0
#include "server/http/farm_events.hpp"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <vector>

#include "proto/json.hpp"
#include "server/http/answers.hpp"
#include "server/http/call.hpp"
#include "server/http/watch_quota.hpp"

namespace tessera::http_api {

namespace {

constexpr std::size_t kKeptTexts = 8;
constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

template <typename Messages>
Json list_of(const Messages& messages) {
  Json list = Json::array();
  for (const auto& message : messages) list.push_back(proto::to_json(message));
  return list;
}

template <typename Ids>
Json ids_of(const Ids& ids) {
  return Json(std::vector<std::string>(ids.begin(), ids.end()));
}

// Sends what changes, at most ten times a second (WatchHub). It is asked for more only when the client has
// taken what was sent before: a slow client gets fewer and newer events.
class FarmEvents final : public http::BodySource, private rpc::Watcher {
 public:
  FarmEvents(CallPtr call, base::FairShare::Held place, events::Cursor cursor)
      : call_(std::move(call)), place_(std::move(place)), cursor_(cursor) {}
  ~FarmEvents() override {
    if (wake_) call_->services().watches.remove(*this);
  }

  void start(http::Wake wake) override {
    wake_ = std::move(wake);
    call_->services().watches.add(*this);
  }
  // Only a change makes it look for more, so that all clients that keep up are sent the same.
  State read(std::string& out, std::size_t) override {
    if (is_closed_) return State::kEnd;
    State state = State::kWait;
    if (is_due_.exchange(false)) state = append_update(out);
    if (state == State::kMore) is_due_ = true;
    if (out.empty() && state == State::kWait && Clock::now() - last_sent_ >= kKeepAlive) out += ":\n\n";
    if (!out.empty()) last_sent_ = Clock::now();
    call_->services().streams.calls.traffic.watched_sent += out.size();
    return state;
  }
  // A keep-alive is due between two waits.
  std::chrono::milliseconds longest_wait() const override { return kKeepAlive; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kKeepAlive{15};

  State append_update(std::string& out) {
    watch::FarmFeed& feed = call_->coordinator().farm_feed();
    const auto update = feed.after(cursor_);
    if (!update) return State::kEnd;  // the client connects again
    cursor_ = (*update)->next;
    if (!(*update)->is_empty()) out += *call_->context.event_texts.of(*update);
    if (!(*update)->message.is_current()) return State::kMore;
    if (feed.has_changes_after(cursor_)) {
      is_behind_ = true;
      call_->services().watches.request_round();
    }
    return State::kWait;
  }
  const std::string& job_id() const override { return everything_; }
  bool notify(bool changed) override {
    if (is_behind_.exchange(false) || changed) {
      is_due_ = true;
      wake_();
    }
    return false;
  }
  void close() override {
    is_closed_ = true;
    wake_();
  }

  const CallPtr call_;
  const base::FairShare::Held place_;
  const std::string everything_;
  events::Cursor cursor_;
  http::Wake wake_;  // set once, before it is notified
  // Whether to look for changes now, or in the next round.
  std::atomic<bool> is_due_{true}, is_behind_{false};
  std::atomic<bool> is_closed_{false};
  Clock::time_point last_sent_ = Clock::now();
};

}  // namespace

std::shared_ptr<const std::string> EventTexts::of(const std::shared_ptr<const watch::FarmUpdate>& update) {
  const core::MutexLock lock(mutex_);
  for (const auto& [known, text] : last_)
    if (known == update) return text;
  auto text = std::make_shared<const std::string>(to_events(*update));
  last_.emplace_front(update, text);
  if (last_.size() > kKeptTexts) last_.pop_back();
  return text;
}

std::string to_events(const watch::FarmUpdate& update) {
  const v1::WatchFarmResponse& message = update.message;
  std::vector<std::pair<const char*, Json>> events;
  if (message.reset()) events.emplace_back("reset", Json::object());
  if (!message.jobs().empty()) events.emplace_back("jobs", Json{{"jobs", list_of(message.jobs())}});
  if (!message.workers().empty())
    events.emplace_back("workers", Json{{"workers", list_of(message.workers())}});
  if (!message.deleted_job_ids().empty() || !message.removed_worker_ids().empty())
    events.emplace_back("removed", Json{{"jobs", ids_of(message.deleted_job_ids())},
                                        {"workers", ids_of(message.removed_worker_ids())}});
  std::string text;
  for (std::size_t i = 0; i < events.size(); ++i) {
    if (i + 1 == events.size()) text += "id: " + encode_token(message.resume_token()) + "\n";
    text += fmt::format("event: {}\ndata: {}\n\n", events[i].first, proto::to_line(events[i].second));
  }
  return text;
}

std::string encode_token(const std::string& token) {
  std::string text;
  unsigned bits = 0;
  int count = 0;
  for (const char c : token) {
    bits = bits << 8 | static_cast<unsigned char>(c);
    for (count += 8; count >= 6; count -= 6) text += kLetters[bits >> (count - 6) & 63];
  }
  if (count > 0) text += kLetters[bits << (6 - count) & 63];
  return text;
}

std::string decode_token(const std::string& text) {
  std::string token;
  unsigned bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::size_t value = kLetters.find(c);
    if (value == std::string_view::npos) return {};
    bits = bits << 6 | static_cast<unsigned>(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    token += static_cast<char>(bits >> count & 255);
  }
  return token;
}

// Last-Event-ID is what EventSource sends when it connects again.
core::Result<http::Response> watch_farm(const CallPtr& call) {
  auto place = take_watch(*call);
  if (!place) return core::fail(place.error());
  const std::string token = decode_token(call->request.header("last-event-id"));
  http::Response response{.headers = {{"Content-Type", "text/event-stream"},
                                      {"Cache-Control", "no-store"},
                                      {"X-Accel-Buffering", "no"}}};  // nginx passes events on at once
  response.source = std::make_unique<FarmEvents>(call, *std::move(place), watch::from_token(token));
  return response;
}

}  // namespace tessera::http_api
