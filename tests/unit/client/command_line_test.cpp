// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/image/decode.hpp"
#include "core/image/encode.hpp"
#include "core/image/exr_header.hpp"
#include "core/image/file_io.hpp"
#include "core/scene/render_record.hpp"
#include "tests/unit/client/command_line_fixture.hpp"

namespace tessera::client {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using testing::UnorderedElementsAre;

TEST_F(CommandLine, RenderWritesEveryImageAndSaysSo) {
  const ProcessResult result = render({"-o", path("a.png"), "-o", path("a.exr")});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("100.0%"), HasSubstr("wrote " + path("a.png") + ", " + path("a.exr"))));
  EXPECT_THAT(names(), UnorderedElementsAre("scene.json", "a.png", "a.exr"));
}

TEST_F(CommandLine, TheNumberOfThreadsDoesNotChangeABit) {
  ASSERT_EQ(render({"-o", path("a.exr"), "--threads", "1"}).exit_status, 0);
  ASSERT_EQ(render({"-o", path("b.exr"), "--threads", "3"}).exit_status, 0);
  EXPECT_EQ(read("a.exr"), read("b.exr"));
  ASSERT_EQ(render({"-o", path("c.exr"), "--seed", "1"}).exit_status, 0);
  EXPECT_NE(read("a.exr"), read("c.exr"));
}

TEST_F(CommandLine, QuietSaysNothing) {
  const ProcessResult result = render({"-o", path("a.pfm"), "--quiet"});
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_EQ(result.err + result.out, "");
}

TEST_F(CommandLine, RenderTellsItsProgressAsJson) {
  const ProcessResult result = render({"-o", path("a.png"), "--json", "--spp", "8"});
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_THAT(result.err, IsEmpty());
  std::vector<nlohmann::json> lines;
  std::istringstream out(result.out);
  for (std::string line; std::getline(out, line);) lines.push_back(nlohmann::json::parse(line));
  ASSERT_GE(lines.size(), 2u);
  EXPECT_EQ(lines.front()["state"], "running");
  EXPECT_EQ(lines.front()["samples_done"], 0);
  EXPECT_EQ(lines.front()["samples_total"], 40 * 30 * 8);
  EXPECT_EQ(lines.front()["integrator"], "mis");
  EXPECT_FALSE(lines.front().contains("written"));
  EXPECT_EQ(lines.back()["state"], "done");
  EXPECT_EQ(lines.back()["samples_done"], 40 * 30 * 8);
  EXPECT_EQ(lines.back()["written"], nlohmann::json::array({path("a.png")}));
  EXPECT_EQ(render({"--json", "--sample", "1,1,1"}).exit_status, 2);
}

TEST_F(CommandLine, TheProgressOfAnInterruptedRenderEndsAsJson) {
  const ProcessResult result = run_tessera_and_signal(
      {"render", path("scene.json"), "-o", path("a.png"), "--json", "--spp", "10000000", "--update-every",
       "0.1"},
      [&] { return fs::exists(path("a.png")); }, SIGINT);
  EXPECT_EQ(result.exit_status, 130);
  const std::size_t last = result.out.rfind('\n', result.out.size() - 2) + 1;
  const auto line = nlohmann::json::parse(result.out.substr(last));
  EXPECT_EQ(line["state"], "cancelled");
  EXPECT_GT(line["samples_done"], 0);
}

TEST_F(CommandLine, StatsDescribeTheRender) {
  ASSERT_EQ(
      render({"-o", path("a.pfm"), "--size", "10x20", "--spp", "3", "--stats", path("s.json")}).exit_status,
      0);
  const nlohmann::json stats = nlohmann::json::parse(read("s.json"));
  EXPECT_EQ(stats["width"], 10);
  EXPECT_EQ(stats["height"], 20);
  EXPECT_EQ(stats["samples"], 600);
  EXPECT_GE(stats["closest_hit_rays"], 600);
  EXPECT_EQ(stats["non_finite_samples"], 0);
}

