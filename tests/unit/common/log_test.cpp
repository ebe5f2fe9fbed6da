// SPDX-License-Identifier: Apache-2.0
#include "core/common/log.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>

#include <nlohmann/json.hpp>
#include <string>

namespace tessera::common {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::MatchesRegex;

// What `write` logs with these options.
template <typename Write>
std::string logged(const LogOptions& options, Write write) {
  testing::internal::CaptureStderr();
  log_to_stderr("tessera-test", options);
  write();
  flush_log();
  return testing::internal::GetCapturedStderr();
}

TEST(Log, IsWrittenInPrintableLines) {
  EXPECT_THAT(logged({}, [] { spdlog::warn("worker {} registered", "a\x1b[2J\n[forged]\xc2\x9b"); }),
              EndsWith("worker a\\x1b[2J\\x0a[forged]\\xc2\\x9b registered\n"));
}

TEST(Log, IsWrittenAsItIsOtherwiseWithTimesInUtc) {
  const std::string line = logged({}, [] { spdlog::info("Käse"); });
  EXPECT_THAT(line, HasSubstr(" info tessera-test: Käse\n"));
  EXPECT_THAT(line.substr(0, 25), MatchesRegex("....-..-..T..:..:..\\....Z "));
}

TEST(Log, IsAnObjectInEachLineWhereJsonIsWanted) {
  const std::string line =
      logged({.format = LogFormat::kJson}, [] { spdlog::error("\"quoted\" and a\\b\nc"); });
  const auto object = nlohmann::json::parse(line);
  EXPECT_EQ(object.at("level"), "error");
  EXPECT_EQ(object.at("program"), "tessera-test");
  EXPECT_EQ(object.at("message"), "\"quoted\" and a\\b\\x0ac");
  EXPECT_THAT(object.at("time").get<std::string>(), EndsWith("Z"));
}

// What is logged if stderr is the stream that JOURNAL_STREAM names.
template <typename Write>
std::string logged_to_journal(const LogOptions& options, Write write) {
  testing::internal::CaptureStderr();
  struct stat status {};
  EXPECT_EQ(fstat(STDERR_FILENO, &status), 0);
  setenv("JOURNAL_STREAM", (std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino)).c_str(), 1);
  log_to_stderr("tessera-test", options);
  unsetenv("JOURNAL_STREAM");
  write();
  flush_log();
  return testing::internal::GetCapturedStderr();
}

TEST(Log, HasPrioritiesForTheJournalWhichHasTimesAndNames) {
  EXPECT_EQ(logged_to_journal({.level = spdlog::level::debug},
                              [] {
                                spdlog::debug("a");
                                spdlog::info("b");
                                spdlog::warn("c");
                                spdlog::error("d");
                                log(spdlog::level::critical, "e", {.job = "7"});
                              }),
            "<7>a\n<6>b\n<4>c\n<3>d\n<2>e [job 7]\n");
}

TEST(Log, HasPrioritiesForTheJournalAlsoInJson) {
  const std::string line = logged_to_journal({.format = LogFormat::kJson}, [] { spdlog::warn("a"); });
  ASSERT_THAT(line, testing::StartsWith("<4>{"));
  EXPECT_EQ(nlohmann::json::parse(line.substr(3)).at("message"), "a");
}

TEST(Log, IsForTheJournalOnlyIfStderrIsThatStream) {
  setenv("JOURNAL_STREAM", "1:2", 1);
  const std::string line = logged({}, [] { spdlog::warn("a"); });
  unsetenv("JOURNAL_STREAM");
  EXPECT_THAT(line, EndsWith(" warning tessera-test: a\n"));
}

TEST(Log, HasFieldsInJson) {
  const std::string line = logged({.format = LogFormat::kJson}, [] {
    log(spdlog::level::warn, "job 7 failed",
        {.job = "7", .worker = "w\n", .principal = "\x1e\x1f\"ada", .peer = "10.0.0.1"});
  });
  const auto object = nlohmann::json::parse(line);
  EXPECT_EQ(object.at("level"), "warning");
  EXPECT_EQ(object.at("program"), "tessera-test");
  EXPECT_EQ(object.at("message"), "job 7 failed");
  EXPECT_EQ(object.at("job"), "7");
  EXPECT_EQ(object.at("worker"), "w\\x0a");
  EXPECT_EQ(object.at("principal"), "\\x1e\\x1f\"ada");
  EXPECT_EQ(object.at("peer"), "10.0.0.1");
}

TEST(Log, LeavesOutEmptyFields) {
  const std::string line =
      logged({.format = LogFormat::kJson}, [] { log(spdlog::level::info, "a line", {.job = "7"}); });
  EXPECT_EQ(nlohmann::json::parse(line).size(), 5u) << line;
}

TEST(Log, ShowsInTextTheFieldsThatItsMessageDoesNotMention) {
  const auto text = [](const LogFields& fields) {
    return logged({}, [&] { log(spdlog::level::info, "job 7 deleted", fields); });
  };
  EXPECT_THAT(text({.job = "7"}), EndsWith(" info tessera-test: job 7 deleted\n"));
  EXPECT_THAT(text({.job = "7", .principal = "ada", .peer = "::1"}),
              EndsWith(": job 7 deleted [principal ada, peer ::1]\n"));
}

// Texts of others must not look like fields.
TEST(Log, TakesNoFieldsFromMessages) {
  const std::string line = logged({.format = LogFormat::kJson}, [] {
    spdlog::info(
        "x\x1ejob\x1f"
        "8");
    log(spdlog::level::info,
        "y\x1ejob\x1f"
        "9",
        {});
  });
  EXPECT_THAT(line, testing::Not(HasSubstr("\"job\"")));
}

TEST(Log, LeavesOutWhatIsBelowItsLevel) {
  const std::string lines = logged({.level = spdlog::level::warn}, [] {
    spdlog::info("quiet");
    log(spdlog::level::info, "quiet", {.job = "7"});
    spdlog::warn("loud");
  });
  EXPECT_THAT(lines, HasSubstr("loud"));
  EXPECT_THAT(lines, testing::Not(HasSubstr("quiet")));
}

// Fills a pipe that nobody reads, and makes it stderr.
void block_stderr() {
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_NONBLOCK), 0);
  const std::string much(4096, '.');
  while (::write(ends[1], much.data(), much.size()) > 0) {
  }
  ::fcntl(ends[1], F_SETFL, 0);  // writers wait from now on
  ::dup2(ends[1], STDERR_FILENO);
}

TEST(LogDeathTest, NoThreadWaitsForStderr) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        ::alarm(60);  // ends a process that waits for ever
        block_stderr();
        log_to_stderr("tessera-test");
        for (int i = 0; i < 100'000; ++i) spdlog::info("line {}", i);
        std::exit(7);
      },
      testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace tessera::common
