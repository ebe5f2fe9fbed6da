// SPDX-License-Identifier: Apache-2.0
// A farm that reads scenes in sandboxes: complete ones that are required, and incomplete ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class SandboxTest : public FarmTest {
 protected:
  // A program that says that a part of its sandbox is missing, and is otherwise the given one.
  std::string lacking(const std::string& program) {
    const std::filesystem::path path =
        folder_ / ("lacking-" + std::filesystem::path(program).filename().string());
    write_file(path, "#!/bin/sh\n[ \"$1\" = --check-sandbox ] && echo 'no Landlock' && exit\nexec " +
                         program + " \"$@\"\n");
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
  }
  // Runs a worker that does not start.
  Outcome refused_worker(const std::vector<std::string>& options) {
    ProcessOptions process{.arguments = {TESSERA_WORKER, "--cache", folder_ / "cache"},
                           .out = folder_ / "out",
                           .err = folder_ / "err"};
    process.arguments.insert(process.arguments.end(), options.begin(), options.end());
    Process worker(process);
    const auto exit_code = worker.wait(std::chrono::seconds(60));
    EXPECT_TRUE(exit_code.has_value()) << "did not end";
    return {exit_code.value_or(-1), worker.out(), worker.err()};
  }
};

const std::vector<std::string> kOptions{"--size", "64x48", "--spp", "4"};

#ifndef TESSERA_SANITIZED  // builds with sanitizers have no complete sandbox

TEST_F(SandboxTest, CanBeRequiredAndGivesTheSameBytes) {
  coordinator_options_ = {"--require-sandbox"};
  start_coordinator();
  Process& worker = start_worker("one", 2, {"--require-sandbox"});
  const std::string id = submit(kOptions);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_TRUE(image(id, ".exr") == render_here(kOptions, ".exr"));
  EXPECT_THAT(worker.err(), Not(HasSubstr("sandbox")));
  EXPECT_THAT(coordinator().err(), Not(HasSubstr("sandbox")));
}

#endif

TEST_F(SandboxTest, MissingPartsAreLoggedAtTheStart) {
  coordinator_options_ = {"--validator", lacking(TESSERA_VALIDATOR)};
  start_coordinator();
  EXPECT_THAT(coordinator().err(),
              HasSubstr("the sandbox of lacking-tessera-validator is incomplete: no Landlock"));
  Process& worker = start_worker("one", 1, {"--scene-loader", lacking(TESSERA_SCENE_LOADER)});
  const std::string id = submit(kOptions);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_THAT(worker.err(),
              HasSubstr("the sandbox of lacking-tessera-scene-loader is incomplete: no Landlock"));
}

TEST_F(SandboxTest, WithoutItNeitherStartsIfItIsRequired) {
  const Outcome coordinator =
      run_coordinator({"--listen", "127.0.0.1:0", "--state", folder_ / "state", "--require-sandbox",
                       "--validator", lacking(TESSERA_VALIDATOR)});
  EXPECT_EQ(coordinator.exit_code, 1);
  EXPECT_EQ(
      coordinator.err,
      "tessera-coordinator: error: the sandbox of lacking-tessera-validator is incomplete: no Landlock; without "
      "--require-sandbox, that "
      "is accepted\n");
  const Outcome worker =
      refused_worker({"--require-sandbox", "--scene-loader", lacking(TESSERA_SCENE_LOADER)});
  EXPECT_EQ(worker.exit_code, 1);
  EXPECT_THAT(worker.err, HasSubstr("the sandbox of lacking-tessera-scene-loader is incomplete: no Landlock; "
                                    "without --require-sandbox, "
                                    "that is accepted"));
}

TEST_F(SandboxTest, WorkersNeedALoader) {
  const Outcome worker = refused_worker({"--scene-loader", folder_ / "none"});
  EXPECT_EQ(worker.exit_code, 1);
  EXPECT_THAT(worker.err,
              HasSubstr("none: there is no such program: install tessera-scene-loader there, or name "
                        "it with --scene-loader"));
}

}  // namespace
}  // namespace tessera::test
