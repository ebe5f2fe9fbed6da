// SPDX-License-Identifier: Apache-2.0
// What lines of a coordinator's log are about: lines that a caller has caused name the caller.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "core/common/log.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using common::LogFields;

const farm::WorkerPrincipal kAda{.name = "ada", .individual = true, .origin = "ada", .peer = "10.0.0.5"};
const std::string kWorker(32, 'a');

class LogFieldsOf : public ScriptedFarm {
 protected:
  // What a line must name.
  struct Row {
    std::string text;  // in the message
    bool has_job = false, has_worker = true;
    std::function<void()> happen;
  };

  // The lines that are logged meanwhile.
  static std::vector<nlohmann::json> logged(const std::function<void()>& meanwhile) {
    testing::internal::CaptureStderr();
    common::log_to_stderr("test", {.format = common::LogFormat::kJson});
    meanwhile();
    common::flush_log();
    std::istringstream text(testing::internal::GetCapturedStderr());
    std::vector<nlohmann::json> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(nlohmann::json::parse(line));
    return lines;
  }
  static std::optional<LogFields> find(const std::vector<nlohmann::json>& lines, const std::string& text) {
    for (const nlohmann::json& line : lines)
      if (line.at("message").get<std::string>().find(text) != std::string::npos)
        return LogFields{.job = line.value("job", ""),
                         .worker = line.value("worker", ""),
                         .principal = line.value("principal", ""),
                         .peer = line.value("peer", "")};
    return std::nullopt;
  }

  // A job that was submitted by Ada.
  void submit_as_ada() {
    const auto job = coordinator().jobs().submit(submission(), kAda.name, kAda.peer);
    ASSERT_TRUE(job) << job.error().message;
    job_ = job->id();
    coordinator().jobs().validate(job_);
  }
  // A result of a worker that has registered and has a lease.
  v1::SubmitResultRequest result() {
    const v1::Lease lease = synchronize(greeting('a'), kAda).leases(0);
    job_ = lease.job_id();
    return delivery('a', lease);
  }
  void expect_rejected(const v1::SubmitResultRequest& result) {
    EXPECT_FALSE(coordinator().dispatcher().submit_result(result, kAda));
  }
  v1::SubmitResultRequest damaged_result() {
    v1::SubmitResultRequest damaged = result();
    damaged.mutable_items(0)->set_sums_xxh3(damaged.items(0).sums_xxh3() ^ 1);
    return damaged;
  }
  void reject_a_forged_token() {
    v1::SubmitResultRequest forged = result();
    forged.set_lease_token("forged");
    expect_rejected(forged);
  }
  void reject_other_bits() {
    v1::SubmitResultRequest other = result();
    other.set_determinism_fingerprint("beef");
    expect_rejected(other);
  }
  void reject_of_an_earlier_run() {
    const v1::SubmitResultRequest damaged = damaged_result();
    open();
    expect_rejected(damaged);
  }
  void quarantine() {
    const v1::SubmitResultRequest damaged = damaged_result();
    for (int i = 0; i < farm::Quarantine::kRejectionsUntilQuarantine; ++i) expect_rejected(damaged);
  }
  void refuse_other_bits() {
    v1::SynchronizeRequest other = greeting('a');
    other.set_determinism_fingerprint("beef");
    const WaitingCall call(coordinator(), other, kAda);
    EXPECT_TRUE(call.answered() && !call.answer());
  }
  void lose() {
    synchronize(greeting('a'), kAda);
    now_ += std::chrono::seconds(20);
    for (int tick = 0; tick < 4; ++tick) coordinator().dispatcher().tick();
  }

  std::string job_;  // that the line is about, if it is about one
};

