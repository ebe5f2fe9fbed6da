// SPDX-License-Identifier: Apache-2.0
// Sample models that nobody here made, where they are at hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "core/scene/loader/loader.hpp"
#include "core/scene/scene.hpp"
#include "tests/unit/core_gltf/gltf_file.hpp"

namespace tessera::core {
namespace {

const std::string kSampleModels = TESSERA_SOURCE_DIR "/../shared/data/scenes/gltf/";

struct SampleModel {
  std::string file;
  std::size_t triangles = 0;  // of meshes as they are stored
};

class SampleModels : public testing::TestWithParam<SampleModel> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kSampleModels)) GTEST_SKIP() << kSampleModels << " is not there";
  }
};

std::size_t triangles_in(const std::vector<ShapeDescription>& shapes) {
  std::size_t triangles = 0;
  for (const ShapeDescription& shape : shapes)
    if (const auto* mesh = std::get_if<MeshDescription>(&shape)) triangles += mesh->triangles.size();
  return triangles;
}

TEST_P(SampleModels, Load) {
  auto scene = load_scene_file(kSampleModels + GetParam().file);
  ASSERT_TRUE(scene) << scene.error().message;
  std::size_t triangles = triangles_in(scene->shapes);
  for (const ObjectDescription& object : scene->objects) triangles += triangles_in(object.shapes);
  EXPECT_EQ(triangles, GetParam().triangles);
}

INSTANTIATE_TEST_SUITE_P(All, SampleModels,
                         testing::Values(SampleModel{"Box-Draco/Box.gltf", 12},
                                         SampleModel{"BoxTextured.glb", 12},
                                         SampleModel{"Cameras/Cameras.gltf", 2}, SampleModel{"Fox.glb", 576},
                                         SampleModel{"SimpleSparseAccessor/SimpleSparseAccessor.gltf", 12}),
                         [](const auto& model) {
                           return std::filesystem::path(model.param.file).stem().string();
                         });

TEST_F(SampleModels, ThatAreBrokenAreRefusedOrRenderedInPart) {
  const auto message = [](const std::string& name) {
    const auto scene = load_scene_file(kSampleModels + "Broken/" + name);
    return scene ? test::warnings_of(*scene) : scene.error().message;
  };
  EXPECT_THAT(message("AllIndicesOutOfRange.gltf"), testing::HasSubstr("no shape that can be rendered"));
  EXPECT_THAT(message("IndexOutOfRange.gltf"),
              testing::HasSubstr("vertices beyond the 24 that there are: 1"));
  EXPECT_THAT(message("RecursiveNodes.gltf"), testing::HasSubstr("is its own ancestor"));
  EXPECT_THAT(message("BoxTextured.gltf"), testing::HasSubstr("there is no file 'BoxTextured0.bin'"));
}

}  // namespace
}  // namespace tessera::core
