// The strategies of path tracing differ in noise alone: region by region, they agree in expectation.
#include <gtest/gtest.h>

#include "tests/statistical/agreement.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core {
namespace {

using test::expect_strategies_agree;

TEST(Strategies, AgreeInARoomOfEveryMaterial) {
  expect_strategies_agree(test::room());
}

// A sky whose power dwarfs the lamp's by ten orders of magnitude hides neither.
TEST(Strategies, AgreeUnderASky) {
  test::SceneMaker maker({.position = {0, 2, 6}, .look_at = {0, 0.5f, 0}});
  maker.add(QuadDescription{{-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, maker.material(test::lambert(0.6f))});
  maker.add(SphereDescription{{0, 1.5f, 0}, 0.5f, maker.material(test::lambert(0), {4, 3, 2})});
  maker.add(SphereDescription{{0, 0, 0}, 1e5f, maker.material(test::lambert(0), Rgb::gray(0.02f))});
  expect_strategies_agree(maker.description());
}

}  // namespace
}  // namespace tessera::core
