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
  EXPECT_EQ(scatterer_at(all[2], all, {}, {}, 1, 0.0f).name, "a");
  EXPECT_EQ(scatterer_at(all[2], all, {}, {}, 1, 0.74f).name, "a");
  EXPECT_EQ(scatterer_at(all[2], all, {}, {}, 1, 0.76f).name, "b");
  EXPECT_EQ(scatterer_at(all[0], all, {}, {}, 1, 0.76f).name, "a");
}

TEST(Blends, MayHaveAPartOnEachSide) {
  const auto all = two_and({.first = 0, .second = 1, .weight = 0.25f, .by_side = true});
  for (const float u : {0.0f, 0.5f, 0.999f}) {
    EXPECT_EQ(scatterer_at(all[2], all, {}, {}, 1, u).name, "a");
    EXPECT_EQ(scatterer_at(all[2], all, {}, {}, 1, u, true).name, "b");
  }
}

TEST(Blends, LetLightPassByTheSideThatItMeets) {
  const std::vector<Material> all{
      {"a", Lambert{}}, {"b", Null{}}, {"sides", Blend{.first = 0, .second = 1, .by_side = true}}};
  EXPECT_EQ(interception_at(all[2], all, {}, {}, 1).hit, 1);
  EXPECT_EQ(interception_at(all[2], all, {}, {}, 1, true).hit, 0);
  EXPECT_EQ(interception_at(all[2], all, {}, {}, 1, true).transmittance, Rgb::gray(1));
}

// What is left of the random number is used again.
TEST(Blends, MayBeOfBlends) {
  auto all = two_and({.first = 0, .second = 1, .weight = 0.5f});
  all.push_back({"c", Lambert{}});
  all.push_back({"outer", Blend{.first = 2, .second = 3, .weight = 0.5f}});
  std::vector<std::string> names;
  for (const float u : {0.1f, 0.3f, 0.6f, 0.9f})
    names.push_back(scatterer_at(all[4], all, {}, {}, 1, u).name);
  EXPECT_EQ(names, (std::vector<std::string>{"a", "b", "c", "c"}));
}

TEST(Blends, AreAsOpaqueAsTheirParts) {
  auto all = two_and({.first = 0, .second = 1, .weight = 0.25f});
  EXPECT_TRUE(is_opaque(all[2], all));
  all[1].opacity = 0.5f;
  all[2].opacity = 0.5f;
  EXPECT_FALSE(is_opaque(all[2], all));
  EXPECT_FLOAT_EQ(interception_at(all[2], all, {}, {}, 1).hit, 0.5f * (0.75f + 0.25f * 0.5f));
  // A ray that hits meets "b" with a chance of 1 / 7.
  EXPECT_EQ(scatterer_at(all[2], all, {}, {}, 1, 0.85f).name, "a");
  EXPECT_EQ(scatterer_at(all[2], all, {}, {}, 1, 0.87f).name, "b");
}

TEST(Blends, WithNothingAreCutOuts) {
  std::vector<Material> all{{"a", Lambert{}}, {"hole", Null{}}, {"mix", Blend{.first = 0, .second = 1}}};
  EXPECT_FALSE(is_opaque(all[1], all));
  EXPECT_FALSE(is_opaque(all[2], all));
  EXPECT_EQ(interception_at(all[1], all, {}, {}, 1).hit, 0);
  EXPECT_FLOAT_EQ(interception_at(all[2], all, {}, {}, 1).hit, 0.5f);
  EXPECT_EQ(scatterer_at(all[2], all, {}, {}, 1, 0.9999f).name, "a");
}

// Light passes through the pane of a blend as through its hole.
TEST(Interception, IsTheMeanOfABlendsParts) {
  std::vector<Material> all{{"black", Lambert{}},
                            {"pane", ThinDielectric{.transmittance = {{1, 0.5f, 0}}}},
                            {"mix", Blend{.first = 0, .second = 1, .weight = 0.25f}}};
  EXPECT_FALSE(is_opaque(all[1], all));
  const float reflected = 0.08f / 1.04f;
  const auto [pane_hit, through] = interception_at(all[1], all, {}, {}, 1);
  EXPECT_NEAR(pane_hit, reflected, 1e-6f);
  EXPECT_NEAR(through.g, 0.5f * (1 - reflected), 1e-6f);
  const auto [hit, transmittance] = interception_at(all[2], all, {}, {}, 1);
  EXPECT_NEAR(hit, 0.75f + 0.25f * reflected, 1e-6f);
  EXPECT_NEAR(transmittance.r, 0.25f * (1 - reflected), 1e-6f);
  all[2].opacity = 0.5f;
  EXPECT_NEAR(interception_at(all[2], all, {}, {}, 1).transmittance.b, 0.5f, 1e-6f);
  // A ray that hits meets the pane with a chance of 1 / 40.
  EXPECT_EQ(scatterer_at(all[2], all, {}, {}, 1, 0.97f).name, "black");
  EXPECT_EQ(scatterer_at(all[2], all, {}, {}, 1, 0.98f).name, "pane");
}

TEST(Interception, OfGlassIsWhereNothingBends) {
  Material glass{"glass", Glass{.ior = 1, .transmittance = {{0.5f, 1, 1}}}};
  EXPECT_TRUE(passes_straight(glass));
  EXPECT_EQ(interception_at(glass, {}, {}, {}, 0.3f).hit, 0);
  EXPECT_EQ(interception_at(glass, {}, {}, {}, 0.3f).transmittance, (Rgb{0.5f, 1, 1}));
  std::get<Glass>(glass.model).ior = 1.1f;
  EXPECT_FALSE(passes_straight(glass));
  EXPECT_EQ(interception_at(glass, {}, {}, {}, 0.3f).hit, 1);
}

// A surface that emits stops every ray, so that its light is not dimmed by what it lets through.
TEST(Interception, OfLampsIsWhole) {
  Material lamp{"lamp", ThinDielectric{}};
  lamp.emission.value = Rgb::gray(1);
  EXPECT_TRUE(is_opaque(lamp, {}));
  EXPECT_EQ(interception_at(lamp, {}, {}, {}, 1).hit, 1);
}

}  // namespace
}  // namespace tessera::core
