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
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class ImportAndInfo : public CommandLine {};

constexpr const char* kPlyTriangle =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0.3\n3 0 1 2\n";

TEST_F(ImportAndInfo, ImportedSceneRendersToTheSameBytes) {
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

TEST_F(ImportAndInfo, InfoDescribesASceneWithoutImages) {
  write(
      "marble.json",
      R"({"camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]}, "textures": {"stone": {"type": "marble"}},
    "materials": {"a": {"type": "lambert", "albedo": {"texture": "stone"}}},
    "shapes": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "a"}]})");
  const auto told = run_tessera({"info", path("marble.json"), "--json"});
  EXPECT_EQ(told.exit_status, 0) << told.err;
  EXPECT_THAT(told.out, HasSubstr("\"textures\":[]"));
}

TEST_F(ImportAndInfo, ImportReportsWhatIsApproximated) {
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

TEST_F(ImportAndInfo, FormatsOfOtherEndingsAreThoseOfTheContent) {
  write("mesh.scan", kPlyTriangle);
  const auto info = run_tessera({"info", path("mesh.scan"), "--json"});
  ASSERT_EQ(info.exit_status, 0) << info.err;
  EXPECT_EQ(nlohmann::json::parse(info.out)["format"], "PLY");
  const auto imported = run_tessera({"import", path("mesh.scan"), "-o", path("out.json"), "--json"});
  ASSERT_EQ(imported.exit_status, 0) << imported.err;
  EXPECT_EQ(nlohmann::json::parse(imported.out)["format"], "PLY");
}

TEST_F(ImportAndInfo, InfoTellsWhatIsInAScene) {
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

TEST_F(ImportAndInfo, InfoListsEachMissingFileOnceByTheNameThatIsWritten) {
  write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
  write("a.mtl", "newmtl m\nKd 1 1 1\nmap_Kd my%20tex.pfm\nmap_Ks gone%20tex.pfm\n");
  write("My Tex.pfm", "PF\n1 1\n-1\n" + std::string(12, '\0'));
  const auto json = nlohmann::json::parse(run_tessera({"info", path("a.obj"), "--json"}).out);
  EXPECT_EQ(json["missing"], nlohmann::json({"gone%20tex.pfm"}));
}

constexpr const char* kTwoSensors = R"(<scene version="3.0.0">
<sensor type="perspective" id="left"><transform name="to_world"><translate x="-3"/></transform></sensor>
<sensor type="perspective" id="right"><transform name="to_world"><translate x="3"/></transform></sensor>
<shape type="sphere"><float name="shine" value="1"/></shape>
<shape type="sphere"><float name="shine" value="2"/></shape>
</scene>)";

TEST_F(ImportAndInfo, InfoListsWhatCanBeChosen) {
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

TEST_F(ImportAndInfo, ImportSaysAsJsonWhatItHasDone) {
  write("room.xml", kTwoSensors);
  const auto imported = run_tessera({"import", path("room.xml"), "-o", path("caf\xc3\xa9.json"), "--json"});
  ASSERT_EQ(imported.exit_status, 0) << imported.err;
  EXPECT_EQ(imported.err, "");
  EXPECT_EQ(imported.out.find('\n'), imported.out.size() - 1);
  EXPECT_THAT(imported.out, HasSubstr("caf\\u00e9.json"));
  const auto json = nlohmann::json::parse(imported.out);
  EXPECT_EQ(json["file"], path("room.xml"));
  EXPECT_EQ(json["format"], "Mitsuba");
  EXPECT_THAT(json["written"], Contains(path("caf\xc3\xa9.json")));
  const std::string told = "the parameter 'shine' is ignored";
  EXPECT_THAT(json["warnings"].dump(), HasSubstr(told + " (2 times)"));
  const auto report =
      nlohmann::json::parse(run_tessera({"import", path("room.xml"), "--report", "--json"}).out);
  EXPECT_THAT(report["warnings"].dump(), AllOf(HasSubstr(told + "\""), Not(HasSubstr("times"))));
  EXPECT_EQ(report["written"], nlohmann::json::array());
  const auto lost = run_tessera({"import", path("gone.xml"), "--report", "--json"});
  EXPECT_EQ(lost.exit_status, 1);
  EXPECT_EQ(lost.out, "");
}

// A render tells a kind once, and the report each place.
TEST_F(ImportAndInfo, ImportReportsEachPlace) {
  write("room.xml", kTwoSensors);
  const std::string told = "<shape type=\"sphere\">: the parameter 'shine' is ignored";
  EXPECT_THAT(run_tessera({"info", path("room.xml")}).err, HasSubstr("room.xml:4: " + told + " (2 times)"));
  const auto report = run_tessera({"import", path("room.xml"), "--report"});
  EXPECT_THAT(report.out, HasSubstr("room.xml:4: " + told + "\n"));
  EXPECT_THAT(report.out, HasSubstr("room.xml:5: " + told + "\n"));
}

TEST_F(ImportAndInfo, InfoTellsWhatMoves) {
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
TEST_F(ImportAndInfo, RefusesParametersThatNothingUses) {
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

TEST_F(ImportAndInfo, InfoListsFilesThatAreMissing) {
  write("lacking.json", R"({"camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]},
  "materials": {"m": {"type": "lambert"}}, "shapes": [{"type": "mesh", "file": "gone.ply", "material": "m"}]})");
  const auto info = run_tessera({"info", path("lacking.json")});
  EXPECT_EQ(info.exit_status, 1);
  EXPECT_THAT(info.out, HasSubstr("missing     gone.ply"));
}

}  // namespace
}  // namespace tessera::client
