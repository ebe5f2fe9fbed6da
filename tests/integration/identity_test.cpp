// SPDX-License-Identifier: Apache-2.0
// A local render and farms of one, two and three workers with different numbers of threads give the same
// bytes.
#include <fstream>

#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

const std::vector<std::string> kImageOptions{"--size", "200x150", "--spp", "24", "--seed", "7"};

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
  arguments.insert(arguments.end(), kImageOptions.begin(), kImageOptions.end());
  const Outcome outcome = tessera(arguments);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;

  for (const char* ending : {".png", ".exr", ".hdr", ".pfm"}) {
    const std::string farm = read_file(folder_ / (std::string("farm") + ending));
    EXPECT_FALSE(farm.empty());
    // Not EXPECT_EQ, which would print the bytes.
    EXPECT_TRUE(farm == render_here(kImageOptions, ending)) << ending << " differs from the local render";
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

constexpr const char* kBokeh = R"({
  "render": {"width": 90, "height": 60, "spp": 16, "filter": "gaussian", "filter_radius": 1.8},
  "output": {"exposure": 1.5, "tone_curve": "agx"},
  "camera": {"position": [0, 1, 6], "look_at": [0, 0.5, 0], "aperture_radius": 0.3, "focus_distance": 4,
             "aperture_blades": 6, "aperture_rotation_degrees": 10},
  "materials": {"floor": {"type": "lambert"}, "lamp": {"type": "lambert", "emission": [9, 5, 2]}},
  "shapes": [{"type": "quad", "corner": [-5, 0, 5], "edge_u": [10, 0, 0], "edge_v": [0, 0, -10],
              "material": "floor"},
             {"type": "sphere", "center": [0, 1, 0], "radius": 0.4, "material": "lamp"}]})";

std::vector<std::string> joined(std::vector<std::string> front, const std::vector<std::string>& back) {
  front.insert(front.end(), back.begin(), back.end());
  return front;
}

// Settings of lens, filter and output in the scene file, and overrides on the command line: at submission,
// when the image is fetched, or in a local render.
TEST_F(FarmTest, LensFilterExposureAndToneCurveGiveTheSameBytes) {
  start_coordinator();
  start_worker("one", 2);
  const std::string scene = folder_ / "bokeh.json", here = folder_ / "here.png", farm = folder_ / "farm.png";
  std::ofstream(scene) << kBokeh;
  using Options = std::vector<std::string>;
  const auto expect_same = [&](const Options& submit, const Options& image, const Options& render) {
    const Outcome submitted = tessera(joined({"submit", scene, "--wait"}, submit));
    ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
    const std::string id = submitted.out.substr(0, submitted.out.find('\n'));
    ASSERT_EQ(tessera(joined({"image", id, "-o", farm}, image)).exit_code, 0);
    ASSERT_EQ(tessera(joined({"render", scene, "-o", here}, render)).exit_code, 0);
    EXPECT_FALSE(read_file(farm).empty());
    EXPECT_TRUE(read_file(farm) == read_file(here));
  };
  expect_same({}, {}, {});
  const std::string as_the_scene_says = read_file(farm);
  expect_same({"--exposure", "-1"}, {}, {"--exposure", "-1"});
  EXPECT_FALSE(read_file(farm) == as_the_scene_says);
  expect_same({"--tone-curve", "none"}, {"--exposure", "0.5"}, {"--tone-curve", "none", "--exposure", "0.5"});
  expect_same({"--exposure", "3"}, {"--exposure", "1.5"}, {});
  EXPECT_TRUE(read_file(farm) == as_the_scene_says);
}

// A scene with assets, and workers and submissions in another order: the second job finds all files in the
// caches.
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

