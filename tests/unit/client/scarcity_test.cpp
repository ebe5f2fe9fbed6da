// SPDX-License-Identifier: Apache-2.0
// What `tessera` does where there is no room for its messages, its results or its memory.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/client/process.hpp"

namespace tessera::client {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

void send_to(int stream, const char* device) {
  ::dup2(::open(device, O_WRONLY), stream);
}

// A pipe whose reader has gone.
void send_to_nobody(int stream) {
  int ends[2];
  if (::pipe(ends) != 0) ::_exit(126);
  ::dup2(ends[1], stream);
  ::close(ends[0]);
  ::close(ends[1]);
}

class Scarcity : public testing::Test {
 protected:
  Scarcity() {
    std::ofstream(scene()) << R"({"render": {"width": 40, "height": 30, "spp": 2},
      "camera": {"position": [0, 1, 4], "look_at": [0, 1, 0]}, "environment": {"radiance": 1},
      "materials": {"m": {"type": "lambert"}},
      "shapes": [{"type": "sphere", "center": [0, 1, 0], "radius": 1, "material": "m"}]})";
  }
  std::string scene() const { return folder_.path() / "scene.json"; }
  std::string image() const { return folder_.path() / "a.pfm"; }

  TemporaryFolder folder_;
};

TEST_F(Scarcity, OfStderrEndsNothing) {
  const std::vector<std::pair<const char*, void (*)()>> losses{
      {"closed", [] { ::close(STDERR_FILENO); }},
      {"full", [] { send_to(STDERR_FILENO, "/dev/full"); }},
      {"without a reader", [] { send_to_nobody(STDERR_FILENO); }},
      {"all closed", [] {
         for (int stream = 0; stream <= 2; ++stream) ::close(stream);
       }}};
  for (const auto& [name, lose] : losses) {
    SCOPED_TRACE(name);
    fs::remove(image());
    EXPECT_EQ(run_tessera_after(lose, {"render", scene(), "-o", image()}).exit_status, 0);
    EXPECT_TRUE(fs::exists(image()));
    EXPECT_EQ(run_tessera_after(lose, {"render", "missing.json", "-o", image()}).exit_status, 1);
    EXPECT_EQ(run_tessera_after(lose, {"render", "--spp"}).exit_status, 2);
  }
}

TEST_F(Scarcity, OfStdoutIsAFailureThatSaysSo) {
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"schema"}, {"--help"}, {"--version"}}) {
    const auto full = run_tessera_after([] { send_to(STDOUT_FILENO, "/dev/full"); }, command);
    EXPECT_EQ(full.exit_status, 1);
    EXPECT_THAT(full.err, HasSubstr("tessera: error: stdout cannot be written"));
    const auto closed = run_tessera_after([] { ::close(STDOUT_FILENO); }, command);
    EXPECT_EQ(closed.exit_status, 1);
    EXPECT_THAT(closed.err, HasSubstr("tessera: error: stdout cannot be written"));
  }
}

TEST_F(Scarcity, OfReadersOfStdoutEndsWithoutAMessage) {
  const auto result = run_tessera_after([] { send_to_nobody(STDOUT_FILENO); }, {"schema"});
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_EQ(result.err, "");
}

// Whatever step the memory runs out in.
TEST_F(Scarcity, OfMemoryIsAFailureThatSaysSo) {
#ifdef TESSERA_SANITIZED
  GTEST_SKIP() << "the sanitizers take terabytes of addresses";
#endif
  struct Render {
    const char *size, *threads;
    rlim_t first_mib, last_mib, step_mib;
  };
  int refused = 0;
  for (const auto& [size, threads, first_mib, last_mib, step_mib] :
       {Render{"40x30", "2", 32, 64, 4}, Render{"40x30", "8", 32, 128, 16},
        Render{"1000x1000", "2", 64, 256, 32}}) {
    for (rlim_t mib = first_mib; mib <= last_mib; mib += step_mib) {
      const auto limit = [mib = mib] {
        const rlimit addresses{mib << 20, mib << 20};
        ::setrlimit(RLIMIT_AS, &addresses);
      };
      if (run_tessera_after(limit, {"--version"}).exit_status != 0) continue;  // not even loaded
      const auto result = run_tessera_after(limit, {"render", scene(), "-o", image(), "-q", "--spp", "1",
                                                    "--size", size, "--threads", threads});
      SCOPED_TRACE(testing::Message() << size << ", " << threads << " threads, " << mib << " MiB");
      if (result.exit_status == 0) break;  // more is enough, too
      EXPECT_EQ(result.exit_status, 1);
      EXPECT_THAT(result.err, testing::StartsWith("tessera: error: "));
      EXPECT_THAT(result.err, HasSubstr("not enough memory"));
      ++refused;
    }
  }
  EXPECT_GE(refused, 5);
}

}  // namespace
}  // namespace tessera::client