TEST_F(LogFieldsOf, LinesThatACallerHasCausedNameTheCaller) {
  const Row rows[] = {
      {" submitted", true, false, [&] { submit_as_ada(); }},
      {" registered", false, true, [&] { result(); }},
      {" is lost", false, true, [&] { lose(); }},
      {" is quarantined: ", false, true, [&] { quarantine(); }},
      {"rejected a result of worker host-a", true, true, [&] { expect_rejected(damaged_result()); }},
      {"its token does not prove", true, true, [&] { reject_a_forged_token(); }},
      {"its fingerprint is beef, the job's", true, true, [&] { reject_other_bits(); }},
      {"which has not registered since", true, true, [&] { reject_of_an_earlier_run(); }},
      {"refused: worker host-a", false, true, [&] { refuse_other_bits(); }},
  };
  submit();
  for (const Row& row : rows) {
    SCOPED_TRACE(row.text);
    open(folder_.path() / "state");  // one that has logged no rejection yet
    const auto named = find(logged(row.happen), row.text);
    ASSERT_TRUE(named) << "it is not logged";
    EXPECT_EQ(named->job, row.has_job ? job_ : "");
    EXPECT_EQ(named->worker, row.has_worker ? kWorker : "");
    EXPECT_EQ(named->principal, kAda.name);
    EXPECT_EQ(named->peer, kAda.peer);
    now_ += std::chrono::minutes(1);
  }
}

// A line that others can cause is one in ten seconds, whoever causes it.
TEST_F(LogFieldsOf, RejectionsDoNotFillTheLog) {
  submit();
  constexpr int kRejections = 1000;
  const v1::SubmitResultRequest honest = result();
  open();
  const auto lines = logged([&] {
    for (int i = 0; i < kRejections; ++i) {
      v1::SubmitResultRequest forged = honest;  // its worker is unknown, and so is its lease
      forged.set_worker_id(fmt::format("{:032x}", i));
      EXPECT_FALSE(coordinator().dispatcher().submit_result(forged, kAda));
      v1::SynchronizeRequest other = greeting('a');
      other.set_worker_id(fmt::format("{:032x}", i));
      other.set_determinism_fingerprint("beef");
      const WaitingCall call(coordinator(), other, kAda);
      EXPECT_TRUE(call.answered() && !call.answer());
    }
    now_ += std::chrono::seconds(11);
    coordinator().dispatcher().tick();
  });
  std::vector<std::string> rejections;
  for (const nlohmann::json& line : lines)
    if (line.contains("peer")) rejections.push_back(line.at("message"));
  ASSERT_EQ(rejections.size(), 2u) << "the first one, and after ten seconds the last one";
  EXPECT_THAT(rejections.back(), testing::HasSubstr("(1999 such since the last line)"));
}

// The 150 workers of one caller register, deliver what is wrong, and are heard of no more.
TEST_F(LogFieldsOf, WorkersThatComeAndGoDoNotFillTheLog) {
  constexpr int kWorkers = 150, kMaxLines = static_cast<int>(farm::Logs::kMaxEvents);
  v1::SubmitJobRequest large = submission();
  large.mutable_overrides()->set_width_px(2048);
  large.mutable_overrides()->set_height_px(2048);
  submit(large);
  const auto lines = logged([&] {
    for (int i = 0; i < kWorkers; ++i) {
      v1::SynchronizeRequest greeting_of_one = greeting('a');
      greeting_of_one.set_worker_id(fmt::format("{:032x}", i));
      v1::SubmitResultRequest damaged = delivery('a', synchronize(greeting_of_one).leases(0));
      damaged.set_worker_id(greeting_of_one.worker_id());
      damaged.mutable_items(0)->set_sums_xxh3(damaged.items(0).sums_xxh3() ^ 1);
      for (int j = 0; j < farm::Quarantine::kRejectionsUntilQuarantine; ++j)
        EXPECT_FALSE(coordinator().dispatcher().submit_result(damaged));
    }
    now_ += std::chrono::seconds(11);
    for (int tick = 0; tick < kWorkers; ++tick) coordinator().dispatcher().tick();
    now_ += std::chrono::seconds(11);
    coordinator().dispatcher().tick();
  });
  for (const char* const what : {" registered", " is quarantined: ", " is lost"}) {
    const auto has = [&](const std::string& text) {
      return std::count_if(lines.begin(), lines.end(), [&](const nlohmann::json& line) {
        const auto message = line.at("message").get<std::string>();
        return message.find(what) != std::string::npos && message.find(text) != std::string::npos;
      });
    };
    EXPECT_EQ(has(""), kMaxLines + 1) << what;
    EXPECT_EQ(has(fmt::format("({} such since the last line)", kWorkers - kMaxLines)), 1) << what;
  }
}

}  // namespace
}  // namespace tessera::server
