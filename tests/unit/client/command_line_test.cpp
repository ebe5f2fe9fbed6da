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
#include "tests/unit/client/process.hpp"

namespace tessera::client {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using testing::UnorderedElementsAre;

// A glowing sphere seen from the point (0, 0, 4).
std::string scene_text(const std::string& radius, const std::string& center) {
  return R"({
  "render": {"width": 40, "height": 30, "spp": 4},
  "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]},
  "materials": {"glow": {"type": "lambert", "albedo": 0.5, "emission": [2, 1, 0.5]}},
  "shapes": [{"type": "sphere", "radius": )" +
         radius + R"(, "center": )" + center + R"(, "material": "glow"}]
})";
}

class CommandLine : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "command_line.XXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    write("scene.json", scene_text("1", "[0, 0, 0]"));
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return folder_ / name; }
  void write(const std::string& name, const std::string& text) {
    ASSERT_TRUE(core::write_file_atomically(path(name), text));
  }
  std::string read(const std::string& name) const { return core::read_file(path(name)).value_or(""); }
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder_)) found.push_back(entry.path().filename());
    return found;
  }
  ProcessResult render(std::vector<std::string> more) const {
    more.insert(more.begin(), {"render", path("scene.json")});
    return run_tessera(more);
  }

  fs::path folder_;
};

