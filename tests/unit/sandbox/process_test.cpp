// SPDX-License-Identifier: Apache-2.0
// Programs that confine themselves, from the side of the process that starts them.
#include "core/sandbox/process.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <thread>

#include "core/sandbox/check.hpp"
#include "core/sandbox/confinement.hpp"
#include "core/sandbox/flags.hpp"
#include "core/sandbox/memory_file.hpp"
#include "server/validator/validate.pb.h"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/sandbox/in_child.hpp"

namespace tessera::sandbox {
namespace {

using namespace std::chrono_literals;
using core::ErrorCode;
using testing::ElementsAre;
using testing::HasSubstr;

core::Result<core::OpenFile> no_file(std::uint32_t) {
  return core::fail(ErrorCode::kNotFound, "none");
}

class ConfinedProgram : public testing::Test {
 protected:
  // A shell script in place of a program.
  std::string script(const std::string& text) {
    const auto path = folder_.path() / "script";
    write_file(path, "#!/bin/sh\n" + text + "\n");
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
  }
  // Its output, and how it ended.
  std::string run_with(const Program& program, const std::string& input, const OpenNumbered& open = no_file) {
    const auto in = create_memory_file("in", input).value(), out = create_memory_file("out").value();
    const auto ending = run(program, {in, out, open});
    EXPECT_TRUE(ending) << ending.error().message;
    if (ending) ending_ = *ending;
    return read_memory_file(out, 1 << 20).value();
  }

