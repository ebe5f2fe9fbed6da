// SPDX-License-Identifier: Apache-2.0
#include "core/materials/blend.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace tessera::core {
namespace {

// "a", "b" and a blend of both.
std::vector<Material> two_and(Blend blend) {
  return {{"a", Lambert{}}, {"b", Mirror{}}, {"mix", blend}};
}

TEST(Blends, AreChosenByTheirWeight) {
  const auto all = two_and({.first = 0, .second = 1, .weight = 0.25f});
  EXPECT_EQ(scatterer_at(all[2], all, {}, {}, 0.0f).name, "a");
  EXPECT_EQ(scatterer_at(all[2], all, {}, {}, 0.74f).name, "a");
  EXPECT_EQ(scatterer_at(all[2], all, {}, {}, 0.76f).name, "b");
  EXPECT_EQ(scatterer_at(all[0], all, {}, {}, 0.76f).name, "a");
}

// What is left of the random number is used again.
TEST(Blends, MayBeOfBlends) {
  auto all = two_and({.first = 0, .second = 1, .weight = 0.5f});
  all.push_back({"c", Lambert{}});
  all.push_back({"outer", Blend{.first = 2, .second = 3, .weight = 0.5f}});
  std::vector<std::string> names;
  for (const float u : {0.1f, 0.3f, 0.6f, 0.9f}) names.push_back(scatterer_at(all[4], all, {}, {}, u).name);
  EXPECT_EQ(names, (std::vector<std::string>{"a", "b", "c", "c"}));
}

TEST(Blends, AreAsOpaqueAsTheirParts) {
  auto all = two_and({.first = 0, .second = 1, .weight = 0.25f});
  EXPECT_TRUE(is_opaque(all[2], all));
  all[1].opacity = 0.5f;
  all[2].opacity = 0.5f;
  EXPECT_FALSE(is_opaque(all[2], all));
  EXPECT_FLOAT_EQ(opacity_at(all[2], all, {}, {}), 0.5f * (0.75f + 0.25f * 0.5f));
  // A ray that hits meets "b" with a chance of 1 / 7.
  EXPECT_EQ(scatterer_at(all[2], all, {}, {}, 0.85f).name, "a");
  EXPECT_EQ(scatterer_at(all[2], all, {}, {}, 0.87f).name, "b");
}

TEST(Blends, WithNothingAreCutOuts) {
  std::vector<Material> all{{"a", Lambert{}}, {"hole", Null{}}, {"mix", Blend{.first = 0, .second = 1}}};
  EXPECT_FALSE(is_opaque(all[1], all));
  EXPECT_FALSE(is_opaque(all[2], all));
  EXPECT_EQ(opacity_at(all[1], all, {}, {}), 0);
  EXPECT_FLOAT_EQ(opacity_at(all[2], all, {}, {}), 0.5f);
  EXPECT_EQ(scatterer_at(all[2], all, {}, {}, 0.9999f).name, "a");
}

}  // namespace
}  // namespace tessera::core
