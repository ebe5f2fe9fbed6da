// The same bytes from one process and from farms of one, two and three workers with different numbers of
// threads.
#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

const std::vector<std::string> kOptions{"--size", "200x150", "--spp", "24", "--seed", "7"};

struct FarmShape {
  std::vector<int> threads;  // of each worker
};

class IdentityTest : public FarmTest, public ::testing::WithParamInterface<FarmShape> {};

TEST_P(IdentityTest, AFarmRendersTheBytesOfALocalRender) {
  start_coordinator();
  int number = 0;
  for (const int threads : GetParam().threads) start_worker("worker" + std::to_string(++number), threads);
  ASSERT_TRUE(wait_for_workers(GetParam().threads.size()));

  std::vector<std::string> arguments{"submit", kCornell, "--wait"};
  for (const char* ending : {".png", ".exr", ".hdr", ".pfm"}) {
    arguments.push_back("-o");
    arguments.push_back((folder_ / (std::string("farm") + ending)).string());
  }
  arguments.insert(arguments.end(), kOptions.begin(), kOptions.end());
  const Outcome outcome = tessera(arguments);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;

  for (const char* ending : {".png", ".exr", ".hdr", ".pfm"}) {
    const std::string farm = read_file(folder_ / (std::string("farm") + ending));
    EXPECT_FALSE(farm.empty());
    // Not EXPECT_EQ: nobody wants to see the bytes.
    EXPECT_TRUE(farm == render_here(kOptions, ending)) << ending << " differs from the local render";
  }
  std::uint64_t accepted = 0;
  for (const auto& worker : workers()) accepted += worker.samples_accepted();
  EXPECT_EQ(accepted, 200u * 150u * 24u) << "every sample comes from a worker, and counts once";
}

INSTANTIATE_TEST_SUITE_P(Farms, IdentityTest,
                         ::testing::Values(FarmShape{{2}}, FarmShape{{1, 2}}, FarmShape{{3, 1, 2}}),
                         [](const auto& shape) {
                           return std::to_string(shape.param.threads.size()) + "Workers";
                         });

// A scene with files beside it, and in another order of workers and submissions: the second job finds
// everything in the caches.
TEST_F(FarmTest, TwoJobsAtOnceDoNotDisturbEachOther) {
  start_coordinator();
  start_worker("one", 1);
  start_worker("two", 1);
  const std::vector<std::string> first_options{"--size", "130x70", "--spp", "16", "--integrator", "nee"};
  const std::vector<std::string> second_options{"--size", "70x130", "--spp", "16", "--seed", "5"};
  const std::string first = submit(first_options), second = submit(second_options);
  ASSERT_TRUE(wait_for_state(first, v1::JOB_STATE_DONE));
  ASSERT_TRUE(wait_for_state(second, v1::JOB_STATE_DONE));
  EXPECT_TRUE(image(first, ".pfm") == render_here(first_options, ".pfm"));
  EXPECT_TRUE(image(second, ".pfm") == render_here(second_options, ".pfm"));
}

}  // namespace
}  // namespace tessera::test
