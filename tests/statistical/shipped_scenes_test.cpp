// SPDX-License-Identifier: Apache-2.0
// Every scene that comes with Tessera looks the same, but for noise, whichever way its light is found.
#include <gtest/gtest.h>

#include <string>

#include "tests/statistical/agreement.hpp"
#include "tests/statistical/shipped_scenes.hpp"

namespace tessera::test {
namespace {

class ShippedScenes : public testing::TestWithParam<std::string> {};

TEST_P(ShippedScenes, HaveStrategiesThatAgree) {
  expect_strategies_agree(load_shipped_scene(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Scenes, ShippedScenes, testing::ValuesIn(shipped_scenes()),
                         [](const auto& test_case) { return test_case.param; });

}  // namespace
}  // namespace tessera::test