TEST_F(CommandLine, RenderWritesEveryPictureAndSaysSo) {
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

TEST_F(CommandLine, ABlackPictureIsWarnedAbout) {
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

TEST_F(CommandLine, FailuresExitWith1AndLeaveNoPicture) {
  write("broken.json", "{");
  const std::vector<std::vector<std::string>> failures = {
      {"render", path("missing.json"), "-o", path("a.png")},
      {"render", path("broken.json"), "-o", path("a.png")},
      {"render", path(""), "-o", path("a.png")},
      {"render", path("scene.json"), "-o", path("no/a.png")},
      {"render", path("scene.json"), "-o", path("a.png"), "--stats", path("no/s.json")},
      {"render", path("scene.json"), "-o", path("a.png"), "-o", path("a.png")},
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

TEST_F(CommandLine, CompareTellsByItsExitStatus) {
  ASSERT_EQ(render({"-o", path("a.exr"), "-o", path("same.pfm")}).exit_status, 0);
  ASSERT_EQ(render({"-o", path("b.exr"), "--seed", "1"}).exit_status, 0);
  ASSERT_EQ(render({"-o", path("small.exr"), "--size", "4x4"}).exit_status, 0);
  const ProcessResult same = run_tessera({"compare", path("a.exr"), path("same.pfm")});
  EXPECT_EQ(same.exit_status, 0);
  EXPECT_EQ(same.out,
            "identical\nlargest difference  0\nMSE                 0\nrelative MSE        0\nPSNR            "
            "    inf dB\n");
  const ProcessResult different = run_tessera({"compare", path("a.exr"), path("b.exr")});
  EXPECT_EQ(different.exit_status, 1);
  EXPECT_THAT(different.out, AllOf(StartsWith("different\n"), HasSubstr(" at pixel (")));
  const ProcessResult sizes = run_tessera({"compare", path("a.exr"), path("small.exr")});
  EXPECT_EQ(sizes.exit_status, 2);
  EXPECT_EQ(sizes.err, "tessera: error: the images have different sizes: 40x30 and 4x4 pixels\n");
  EXPECT_EQ(run_tessera({"compare", path("a.exr"), path("missing.exr")}).exit_status, 2);
  EXPECT_EQ(run_tessera({"compare", path("a.exr"), path("scene.json")}).exit_status, 2);
}

TEST_F(CommandLine, CompareSpeaksJson) {
  ASSERT_EQ(render({"-o", path("a.exr")}).exit_status, 0);
  const ProcessResult result = run_tessera({"compare", "--json", path("a.exr"), path("a.exr")});
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["identical"], true);
  EXPECT_EQ(json["mse"], 0.0);
  EXPECT_TRUE(json["psnr_db"].is_null());
}

TEST_F(CommandLine, CompareLooksAtLayersOneByOne) {
  ASSERT_EQ(render({"-o", path("a.exr"), "--layers", "normal,alpha,crypto_object"}).exit_status, 0);
  ASSERT_EQ(render({"-o", path("b.exr"), "--layers", "normal,alpha,depth", "--spp", "9"}).exit_status, 0);
  const auto compare = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"compare", path("a.exr"), path("b.exr"), "--layer"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_tessera(arguments);
  };
  EXPECT_EQ(run_tessera({"compare", path("a.exr"), path("a.exr"), "--layer", "all"}).exit_status, 0);
  const ProcessResult all = compare({"all"});
  EXPECT_EQ(all.exit_status, 1);
  EXPECT_THAT(all.out, StartsWith("different\n(beauty)"));
  EXPECT_THAT(all.out, AllOf(HasSubstr("\nNormal            largest difference "),
                             HasSubstr("\nCryptoObject00.a  only in " + path("a.exr"))));
  EXPECT_THAT(all.out, HasSubstr("\nDepth             only in " + path("b.exr")));
  const nlohmann::json json = nlohmann::json::parse(compare({"all", "--json"}).out);
  EXPECT_EQ(json["identical"], false);
  EXPECT_EQ(json["layers"][0]["layer"], "");
  EXPECT_EQ(json["layers"][0]["identical"], false);
  EXPECT_EQ(json["layers"].back()["only_in"], path("b.exr"));
  EXPECT_EQ(compare({"normal"}).out, compare({"Normal"}).out) << "by the name in scene files as well";
  const ProcessResult unknown = compare({"Nromal"});
  EXPECT_EQ(unknown.exit_status, 2);
  EXPECT_THAT(unknown.err, AllOf(HasSubstr("has no layer or channel 'Nromal'; did you mean 'Normal'?"),
                                 HasSubstr("Its layers are 'A', 'CryptoObject00")));
}

TEST_F(CommandLine, LightGroupsAreLayersByEitherName) {
  write("groups.json", R"({"render": {"width": 8, "height": 8, "spp": 2},
    "camera": {"position": [0, 0, 3], "look_at": [0, 0, 0]}, "materials": {"clay": {"type": "lambert"}},
    "lights": [{"type": "directional", "direction": [0, 0, -1], "irradiance": 3, "group": "key"}],
    "shapes": [{"type": "sphere", "radius": 1, "material": "clay"}]})");
  const std::string image = path("groups.exr");
  ASSERT_EQ(run_tessera({"render", path("groups.json"), "--layers", "light_groups", "-o", image}).exit_status,
            0);
  for (const char* name : {"group.key", "Combined_key"})
    EXPECT_EQ(run_tessera({"compare", image, image, "--layer", name}).exit_status, 0) << name;
  EXPECT_THAT(run_tessera({"compare", image, image, "--layer", "group.fill"}).err,
              HasSubstr("has no layer or channel 'group.fill'; its layers are 'Combined_key'"));
}

TEST_F(CommandLine, CompareTakesARegion) {
  ASSERT_EQ(render({"-o", path("a.exr")}).exit_status, 0);
  ASSERT_EQ(render({"-o", path("b.exr"), "--seed", "9"}).exit_status, 0);
  const auto compare = [&](const std::string& region) {
    return run_tessera({"compare", "--json", path("a.exr"), path("b.exr"), "--region", region});
  };
  const ProcessResult part = compare("3,4,20x10");
  EXPECT_EQ(part.exit_status, 1);
  const nlohmann::json json = nlohmann::json::parse(part.out);
  EXPECT_EQ(json["region"], nlohmann::json::parse(R"({"x": 3, "y": 4, "width": 20, "height": 10})"));
  EXPECT_GE(json["largest_difference_x"], 3);
  EXPECT_LT(json["largest_difference_y"], 14);
  EXPECT_EQ(compare("30,0,20x10").exit_status, 2);
  for (const char* text : {"3,4", "3,4,20", "3,4,0x1", "a,4,2x2", "-1,0,2x2", "3,4,20x10,5"})
    EXPECT_THAT(compare(text).err, HasSubstr("--region")) << text;
  EXPECT_THAT(run_tessera({"compare", path("a.exr"), path("a.exr"), "--region", "0,0,2x3"}).out,
              StartsWith("identical in 2x3 pixels from (0, 0)\n"));
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

// The file of a window is that of a picture which consists of nothing else.
TEST_F(CommandLine, AWindowIsThosePixelsOfTheWholePicture) {
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

TEST_F(CommandLine, AWindowOutsideThePictureIsRefused) {
  const ProcessResult result = render({"-o", path("a.png"), "--crop", "0,0,41,30"});
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.err,
              HasSubstr("scene.json: crop: must be x0, y0, x1, y1 with x0 < x1 and y0 < y1, within "
                        "the 40 x 30 pixels of the image, got 0, 0, 41, 30"));
  EXPECT_THAT(names(), UnorderedElementsAre("scene.json"));
}

constexpr const char* kPlyTriangle =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0.3\n3 0 1 2\n";

TEST_F(CommandLine, ImportedSceneRendersToTheSameBytes) {
  write("mesh.ply", kPlyTriangle);
  const auto imported = run_tessera({"import", path("mesh.ply"), "-o", path("out.json")});
  ASSERT_EQ(imported.exit_status, 0) << imported.err;
  EXPECT_EQ(imported.out, "");
  for (const std::string name : {"mesh.ply", "out.json"}) {
    const auto rendered =
        run_tessera({"render", path(name), "-o", path(name + ".pfm"), "--spp", "1", "--size", "16x12", "-q"});
    ASSERT_EQ(rendered.exit_status, 0) << rendered.err;
  }
  EXPECT_EQ(read("mesh.ply.pfm"), read("out.json.pfm"));
  EXPECT_NE(read("out.json.pfm"), "");
}

TEST_F(CommandLine, ImportReportsWhatIsApproximated) {
  std::string ply = kPlyTriangle;
  ply.insert(ply.find("element face"), "property float heat\n");
  ply.replace(ply.find("0 0 0\n1 0 0\n0 1 0.3\n"), 20, "0 0 0 1\n1 0 0 1\n0 1 0.3 1\n");
  write("mesh.ply", ply);
  const auto report = run_tessera({"import", path("mesh.ply"), "--report"});
  EXPECT_EQ(report.exit_status, 0) << report.err;
  EXPECT_THAT(report.out, HasSubstr("mesh.ply: the property 'heat' of 'vertex' is not used"));
  EXPECT_EQ(run_tessera({"import", path("mesh.ply")}).exit_status, 2);
  EXPECT_EQ(run_tessera({"import", path("mesh.ply"), "-o", path("out.gltf")}).exit_status, 2);
}

TEST_F(CommandLine, InfoTellsWhatIsInAScene) {
  write("mesh.ply", kPlyTriangle);
  const auto info = run_tessera({"info", path("mesh.ply"), "--json"});
  ASSERT_EQ(info.exit_status, 0) << info.err;
  const auto json = nlohmann::json::parse(info.out);
  EXPECT_EQ(json["format"], "PLY");
  EXPECT_EQ(json["triangles"], 1);
  EXPECT_EQ(json["shapes"]["mesh"], 1);
  EXPECT_EQ(json["files"][0]["path"], "mesh.ply");
  EXPECT_EQ(json["missing"].size(), 0u);
  EXPECT_THAT(run_tessera({"info", path("mesh.ply")}).out, HasSubstr("triangles   1 stored"));
}

constexpr const char* kTwoSensors = R"(<scene version="3.0.0">
<sensor type="perspective" id="left"><transform name="to_world"><translate x="-3"/></transform></sensor>
<sensor type="perspective" id="right"><transform name="to_world"><translate x="3"/></transform></sensor>
<shape type="sphere"><float name="shine" value="1"/></shape>
<shape type="sphere"><float name="shine" value="2"/></shape>
</scene>)";

TEST_F(CommandLine, InfoListsWhatCanBeChosen) {
  write("room.xml", kTwoSensors);
  EXPECT_THAT(run_tessera({"info", path("room.xml")}).out, HasSubstr("cameras     0 left, 1 right\n"));
  const auto info = run_tessera({"info", path("room.xml"), "--camera", "right", "--json"});
  const auto json = nlohmann::json::parse(info.out);
  EXPECT_EQ(json["camera"]["position"], nlohmann::json({3, 0, 0}));
  EXPECT_EQ(json["contents"]["cameras"], nlohmann::json({"left", "right"}));
  const auto wrong = run_tessera({"info", path("room.xml"), "--camera", "top"});
  EXPECT_EQ(wrong.exit_status, 1);
  EXPECT_THAT(wrong.err, HasSubstr("there is no camera 'top'; the file has 0 ('left'), 1 ('right')"));
  EXPECT_EQ(run_tessera({"info", path("room.xml"), "--animation-time", "soon"}).exit_status, 2);
}

// A render tells a kind once, and the report each place.
TEST_F(CommandLine, ImportReportsEachPlace) {
  write("room.xml", kTwoSensors);
  const std::string told = "<shape type=\"sphere\">: the parameter 'shine' is ignored";
  EXPECT_THAT(run_tessera({"info", path("room.xml")}).err, HasSubstr("room.xml:4: " + told + " (2 times)"));
  const auto report = run_tessera({"import", path("room.xml"), "--report"});
  EXPECT_THAT(report.out, HasSubstr("room.xml:4: " + told + "\n"));
  EXPECT_THAT(report.out, HasSubstr("room.xml:5: " + told + "\n"));
}

TEST_F(CommandLine, InfoTellsWhatMoves) {
  write("moving.pbrt", R"(Camera "perspective" "float shutteropen" 0 "float shutterclose" 0.5
WorldBegin
ActiveTransform EndTime Translate 1 0 0 ActiveTransform All
Shape "sphere")");
  const auto info = run_tessera({"info", path("moving.pbrt")});
  EXPECT_THAT(info.out, HasSubstr("motion      shutter 0 to 0.5 frames, 1 instances\n")) << info.err;
  const auto json = nlohmann::json::parse(run_tessera({"info", path("moving.pbrt"), "--json"}).out);
  EXPECT_EQ(json["motion"], nlohmann::json::parse(R"({"instances": 1, "shutter": [0, 0.5]})"));
  write("room.xml", kTwoSensors);
  EXPECT_THAT(run_tessera({"info", path("room.xml")}).out, testing::Not(HasSubstr("motion")));
}

// The same for all commands that take a scene.
TEST_F(CommandLine, RefusesParametersThatNothingUses) {
  write("room.xml", R"(<scene version="3.0.0"><default name="radius" value="1"/>
<shape type="sphere"><float name="radius" value="$radius"/></shape></scene>)");
  const std::vector<std::vector<std::string>> commands{
      {"info", path("room.xml")},
      {"import", path("room.xml"), "--report"},
      {"render", path("room.xml"), "-o", path("room.png"), "-q"}};
  for (std::vector<std::string> command : commands) {
    command.insert(command.end(), {"-D", "raduis=2"});
    const auto run = run_tessera(command);
    EXPECT_EQ(run.exit_status, 1) << command[0];
    EXPECT_THAT(run.err,
                HasSubstr("room.xml: raduis: nothing in the scene uses a parameter of this name; did you "
                          "mean 'radius'?"))
        << command[0];
  }
  EXPECT_EQ(run_tessera({"info", path("room.xml"), "-D", "radius=2"}).exit_status, 0);
}

TEST_F(CommandLine, InfoListsFilesThatAreMissing) {
  write("lacking.json", R"({"camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]},
  "materials": {"m": {"type": "lambert"}}, "shapes": [{"type": "mesh", "file": "gone.ply", "material": "m"}]})");
  const auto info = run_tessera({"info", path("lacking.json")});
  EXPECT_EQ(info.exit_status, 1);
  EXPECT_THAT(info.out, HasSubstr("missing     gone.ply"));
}

}  // namespace
}  // namespace tessera::client
