// SPDX-License-Identifier: Apache-2.0
// Faces that lie on each other: the one that comes first in the scene is seen, whatever the acceleration
// structure meets first.
#include <gtest/gtest.h>

#include <random>

#include "core/integrators/render.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

FilmTile film_with_threads(const SceneDescription& description, int threads) {
  const Scene scene = Scene::build(description, threads).value();
  const RenderSettings& settings = scene.settings();
  return render(prepare(scene, settings, threads), {0, 0, settings.width_px, settings.height_px}, {0, 4},
                threads);
}

// Some large and many small triangles, so that several share a leaf and the leaves overlap.
MeshDescription scraps(std::uint32_t material) {
  MeshDescription mesh;
  mesh.triangle_materials = {material};
  std::mt19937 random(1);
  const auto coordinate = [&](float scale) { return scale * (static_cast<float>(random()) * 0x1p-31f - 1); };
  for (std::uint32_t i = 0; i < 300; i += 3) {
    const float size = i < 30 ? 0.6f : 0.1f;
    const Vec3 center{coordinate(0.8f), 1 + coordinate(0.8f), coordinate(0.8f)};
    for (int k = 0; k < 3; ++k)
      mesh.positions.push_back(center + Vec3{coordinate(size), coordinate(size), coordinate(size)});
    mesh.triangles.push_back({i, i + 1, i + 2});
  }
  return mesh;
}

TEST(CoincidentFaces, ShowTheFirstForAnyNumberOfThreads) {
  SceneDescription once = test::room();
  once.settings.integrator = Integrator::kNaive;  // traces no photons
  once.shapes.push_back(scraps(0));
  SceneDescription twice = once;
  twice.shapes.push_back(scraps(1));
  const FilmTile expected = film_with_threads(once, 1);
  for (const int threads : {1, 2, 5})
    EXPECT_EQ(film_with_threads(twice, threads).sums, expected.sums) << threads;
  std::swap(twice.shapes[twice.shapes.size() - 2], twice.shapes.back());
  EXPECT_NE(film_with_threads(twice, 1).sums, expected.sums);
}

}  // namespace
}  // namespace tessera::core::integrators
