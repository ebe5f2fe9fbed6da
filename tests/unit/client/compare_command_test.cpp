// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/unit/client/command_line_fixture.hpp"

namespace tessera::client {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class CompareCommand : public CommandLine {};

TEST_F(CompareCommand, TellsByItsExitStatus) {
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

TEST_F(CompareCommand, SpeaksJson) {
  ASSERT_EQ(render({"-o", path("a.exr")}).exit_status, 0);
  const ProcessResult result = run_tessera({"compare", "--json", path("a.exr"), path("a.exr")});
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["identical"], true);
  EXPECT_EQ(json["mse"], 0.0);
  EXPECT_TRUE(json["psnr_db"].is_null());
}

TEST_F(CompareCommand, LooksAtLayersOneByOne) {
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

TEST_F(CompareCommand, LightGroupsAreLayersByEitherName) {
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

TEST_F(CompareCommand, TakesARegion) {
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

}  // namespace
}  // namespace tessera::client