// All kinds of lights, a mirror and glass for branching paths, and instances.
constexpr std::string_view kLitScene = R"({
  "camera": { "position": [0, 1.5, 6], "look_at": [0, 1, 0] },
  "materials": { "floor": { "type": "lambert" }, "glass": { "type": "glass" }, "mirror": { "type": "mirror" },
                 "lamp": { "type": "lambert", "emission": [9, 8, 7] } },
  "lights": [ { "type": "point", "position": [-2, 3, 1], "intensity": [9, 9, 8] },
              { "type": "spot", "position": [2, 4, 1], "look_at": [1, 0, 1], "intensity": 30 },
              { "type": "directional", "direction": [1, -1, -1], "irradiance": 0.5 } ],
  "environment": { "radiance": [0.2, 0.3, 0.5] },
  "objects": { "signpost": { "shapes": [
    { "type": "quad", "corner": [0, 0, 0], "edge_u": [0.1, 0, 0], "edge_v": [0, 1, 0], "material": "floor" },
    { "type": "sphere", "center": [0, 1.2, 0], "radius": 0.2, "material": "lamp" } ] } },
  "shapes": [
    { "type": "instance", "object": "signpost", "transform": [ { "translate": [-2, 0, 2] } ] },
    { "type": "instance", "object": "signpost", "material": "mirror", "transform": [ { "scale": [3, 1, -1] } ] },
    { "type": "quad", "corner": [-5, 0, 5], "edge_u": [10, 0, 0], "edge_v": [0, 0, -10], "material": "floor" },
    { "type": "sphere", "center": [-1, 1, 0], "radius": 1, "material": "mirror" },
    { "type": "sphere", "center": [1, 0.8, 1], "radius": 0.8, "material": "glass" },
    { "type": "sphere", "center": [0.5, 2.5, -1], "radius": 0.3, "material": "lamp" } ]
})";

TEST_F(FarmTest, EveryLightAndIntegratorRendersTheSameBytes) {
  const std::string scene = (folder_ / "lit.json").string();
  std::ofstream(scene) << kLitScene;
  start_coordinator();
  start_worker("one", 1);
  start_worker("two", 2);
  for (const std::string strategy : {"whitted balance", "mis power", "naive balance"}) {
    const std::size_t space = strategy.find(' ');
    const auto output = [&](const char* name) { return (folder_ / (std::string(name) + ".pfm")).string(); };
    const auto render = [&](std::vector<std::string> command, const std::string& path) {
      for (const std::string& word :
           {scene, std::string("--size"), std::string("150x100"), std::string("--spp"), std::string("8"),
            std::string("--integrator"), strategy.substr(0, space), std::string("--heuristic"),
            strategy.substr(space + 1), std::string("-o"), path})
        command.push_back(word);
      const Outcome outcome = tessera(command);
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      return read_file(path);
    };
    const std::string here = render({"render"}, output("here"));
    EXPECT_FALSE(here.empty());
    EXPECT_TRUE(render({"submit", "--wait"}, output("farm")) == here) << strategy;
  }
}

// A crop window has the bytes of a local render of it, also after a pause.
TEST_F(FarmTest, ACropWindowRendersTheBytesOfALocalRender) {
  start_coordinator();
  start_worker("one", 1);
  start_worker("two", 2);
  const std::vector<std::string> window{"--size", "300x200", "--crop", "97,30,262,171"};
  const std::string id = submit(joined({"--spp", "6"}, window));
  ASSERT_EQ(tessera({"watch", id}).exit_code, 0);
  for (const char* ending : {".png", ".exr", ".hdr", ".pfm"}) {
    const std::string farm = image(id, ending);
    EXPECT_FALSE(farm.empty());
    EXPECT_TRUE(farm == render_here(joined({"--spp", "6"}, window), ending)) << ending;
  }
  EXPECT_EQ(job(id).counters().samples(), 165u * 141 * 6) << "nothing outside it is rendered";
  ASSERT_EQ(tessera({"extend", id, "--spp", "15"}).exit_code, 0);
  ASSERT_EQ(tessera({"watch", id}).exit_code, 0);
  EXPECT_TRUE(image(id, ".exr") == render_here(joined({"--spp", "15"}, window), ".exr"));
}

}  // namespace
}  // namespace tessera::test
