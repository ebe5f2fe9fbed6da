// SPDX-License-Identifier: Apache-2.0
// A coordinator to be fed: on a clock of its own, with jobs that are begun, in a folder in memory. Each Farm
// begins alike, so that what an input does depends on that input alone.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/film/film.hpp"
#include "server/coordinator.hpp"
#include "tests/fuzz/expect.hpp"

namespace tessera::fuzz {

// What inputs may write instead of an id of 32 digits: one of them.
std::string id_of(const std::string& text);

// The job's tile with samples that are a function of nothing but their number.
core::FilmTile tile_of(const core::PixelRect& rect, core::SampleRange range);

class Farm {
 public:
  // Jobs "a" (running, 130 x 4 pixels in three tiles, 6 samples per pixel, begun), "b" (paused) and "c"
  // (done). `damage` may change the state folder before a coordinator opens it.
  using Damage = std::function<void(const std::filesystem::path& folder)>;
  explicit Farm(jobs::SceneCheck check_scene = nullptr, const Damage& damage = nullptr);
  ~Farm();

  // False where the state folder was refused; there is no coordinator then.
  bool is_open() const { return coordinator_ != nullptr; }
  server::Coordinator& coordinator() { return *coordinator_; }

  // Ends the coordinator and opens the folder again.
  void reopen();
  // Adds the tokens that a worker would have, where there are none: inputs cannot guess them.
  void sign(v1::SubmitResultRequest& request) const;
  void sign(v1::SynchronizeRequest& request) const;
  // Lets time pass, and the coordinator do what is due.
  void wait(std::chrono::milliseconds time);
  // Answers that come later are looked at as well.
  void synchronize(const v1::SynchronizeRequest& request);
  // A worker with this id, which asks for work.
  void greet(char worker);

 private:
  jobs::SceneCheck check_scene_;
  scheduler::Time now_{std::chrono::hours(1)};
  std::optional<dispatch::LeaseSigner> signer_;
  std::unique_ptr<server::Coordinator> coordinator_;
};

// That it can be read again by whoever gets it: texts are UTF-8.
template <typename Message>
void expect_sendable(const Message& message) {
  Message again;
  expect(again.ParseFromString(message.SerializeAsString()), "a message can be read again");
}

// A refusal may quote what the caller has said, as it was said.
template <typename T>
bool expect_told(const core::Result<T>& answer) {
  if (answer) return true;
  expect(!answer.error().message.empty(), "an error says what is wrong");
  v1::Job told;
  told.set_failure(answer.error().message);
  expect_sendable(told);
  return false;
}

template <typename Message>
void expect_sendable(const core::Result<Message>& answer) {
  if (expect_told(answer)) expect_sendable(*answer);
}

// The jobs of a farm, the newest ones if they are many.
inline std::vector<v1::Job> listed(Farm& farm) {
  const auto page = farm.coordinator().jobs().list();
  if (!expect_told(page)) return {};
  return {page->jobs().begin(), page->jobs().end()};
}

}  // namespace tessera::fuzz