  TemporaryFolder folder_;
  Ending ending_;
};

TEST_F(ConfinedProgram, GetsItsInputAndTheIdOfItsParent) {
  EXPECT_EQ(
      run_with({.path = script("cat; echo \"$@\""), .arguments = {"a", "b c"}, .timeout = 1min}, "in\n"),
      "in\na b c --parent " + std::to_string(getpid()) + "\n");
  EXPECT_TRUE(ending_.succeeded());
}

TEST_F(ConfinedProgram, HasNoEnvironmentAndNoOtherFiles) {
  setenv("TESSERA_TOKEN_FILE", "secret", 1);
  const core::OpenFile open(::open(folder_.path().c_str(), O_RDONLY));
  const std::string out = run_with({.path = script("env; ls /proc/self/fd"), .timeout = 1min}, "");
  unsetenv("TESSERA_TOKEN_FILE");
  EXPECT_THAT(out, testing::Not(HasSubstr("secret")));
  EXPECT_THAT(out, HasSubstr("0\n1\n2\n3\n"));
}

TEST_F(ConfinedProgram, CanTryWhatItLikes) {
  if (kIsSanitized) GTEST_SKIP() << "sanitizers need what confinement takes away";
  write_file(folder_.path() / "token", "secret");
  write_file(folder_.path() / "file", "for it");
  const auto open = [&](std::uint32_t) { return open_to_send(folder_.path() / "file"); };
  const std::string out =
      run_with({.path = TESSERA_SANDBOX_PROBE, .arguments = {kCompleteFlag}, .timeout = 1min},
               folder_.path() / "token", open);
  EXPECT_TRUE(ending_.succeeded());
  EXPECT_EQ(out,
            "read the secret: Operation not permitted\n"
            "remove the secret: Operation not permitted\n"
            "connect: Operation not permitted\n"
            "talk to local services: Operation not permitted\n"
            "signal the parent: Operation not permitted\n"
            "read the parent's memory: Operation not permitted\n"
            "start a program: Operation not permitted\n"
            "file: for it\n");
  EXPECT_EQ(read_file(folder_.path() / "token"), "secret");
}

// The validator itself, looked at while it waits for the file of a scene.
TEST_F(ConfinedProgram, TheValidatorIsOne) {
  if (kIsSanitized) GTEST_SKIP() << "sanitizers need what confinement takes away";
  validator::ValidateRequest request;
  request.mutable_bundle()->set_scene_path("scene.json");
  request.mutable_bundle()->add_assets()->set_path("scene.json");
  int looks = 0;
  const auto look = [&](std::uint32_t number) {
    ++looks;
    EXPECT_EQ(number, 0u);
    expect_confined(child(), "tessera-validator");
    return no_file(number);
  };
  const std::string out =
      run_with({.path = TESSERA_VALIDATOR, .timeout = 1min}, request.SerializeAsString(), look);
  EXPECT_EQ(looks, 1);
  validator::ValidateResponse response;
  EXPECT_TRUE(response.ParseFromString(out));
  EXPECT_THAT(response.refusal().message(), HasSubstr("'scene.json' does not exist"));
}

TEST_F(ConfinedProgram, IsKilledAfterItsTime) {
  run_with({.path = script("exec sleep 600"), .timeout = 50ms}, "");
  EXPECT_EQ(ending_.cause, Ending::Cause::kTimeout);
}

TEST_F(ConfinedProgram, IsKilledByAStopRequest) {
  std::stop_source stopping;
  std::jthread stopper([&] { stopping.request_stop(); });
  run_with({.path = script("exec sleep 600"), .timeout = 1h, .stop = stopping.get_token()}, "");
  EXPECT_EQ(ending_.cause, Ending::Cause::kStopRequest);
}

TEST_F(ConfinedProgram, EndsAreDescribed) {
  const auto end_of = [&](const std::string& text) {
    run_with({.path = script(text), .timeout = 1min}, "");
    return describe(ending_, "it");
  };
  EXPECT_EQ(end_of("exit 7"), "it ended with status 7");
  if (!kIsSanitized) {
    EXPECT_EQ(end_of("printf 'no \\033[2Jcat\\n' >&2; exit 7"), "it ended with status 7: no \\x1b[2Jcat");
    EXPECT_LT(end_of("yes | head -c 1000000 >&2; exit 7").size(), 5000u);
  }
  EXPECT_EQ(end_of("kill -SEGV $$"), "it ended by signal 11 (Segmentation fault)");
  EXPECT_EQ(end_of("kill -SYS $$"), "it ended by signal 31 (Bad system call: the sandbox forbids it)");
  EXPECT_EQ(end_of("kill -KILL $$"), "it ended by signal 9 (Killed, perhaps for want of memory)");
}

TEST_F(ConfinedProgram, MoreOutputThanItMayWriteEndsIt) {
  auto* const before = std::signal(SIGXFSZ, SIG_IGN);  // as in coordinators and workers
  run_with({.path = script("ulimit -f 1; exec cat"), .timeout = 1min}, std::string(4096, 'x'));
  std::signal(SIGXFSZ, before);
  EXPECT_TRUE(ending_.by_signal(SIGXFSZ)) << describe(ending_, "it");
}

class Check : public ConfinedProgram {
 protected:
  core::Status check(const std::string& path, bool must_be_complete) {
    lines_.clear();
    return check_sandbox(path, must_be_complete, [this](const std::string& line) { lines_.push_back(line); });
  }
  std::vector<std::string> lines_;
};

TEST_F(Check, FindsNothingMissingHere) {
  if (kIsSanitized) GTEST_SKIP() << "builds with sanitizers have no filter";
  for (const char* program : {TESSERA_SANDBOX_PROBE, TESSERA_VALIDATOR}) {
    EXPECT_TRUE(check(program, true));
    EXPECT_TRUE(check(program, false));
    EXPECT_THAT(lines_, ElementsAre());
  }
}

TEST_F(Check, WarnsOfEachMissingPartOrRefuses) {
  const std::string path = script("[ \"$1\" = --check-sandbox ] && printf 'no cat\\nno dog\\n'");
  EXPECT_TRUE(check(path, false));
  EXPECT_THAT(lines_, ElementsAre("the sandbox of script is incomplete: no cat",
                                  "the sandbox of script is incomplete: no dog"));
  const auto refused = check(path, true);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kFailedPrecondition);
  EXPECT_EQ(
      refused.error().message,
      "the sandbox of script is incomplete: no cat; no dog; without --require-sandbox, that is accepted");
}

TEST_F(Check, TakesSilenceForNoAnswer) {
  const std::string path = script("exit 3");
  EXPECT_TRUE(check(path, false));
  EXPECT_THAT(lines_, ElementsAre("the sandbox of script is incomplete: it cannot be checked (" + path +
                                  " ended with status 3)"));
  EXPECT_FALSE(check(path, true));
}

}  // namespace
}  // namespace tessera::sandbox
