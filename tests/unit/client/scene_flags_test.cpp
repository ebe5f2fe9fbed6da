// SPDX-License-Identifier: Apache-2.0
#include "client/scene_flags.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

namespace tessera::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

SceneFlags parse(std::vector<std::string> arguments) {
  CLI::App app;
  SceneFlags flags;
  add_scene_argument(app, flags);
  add_output_option(app, flags);
  add_override_options(app, flags.overrides);
  add_display_options(app, flags.display);
  app.parse(
      std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // CLI11 takes them from the back
  return flags;
}

std::string mistake(std::vector<std::string> arguments) {
  arguments.emplace_back("scene.json");
  try {
    parse(std::move(arguments));
  } catch (const CLI::ParseError& e) {
    return e.what();
  }
  return "";
}

TEST(SceneFlags, NothingGivenOverridesNothing) {
  const SceneFlags flags = parse({"scene.json"});
  EXPECT_EQ(flags.scene_path, "scene.json");
  EXPECT_THAT(flags.output_paths, ElementsAre());
  EXPECT_FALSE(flags.overrides.spp || flags.overrides.seed || flags.overrides.width_px ||
               flags.overrides.height_px || flags.overrides.integrator || flags.overrides.heuristic ||
               flags.overrides.clamp_indirect || flags.overrides.crop);
  EXPECT_FALSE(flags.display.exposure_stops || flags.display.tone_curve);
}

TEST(SceneFlags, EverythingGiven) {
  const SceneFlags flags =
      parse({"--spp",      "16",          "--size",       "640x480", "--integrator",
             "nee",        "--heuristic", "power",        "--seed",  "18446744073709551615",
             "scene.json", "-o",          "a.png",        "-o",      "b.exr",
             "--exposure", "-1.5",        "--tone-curve", "aces",    "--clamp-indirect",
             "2.5"});
  EXPECT_EQ(flags.overrides.clamp_indirect, 2.5f);
  EXPECT_EQ(flags.overrides.spp, 16u);
  EXPECT_EQ(flags.overrides.width_px, 640);
  EXPECT_EQ(flags.overrides.height_px, 480);
  EXPECT_EQ(flags.overrides.integrator, core::Integrator::kNee);
  EXPECT_EQ(flags.overrides.heuristic, core::Heuristic::kPower);
  EXPECT_EQ(flags.overrides.seed, 18446744073709551615u);
  EXPECT_THAT(flags.output_paths, ElementsAre("a.png", "b.exr"));
  EXPECT_EQ(flags.display.exposure_stops, -1.5f);
  EXPECT_EQ(flags.display.tone_curve, core::ToneCurve::kAces);
}

TEST(SceneFlags, ExposuresAreNumbersWithOrWithoutASign) {
  EXPECT_EQ(parse({"scene.json", "--exposure", "+2"}).display.exposure_stops, 2);
  EXPECT_EQ(parse({"scene.json", "--exposure", "-2"}).display.exposure_stops, -2);
  EXPECT_EQ(parse({"scene.json", "--exposure=0.25"}).display.exposure_stops, 0.25f);
  for (const char* text : {"", "+", "x", "1x", "++1", "nan", "inf", "65", "-64.5"}) {
    EXPECT_THAT(mistake({"--exposure=" + std::string(text)}), HasSubstr("--exposure")) << text;
  }
}

TEST(SceneFlags, AnOutputTakesOneValue) {
  const SceneFlags flags = parse({"-o", "a.png", "scene.json"});
  EXPECT_EQ(flags.scene_path, "scene.json");
  EXPECT_THAT(flags.output_paths, ElementsAre("a.png"));
}

TEST(SceneFlags, BadNumbersNameTheFlagAndTheRange) {
  for (const char* spp :
       {"0", "-3", "16777217", "4.5", "1e3", "", "x", " 4", "4 ", "0x10", "99999999999999999999"}) {
    EXPECT_EQ(mistake({"--spp", spp}),
              "--spp: must be a whole number from 1 to 16777216; got '" + std::string(spp) + "'");
  }
  EXPECT_THAT(mistake({"--seed", "-1"}), HasSubstr("--seed: must be a whole number from 0 to"));
}

TEST(SceneFlags, BadSizesNameTheFlagAndTheForm) {
  for (const char* size :
       {"0x0", "640", "640x", "x480", "640x480x3", "-1x5", "70000x1", "640 x 480", "", "axb"}) {
    EXPECT_THAT(mistake({"--size", size}), HasSubstr("--size: must be WIDTHxHEIGHT")) << size;
  }
  EXPECT_THAT(mistake({"--size", "65536x65536"}), HasSubstr("--size: must be at most"));
}

TEST(SceneFlags, BadIntegratorsNameTheChoices) {
  EXPECT_EQ(mistake({"--integrator", "bdpt"}),
            "--integrator: must be naive, nee, mis or whitted; got 'bdpt'");
  EXPECT_EQ(mistake({"--heuristic", "maximum"}), "--heuristic: must be balance or power; got 'maximum'");
}

TEST(SceneFlags, BadClampsSayWhatIsRight) {
  for (const char* text : {"-1", "nan", "inf", "1e99", "ten", "5x"})
    EXPECT_EQ(mistake({std::string("--clamp-indirect=") + text}),
              fmt::format("--clamp-indirect: must be a positive number, or 0 for no limit; got '{}'", text));
}

TEST(SceneFlags, BadEndingsNameTheChoices) {
  EXPECT_THAT(mistake({"-o", "out.jpg"}), HasSubstr(".png, .exr, .hdr or .pfm"));
}

TEST(SceneFlags, AWindowIsFourWholeNumbers) {
  EXPECT_EQ(parse({"scene.json", "--crop", "0,20,300,65536"}).overrides.crop,
            (core::PixelRect{0, 20, 300, 65536}));
  for (const char* crop : {"", ",", "1,2,3", "1,2,3,", ",1,2,3", "1,2,3,4,5", "1,2,3,4,", "1, 2,3,4",
                           "a,b,c,d", "-1,0,5,5", "1,2,3.5,4", "5,0,5,9", "6,0,5,9", "0,9,5,9", "0,10,5,9",
                           "0,0,65537,1", "0,0,1,99999999999999999999", "100,40,64x32"}) {
    EXPECT_EQ(mistake({"--crop", crop}),
              "--crop: must be X0,Y0,X1,Y1 in pixels with X0 < X1 and Y0 < Y1, such as 100,40,164,72; got '" +
                  std::string(crop) + "'");
  }
}

TEST(SceneFlags, AScenesNameTellsItFromOthers) {
  EXPECT_EQ(scene_name("scenes/veach/scene.json"), "veach");
  EXPECT_EQ(scene_name("/scenes/go/./scene.json"), "go");
  EXPECT_EQ(scene_name("scenes/veach/../go/scene.pbrt"), "go");
  EXPECT_EQ(scene_name("scene.json"), std::filesystem::current_path().filename().string());
  EXPECT_EQ(scene_name("/scene.json"), "scene");
  EXPECT_EQ(scene_name("scenes/glass/fresnel.json"), "fresnel");
  EXPECT_EQ(scene_name("model.v2.glb"), "model.v2");
  EXPECT_EQ(scene_name("a\x1b/scene.json"), "a\\x1b");
}

}  // namespace
}  // namespace tessera::client