TEST_F(CommandLine, ASampleCanBeReplayed) {
  const ProcessResult result = render({"--sample", "20,15,2"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out, StartsWith("pixel (20, 15) sample 2: radiance "));
  EXPECT_EQ(render({"--sample", "40,15,2"}).exit_status, 2);
  EXPECT_EQ(render({"--sample", "1,2"}).exit_status, 2);
}

TEST_F(CommandLine, ASceneWhoseLightIsTooSmallToCountIsWarnedAbout) {
  write("scene.json", scene_text("1e-30", "[0, 0, 0]"));
  const ProcessResult result = render({"-o", path("a.pfm"), "-q"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.err, AllOf(StartsWith("tessera: warning: "), HasSubstr("has no light")));
  EXPECT_THAT(result.err, Not(HasSubstr("the image is black")));
}

TEST_F(CommandLine, ABlackImageIsWarnedAbout) {
  write("scene.json", scene_text("1", "[0, 0, 9]"));
  const ProcessResult result = render({"-o", path("a.pfm"), "-q"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.err, AllOf(StartsWith("tessera: warning: "), HasSubstr("the image is black")));
}

TEST_F(CommandLine, MistakesInTheCommandLineExitWith2) {
  const std::vector<std::vector<std::string>> mistakes = {
      {},
      {"rendr"},
      {"rendr", "--help"},
      {"rendr", "--version"},
      {"render"},
      {"render", path("scene.json")},
      {"render", path("scene.json"), "-o"},
      {"render", path("scene.json"), "-o", path("a.gif")},
      {"render", path("scene.json"), "-o", path("a.png"), "--spp", "-3"},
      {"render", path("scene.json"), "-o", path("a.png"), "--size", "0x0"},
      {"render", path("scene.json"), "-o", path("a.png"), "--crop", "5,5,5,9"},
      {"render", path("scene.json"), "-o", path("a.png"), "--threads", "0"},
      {"render", path("scene.json"), "-o", path("a.png"), "--sppp", "3"},
      {"render", path("scene.json"), "-o", path("a.png"), "another.json"},
      {"compare", "a.png"},
  };
  for (const auto& arguments : mistakes) {
    const ProcessResult result = run_tessera(arguments);
    SCOPED_TRACE(testing::PrintToString(arguments));
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, AllOf(StartsWith("tessera: error: "), HasSubstr("--help")));
  }
  EXPECT_THAT(names(), UnorderedElementsAre("scene.json"));
}

TEST_F(CommandLine, AnImageIsNoScene) {
  write("a.png", "");
  for (const char* const image : {"a.png", "missing.exr"}) {
    const ProcessResult result = run_tessera({"render", path(image)});
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_THAT(result.err, HasSubstr("SCENE: '" + path(image) +
                                      "' is an image, and not a scene: give the scene "
                                      "file, and images to write by -o"));
  }
}

TEST_F(CommandLine, AFolderIsNoSceneButMayHaveSome) {
  std::filesystem::create_directories(path("models/textures"));
  for (const char* const file : {"b.pbrt", "c.PLY", "a.obj", "readme.txt", "textures/d.pbrt"})
    write("models/" + std::string(file), "");
  std::filesystem::create_directories(path("empty/e.json"));
  const auto complaint = [&](const std::string& folder) {
    const ProcessResult result = run_tessera({"render", folder, "-o", path("a.png")});
    EXPECT_EQ(result.exit_status, 2);
    return result.err;
  };
  const std::string models = path("models");
  EXPECT_THAT(complaint(models),
              HasSubstr("SCENE: '" + models + "' is a folder: give a scene file, such as '" + models +
                        "/b.pbrt', '" + models + "/a.obj', '" + models + "/c.PLY'\n"));
  EXPECT_THAT(complaint(path("empty")), HasSubstr("is a folder: give a scene file\n"));
}

TEST_F(CommandLine, FailuresExitWith1AndLeaveNoImage) {
  write("broken.json", "{");
  const std::vector<std::vector<std::string>> failures = {
      {"render", path("missing.json"), "-o", path("a.png")},
      {"render", path("broken.json"), "-o", path("a.png")},
      {"render", path("scene.json"), "-o", path("no/a.png")},
      {"render", path("scene.json"), "-o", path("a.png"), "--stats", path("no/s.json")},
      {"render", path("scene.json"), "-o", path("a.png"), "-o", path("a.png")},
      {"render", path("scene.json"), "-o", path("a.png"), "--stats", path("./a.png")},
      {"render", path("scene.json"), "-o", path("a.png"), "--stats", path("scene.json")},
      {"render", path("scene.json"), "-o", path("a.png"), "--checkpoint", path("./a.png")},
      {"render", path("scene.json"), "-o", path("a.png"), "--checkpoint", path("c"), "--stats", path("c")},
      {"render", path("scene.json"), "-o", path("a.hdr"), "--size", "65536x16384"},
  };
  for (const auto& arguments : failures) {
    const ProcessResult result = run_tessera(arguments);
    SCOPED_TRACE(testing::PrintToString(arguments));
    EXPECT_EQ(result.exit_status, 1);
    EXPECT_THAT(result.err, StartsWith("tessera: error: "));
  }
  EXPECT_THAT(names(), UnorderedElementsAre("scene.json", "broken.json"));
}

TEST_F(CommandLine, ExposureAndToneCurveChangePngFilesAlone) {
  ASSERT_EQ(render({"-o", path("plain.png"), "-o", path("plain.exr")}).exit_status, 0);
  const ProcessResult curved =
      render({"-o", path("curved.png"), "-o", path("curved.exr"), "--exposure", "-1", "--tone-curve", "agx"});
  ASSERT_EQ(curved.exit_status, 0);
  EXPECT_THAT(curved.err, Not(HasSubstr("warning")));
  EXPECT_EQ(run_tessera({"compare", path("plain.exr"), path("curved.exr")}).exit_status, 0);
  EXPECT_EQ(run_tessera({"compare", path("plain.png"), path("curved.png")}).exit_status, 1);
  EXPECT_THAT(render({"-o", path("a.exr"), "--exposure", "1"}).err, HasSubstr("change PNG files alone"));
}

TEST_F(CommandLine, NearMissesAreSuggested) {
  EXPECT_EQ(run_tessera({"rendr"}).err,
            "tessera: error: there is no command 'rendr'; did you mean 'render'?\nTry: tessera --help\n");
  EXPECT_EQ(run_tessera({"help", "comapre"}).err,
            "tessera: error: there is no command 'comapre'; did you mean 'compare'?\n"
            "Try: tessera help --help\n");
  EXPECT_EQ(render({"-o", path("a.png"), "--sppp=3"}).err,
            "tessera: error: there is no option '--sppp'; did you mean '--spp'?\n"
            "Try: tessera render --help\n");
  EXPECT_THAT(render({"-o", path("a.png"), "other.json"}).err, HasSubstr("unexpected argument 'other.json'"));
  EXPECT_EQ(run_tessera({"render", "corell", "-o", path("a.png")}).err,
            "tessera: error: SCENE: there is no scene 'corell'; did you mean 'cornell'?\n"
            "Try: tessera render --help\n");
}

TEST_F(CommandLine, ViewShowsAnImage) {
  ASSERT_EQ(render({"-o", path("a.png")}).exit_status, 0);
  const ProcessResult refused = run_tessera({"view", path("a.png")});
  EXPECT_EQ(refused.exit_status, 1);
  EXPECT_THAT(refused.err, HasSubstr("stdout is not a terminal"));
  const ProcessResult blocks = run_tessera({"view", path("a.png"), "--protocol", "blocks"});
  EXPECT_EQ(blocks.exit_status, 0) << blocks.err;
  EXPECT_THAT(blocks.out, AllOf(HasSubstr("\033[38;2;"), HasSubstr("40x30 pixels")));
  const ProcessResult sixels = run_tessera({"view", path("a.png"), "--protocol", "sixel"});
  EXPECT_THAT(sixels.out, AllOf(HasSubstr("\033P"), HasSubstr("\033\\")));
  EXPECT_EQ(run_tessera({"view", path("a.png"), "--protocol", "ascii"}).exit_status, 2);
}

TEST_F(CommandLine, ViewTellsTheValuesOfAnImage) {
  ASSERT_EQ(render({"-o", path("a.exr")}).exit_status, 0);
  const ProcessResult viewed = run_tessera({"view", path("a.exr"), "--json"});
  ASSERT_EQ(viewed.exit_status, 0) << viewed.err;
  const nlohmann::json facts = nlohmann::json::parse(viewed.out);
  EXPECT_EQ(facts["image"], path("a.exr"));
  EXPECT_EQ(facts["width"], 40);
  EXPECT_EQ(facts["height"], 30);
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_LT(facts["minimum"][channel], facts["mean"][channel]);
    EXPECT_LT(facts["mean"][channel], facts["maximum"][channel]);
  }
}

TEST_F(CommandLine, HelpAndVersionGoToStdout) {
  for (const auto& arguments : std::vector<std::vector<std::string>>{{"--help"},
                                                                     {"--help", "render"},
                                                                     {"help"},
                                                                     {"help", "render"},
                                                                     {"--version"},
                                                                     {"render", "--help"},
                                                                     {"compare", "--help"}}) {
    const ProcessResult result = run_tessera(arguments);
    EXPECT_EQ(result.exit_status, 0);
    EXPECT_THAT(result.out, HasSubstr("essera"));
    EXPECT_THAT(result.err, IsEmpty());
  }
}

// The file of a window is that of an image which consists of nothing else.
TEST_F(CommandLine, AWindowIsThosePixelsOfTheWholeImage) {
  write("pixels.json", R"({"render": {"width": 90, "height": 80, "spp": 4, "filter": "gaussian"},)" +
                           scene_text("1", "[0, 0, 0]").substr(scene_text("1", "").find("\n  \"camera\"")));
  const auto files = [&](const std::string& name) {
    std::vector<std::string> arguments{"render", path("pixels.json")};
    for (const char* ending : {".png", ".exr", ".pfm"}) {
      arguments.emplace_back("-o");
      arguments.push_back(path(name + ending));
    }
    return arguments;
  };
  const auto run = [](std::vector<std::string> arguments, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_tessera(arguments);
  };
  ASSERT_EQ(run(files("whole"), {}).exit_status, 0);
  const ProcessResult cropped = run(files("part"), {"--crop", "20,7,88,74", "--stats", path("stats.json")});
  ASSERT_EQ(cropped.exit_status, 0) << cropped.err;
  EXPECT_THAT(cropped.err, HasSubstr("(68x67 pixels, 4 spp)"));
  const auto stats = nlohmann::json::parse(read("stats.json"));
  EXPECT_EQ(stats["samples"], 68 * 67 * 4);
  EXPECT_EQ(stats["crop"], nlohmann::json({20, 7, 88, 74}));

  const core::Result<core::Image> whole = core::read_image(path("whole.pfm"));
  ASSERT_TRUE(whole);
  core::Image part(68, 67);
  for (int y = 0; y < part.height; ++y)
    for (int x = 0; x < part.width; ++x) part.at(x, y) = whole->at(20 + x, 7 + y);
  for (const auto& [ending, format] : {std::pair{".png", core::ImageFormat::kPng},
                                       {".exr", core::ImageFormat::kExr},
                                       {".pfm", core::ImageFormat::kPfm}}) {
    const core::ImagePosition window{20, 7, whole->width, whole->height};
    const std::string bytes = read(std::string("part") + ending);
    core::TextAttributes record;  // of OpenEXR files
    if (const auto texts = core::exr_texts(bytes)) record.assign(texts->begin(), texts->end());
    EXPECT_EQ(record.empty(), format != core::ImageFormat::kExr);
    EXPECT_TRUE(bytes == core::encode_image(part, format, {}, window, record).value()) << ending;
  }
}

TEST_F(CommandLine, AWindowOutsideTheImageIsRefused) {
  const ProcessResult result = render({"-o", path("a.png"), "--crop", "0,0,41,30"});
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.err,
              HasSubstr("scene.json: crop: must be x0, y0, x1, y1 with x0 < x1 and y0 < y1, within "
                        "the 40 x 30 pixels of the image, got 0, 0, 41, 30"));
  EXPECT_THAT(names(), UnorderedElementsAre("scene.json"));
}

}  // namespace
}  // namespace tessera::client
