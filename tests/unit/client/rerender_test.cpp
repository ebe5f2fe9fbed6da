// SPDX-License-Identifier: Apache-2.0
// Images with layers, which say how they were made, and `tessera rerender`: files and messages of the built
// program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "client/image_record.hpp"
#include "core/image/compare.hpp"
#include "core/image/decode.hpp"
#include "core/image/encode.hpp"
#include "core/image/exr_header.hpp"
#include "core/image/file_io.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/client/glowing_sphere.hpp"
#include "tests/unit/client/process.hpp"

namespace tessera::client {
namespace {

using testing::HasSubstr;

class Rerender : public testing::Test {
 protected:
  Rerender() { write_file(path("scene.json"), kGlowingSphere); }

  std::string path(const std::string& name) const { return folder_.path() / name; }
  void render(std::vector<std::string> more) const {
    more.insert(more.begin(), {"render", path("scene.json"), "-q"});
    const ProcessResult result = run_tessera(more);
    EXPECT_EQ(result.exit_status, 0) << result.err;
  }
  static ProcessResult rerender(std::vector<std::string> more) {
    more.insert(more.begin(), "rerender");
    more.emplace_back("-q");
    return run_tessera(more);
  }

  const TemporaryFolder folder_;
};

TEST_F(Rerender, GivesTheSameBytesFromTheSceneBesideTheImage) {
  render({"-o", path("a.exr"), "--spp", "3", "--seed", "18446744073709551615", "--crop", "10,20,90,84",
          "--layers", "all", "--clamp-indirect", "0.1", "--integrator", "nee"});
  const ProcessResult result = rerender({path("a.exr"), "-o", path("b.exr")});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_TRUE(read_file(path("a.exr")) == read_file(path("b.exr")));
}

TEST_F(Rerender, TellsItsProgressAsJson) {
  render({"-o", path("a.exr"), "--spp", "3", "--size", "20x16"});
  const ProcessResult result = run_tessera({"rerender", path("a.exr"), "-o", path("b.exr"), "--json"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const std::size_t last = result.out.rfind('\n', result.out.size() - 2) + 1;
  const auto first = nlohmann::json::parse(result.out.substr(0, result.out.find('\n')));
  EXPECT_EQ(first["state"], "running");
  const auto line = nlohmann::json::parse(result.out.substr(last));
  EXPECT_EQ(line["state"], "done");
  EXPECT_EQ(line["samples_done"], 20 * 16 * 3);
  EXPECT_EQ(line["written"], nlohmann::json::array({path("b.exr")}));
}

TEST_F(Rerender, TakesImagesWithoutLayers) {
  render({"-o", path("plain.exr"), "--spp", "3", "--seed", "7", "--size", "20x16"});
  const ProcessResult result = rerender({path("plain.exr"), "-o", path("b.exr")});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_TRUE(read_file(path("plain.exr")) == read_file(path("b.exr")));
}

TEST_F(Rerender, RefusesAnotherSceneAndImagesOfOtherPrograms) {
  render({"-o", path("a.exr"), "-o", path("a.png"), "--spp", "1", "--size", "16x16", "--layers", "alpha"});
  write_file(path("plain.exr"), *core::encode_image(core::Image(4, 4), core::ImageFormat::kExr));
  const ProcessResult plain = rerender({path("plain.exr"), "-o", path("b.exr")});
  EXPECT_EQ(plain.exit_status, 1);
  EXPECT_THAT(
      plain.err,
      HasSubstr("'" + path("plain.exr") +
                "' does not say how it was rendered: only OpenEXR images that Tessera has rendered do"));
  const std::string png = rerender({path("a.png"), "-o", path("b.exr")}).err;
  EXPECT_THAT(png, testing::AllOf(HasSubstr("is no OpenEXR image ("), HasSubstr("only those say how")));
  const ProcessResult moved = rerender({path("a.exr"), "-D", "camera.position=[0,0,5]", "-o", path("b.exr")});
  EXPECT_EQ(moved.exit_status, 1);
  EXPECT_THAT(moved.err, HasSubstr("is not the scene that the image was rendered from"));
}

// What the film has besides colours does not change them.
TEST_F(Rerender, LayersLeaveTheColoursAlone) {
  const std::vector<std::string> small{"--spp", "4", "--size", "40x30"};
  std::vector<std::string> plain{"-o", path("plain.exr")},
      layered{"-o", path("layers.exr"), "--layers", "all"};
  plain.insert(plain.end(), small.begin(), small.end());
  layered.insert(layered.end(), small.begin(), small.end());
  render(plain);
  render(layered);
  const core::Image a = core::read_image(path("plain.exr")).value(),
                    b = core::read_image(path("layers.exr")).value();
  EXPECT_TRUE(core::compare(a, b).value().identical);
  const auto counts = core::read_image(path("layers.exr"), "Debug Sample Count");
  ASSERT_TRUE(counts) << counts.error().message;
  EXPECT_EQ(counts->at(3, 3), core::Rgb::gray(4));
  const auto texts = core::exr_texts(read_file(path("layers.exr")));
  ASSERT_TRUE(texts);
  EXPECT_EQ(texts->count("cryptomatte/3ae39a5/manifest"), 1u);
  for (const auto& [name, text] : *texts)
    EXPECT_EQ(text.find(folder_.path().string()), std::string::npos) << name;
}

TEST_F(Rerender, ResumedRendersHaveTheBytesOfOthers) {
  const std::vector<std::string> layers{"--size", "40x30", "--layers",
                                        "alpha,position,crypto_object,indirect"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), layers.begin(), layers.end());
    return more;
  };
  render(with({"-o", path("a.exr"), "--spp", "3", "--checkpoint", path("a.tessera")}));
  render(with({"-o", path("a.exr"), "--spp", "9", "--resume", path("a.tessera")}));
  render(with({"-o", path("b.exr"), "--spp", "9"}));
  EXPECT_TRUE(read_file(path("a.exr")) == read_file(path("b.exr")));
}

TEST(ImageRecord, IsReadAsItWasWritten) {
  core::RenderRecord record{"1.2", "abc", "digest", {}, -3, false};
  record.settings = {.width_px = 40,
                     .height_px = 30,
                     .spp = 7,
                     .seed = ~std::uint64_t{0},
                     .integrator = core::Integrator::kNee,
                     .heuristic = core::Heuristic::kPower,
                     .max_depth = 5,
                     .clamp_indirect = 0.1f,
                     .filter = {core::FilterKind::kGaussian, 1.7f},
                     .crop = core::PixelRect{1, 2, 30, 20},
                     .layers = core::LayerSet{}.with(core::Layer::kDepth).with(core::Layer::kUv)};
  const std::vector<float> black(12);
  core::ChannelRows rows{
      2, 2, {"R", "G", "B"}, [&](int) { return core::Result<const float*>(black.data()); }, {}, {}};
  const auto written = [&] { return core::encode_channels(rows, core::ImageFormat::kExr, {}).value(); };
  rows.attributes = core::attributes_of(record);
  const auto read = image_record_of(written());
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->version, "1.2");
  EXPECT_EQ(read->fingerprint, "abc");
  EXPECT_EQ(read->scene, "digest");
  EXPECT_EQ(read->frame, -3);
  EXPECT_FALSE(read->complete);
  EXPECT_TRUE(read->settings == record.settings);
  for (const char* const broken : {"{", "[]", "{\"width\":1}"}) {
    rows.attributes = {{"tessera/settings", broken}};
    EXPECT_THAT(image_record_of(written()).error().message, HasSubstr("broken record")) << broken;
  }
  record.settings.spp = 0;
  rows.attributes = core::attributes_of(record);
  EXPECT_THAT(image_record_of(written()).error().message, HasSubstr("spp: must be"));
}

}  // namespace
}  // namespace tessera::client
