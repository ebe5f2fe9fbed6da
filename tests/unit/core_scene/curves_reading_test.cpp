// SPDX-License-Identifier: Apache-2.0
// Curves in scene files and in files of their own.
#include <gtest/gtest.h>

#include "core/scene/loader/curve_file.hpp"
#include "core/scene/validation.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core::curves_reading_test {
namespace {

using test::MemoryAssets;
using test::scene_with;

constexpr const char* kHairMaterial = "\"hair\": {\"type\": \"lambert\"}";

Result<SceneDescription> load_curves(const std::string& keys, const MemoryAssets::Files& files = {}) {
  return test::load(
      scene_with("", kHairMaterial, "{\"type\": \"curves\", \"material\": \"hair\", " + keys + "}"), files);
}

std::string mistake_in(const std::string& keys, const MemoryAssets::Files& files = {}) {
  const auto scene = load_curves(keys, files);
  return scene ? "no mistake" : scene.error().message;
}

const CurvesDescription* curves_of(const Result<SceneDescription>& scene) {
  EXPECT_TRUE(scene) << scene.error().message;
  if (!scene) return nullptr;
  for (const ShapeDescription& shape : scene->shapes)
    if (const auto* curves = std::get_if<CurvesDescription>(&shape)) return curves;
  return nullptr;
}

TEST(CurvesReading, TakesPointsWithRadii) {
  const auto scene = load_curves(
      "\"basis\": \"linear\", \"shape\": \"flat\", \"transform\": [{\"scale\": 2}, {\"translate\": [0, 0, "
      "1]}],"
      "\"points\": [[[0, 0, 0, 0.5], [1, 0, 0, 0.25]], [[0, 1, 0, 1], [0, 2, 0, 1], [0, 3, 0, 0]]]");
  const auto* curves = curves_of(scene);
  ASSERT_NE(curves, nullptr);
  EXPECT_EQ(curves->strands.basis, CurveBasis::kLinear);
  EXPECT_EQ(curves->strands.shape, CurveShape::kFlat);
  EXPECT_EQ(curves->strands.counts, (std::vector<std::uint32_t>{2, 3}));
  EXPECT_EQ(curves->strands.points[1], (Vec3{2, 0, 1}));
  EXPECT_EQ(curves->strands.radii, (std::vector<float>{1, 0.5f, 2, 2, 0}));
  EXPECT_TRUE(validate_scene(*scene));
}

TEST(CurvesReading, HasDefaults) {
  const auto scene = load_curves("\"radius\": 0.1, \"points\": [[[0,0,0],[1,0,0],[2,0,0],[3,0,0]]]");
  const auto* curves = curves_of(scene);
  ASSERT_NE(curves, nullptr);
  EXPECT_EQ(curves->strands.basis, CurveBasis::kBSpline);
  EXPECT_EQ(curves->strands.shape, CurveShape::kRound);
  EXPECT_EQ(curves->strands.radii, std::vector<float>{0.1f});
}

TEST(CurvesReading, ReadsFiles) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "property float radius\nelement curve 2\nproperty uint points\nend_header\n"
      "0 0 0 1\n1 0 0 2\n0 1 0 3\n0 2 0 4\n0 3 0 5\n2\n3\n";
  const auto scene = load_curves("\"basis\": \"linear\", \"file\": \"a.ply\"", {{"a.ply", text}});
  const auto* curves = curves_of(scene);
  ASSERT_NE(curves, nullptr);
  EXPECT_EQ(curves->strands.radii, (std::vector<float>{1, 2, 3, 4, 5}));
  EXPECT_EQ(curves->strands.counts, (std::vector<std::uint32_t>{2, 3}));
  for (std::size_t length = 0; length < text.size() - 2; ++length)
    EXPECT_FALSE(read_curve_file(text.substr(0, length), "a.ply")) << length;
  std::string huge = text;
  huge.replace(huge.find("vertex 5"), 8, "vertex 4000000000");
  EXPECT_FALSE(read_curve_file(huge, "a.ply"));
}

TEST(CurvesReading, RefusesASecondListOfPoints) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float radius\n"
      "element curve 1\nproperty uint points\nend_header\n0 0 0\n1 0 0 2\n2\n";
  const auto strands = read_curve_file(text, "a.ply");
  ASSERT_FALSE(strands);
  EXPECT_EQ(strands.error().message, "'a.ply' has two elements 'vertex'");
}

TEST(CurvesReading, SaysWhatIsWrong) {
  const std::string four = "\"points\": [[[0,0,0],[1,0,0],[2,0,0],[3,0,0]]]";
  const auto expect = [](const std::string& message, std::string_view part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect(mistake_in(four), "need a 'radius'");
  expect(mistake_in("\"radius\": 1"), "either 'points' or a 'file'");
  expect(mistake_in("\"radius\": 1, \"points\": [[[0,0,0],[1,0,0],[2,0,0]]]"), "it needs 4 or more");
  expect(mistake_in("\"radius\": 1, \"basis\": \"bezier\", \"points\": [[[0,0,0],[1,0,0],[2,0,0],[3,0,0],"
                    "[4,0,0]]]"),
         "4, 7, 10");
  expect(mistake_in("\"radius\": 1, \"shape\": \"ribbon\", " + four), "ribbons need 'normals'");
  expect(mistake_in("\"radius\": 1, \"normals\": [[[0,0,1],[0,0,1]]], " + four), "only ribbons");
  expect(mistake_in("\"points\": [[[0,0,0,1],[1,0,0],[2,0,0],[3,0,0]]]"), "or none");
  expect(mistake_in("\"radius\": 1, \"transform\": [{\"scale\": [1, 2, 1]}], " + four), "must stay round");
}

TEST(CurvesReading, RefusesLight) {
  const auto scene =
      test::load(scene_with("", "",
                            "{\"type\": \"curves\", \"material\": \"light\", \"radius\": 1, \"points\": "
                            "[[[0,0,0],[1,0,0],[2,0,0],[3,0,0]]]}"));
  ASSERT_TRUE(scene);
  const auto valid = validate_scene(*scene);
  ASSERT_FALSE(valid);
  EXPECT_NE(valid.error().message.find("curves cannot emit"), std::string::npos);
}

}  // namespace
}  // namespace tessera::core::curves_reading_test
