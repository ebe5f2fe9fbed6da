// SPDX-License-Identifier: Apache-2.0
#include "proto/convert.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace tessera::proto {
namespace {

using ::testing::HasSubstr;

TEST(Convert, SettingsComeBackAsTheyWere) {
  const core::RenderSettings settings{.width_px = 640,
                                      .height_px = 480,
                                      .spp = 12,
                                      .seed = 0xfedcba9876543210,
                                      .integrator = core::Integrator::kNee,
                                      .heuristic = core::Heuristic::kPower,
                                      .max_depth = 5,
                                      .clamp_indirect = 2.5f,
                                      .filter = {core::FilterKind::kTent, 1.75f},
                                      .crop = core::PixelRect{600, 0, 640, 480}};
  EXPECT_EQ(from_proto(to_proto(settings)).value(), settings);
  EXPECT_EQ(window_of(to_proto(settings)), settings.window());
}

TEST(Convert, SettingsOfBeforeThereWereWindowsAreOfTheWholeImage) {
  const v1::RenderSettings message = to_proto(core::RenderSettings{.width_px = 640, .height_px = 480});
  EXPECT_FALSE(message.has_crop());
  EXPECT_EQ(from_proto(message)->crop, std::nullopt);
  EXPECT_EQ(window_of(message), (core::PixelRect{0, 0, 640, 480}));
}

TEST(Convert, IntegratorsAndHeuristicsComeBackAsTheyWere) {
  for (const auto integrator :
       {core::Integrator::kNaive, core::Integrator::kNee, core::Integrator::kMis, core::Integrator::kWhitted})
    EXPECT_EQ(from_proto(to_proto(integrator)).value(), integrator);
  for (const auto heuristic : {core::Heuristic::kBalance, core::Heuristic::kPower})
    EXPECT_EQ(from_proto(to_proto(heuristic)).value(), heuristic);
}

TEST(Convert, SettingsOfBeforeThereWereHeuristicsHaveTheBalanceHeuristic) {
  v1::RenderSettings message = to_proto(core::RenderSettings{.heuristic = core::Heuristic::kPower});
  message.clear_heuristic();
  EXPECT_EQ(from_proto(message)->heuristic, core::Heuristic::kBalance);
}

TEST(Convert, JobsStoredWithoutAFilterHaveTheBoxOfOnePixel) {
  v1::RenderSettings message = to_proto(core::RenderSettings{});
  message.clear_filter();
  message.clear_filter_radius_px();
  EXPECT_EQ(from_proto(message)->filter, (core::PixelFilter{core::FilterKind::kBox, 0.5f}));
}

TEST(Convert, SettingsOutOfLimitsNameTheField) {
  const auto error_with = [](auto change) {
    v1::RenderSettings message = to_proto(core::RenderSettings{});
    change(message);
    const auto settings = from_proto(message);
    return settings ? "no error" : settings.error().message;
  };
  EXPECT_THAT(error_with([](auto& m) { m.set_width_px(0); }), HasSubstr("width"));
  EXPECT_THAT(error_with([](auto& m) { m.set_height_px(0xffffffff); }), HasSubstr("height"));
  EXPECT_THAT(error_with([](auto& m) { m.set_spp(0); }), HasSubstr("spp"));
  EXPECT_THAT(error_with([](auto& m) { m.set_max_depth(0xffffffff); }), HasSubstr("max_depth"));
  for (const float limit : {-1.0f, std::numeric_limits<float>::infinity(), std::nanf("")})
    EXPECT_THAT(error_with([&](auto& m) { m.set_clamp_indirect(limit); }), HasSubstr("clamp_indirect"));
  EXPECT_THAT(error_with([](auto& m) { m.clear_integrator(); }), HasSubstr("integrator"));
  EXPECT_THAT(error_with([](auto& m) { m.set_integrator(static_cast<v1::Integrator>(99)); }),
              HasSubstr("99"));
  EXPECT_THAT(error_with([](auto& m) { m.set_heuristic(static_cast<v1::Heuristic>(99)); }), HasSubstr("99"));
  EXPECT_THAT(error_with([](auto& m) { m.set_filter(static_cast<v1::PixelFilter>(77)); }),
              HasSubstr("filter: must be BOX, TENT or GAUSSIAN, got number 77"));
  EXPECT_THAT(error_with([](auto& m) { m.clear_filter_radius_px(); }), HasSubstr("filter_radius"));
  EXPECT_THAT(error_with([](auto& m) { m.set_filter_radius_px(std::nanf("")); }), HasSubstr("filter_radius"));
  EXPECT_THAT(error_with([](auto& m) { m.mutable_crop(); }), HasSubstr("crop: must be x0, y0, x1, y1"));
  EXPECT_THAT(error_with([](auto& m) { m.mutable_crop()->set_x1(0xffffffff); }), HasSubstr("crop: far too"));
}

TEST(Convert, AbsentOverridesStayAbsent) {
  const core::RenderOverrides none = from_proto(to_proto(core::RenderOverrides{})).value();
  EXPECT_FALSE(none.width_px || none.height_px || none.spp || none.seed || none.integrator ||
               none.heuristic || none.clamp_indirect || none.crop);
  const core::RenderOverrides all{.width_px = 1,
                                  .height_px = 0,
                                  .spp = 3,
                                  .seed = 0,
                                  .integrator = core::Integrator::kNaive,
                                  .heuristic = core::Heuristic::kPower,
                                  .clamp_indirect = 0,
                                  .crop = core::PixelRect{0, 1, 2, 3}};
  const core::RenderOverrides back = from_proto(to_proto(all)).value();
  EXPECT_EQ(back.width_px, 1);
  EXPECT_EQ(back.height_px, 0);
  EXPECT_EQ(back.spp, 3u);
  EXPECT_EQ(back.seed, 0u);
  EXPECT_EQ(back.clamp_indirect, 0);
  EXPECT_EQ(back.crop, all.crop);
  EXPECT_EQ(back.integrator, core::Integrator::kNaive);
  EXPECT_EQ(back.heuristic, core::Heuristic::kPower);
}

TEST(Convert, WorkItemsComeBackAndEmptyOnesDoNot) {
  const WorkItem item{{64, 0, 100, 17}, {4, 9}};
  EXPECT_EQ(from_proto(to_proto(item)).value(), item);
  EXPECT_FALSE(from_proto(v1::WorkItem()).has_value());
  EXPECT_FALSE(from_proto(to_proto(WorkItem{{0, 0, 64, 64}, {9, 9}})).has_value());
  EXPECT_FALSE(from_proto(to_proto(WorkItem{{0, 64, 64, 64}, {0, 1}})).has_value());
}

TEST(Convert, CountersComeBackAsTheyWere) {
  core::RenderCounters counters;
  counters.samples = 1;
  counters.closest_hit_rays = 2;
  counters.shadow_rays = 3;
  counters.non_finite_samples = 4;
  counters.saturated_samples = 5;
  EXPECT_EQ(from_proto(to_proto(counters)), counters);
  counters.first_non_finite = core::SampleId{6, 7, 8};
  EXPECT_EQ(from_proto(to_proto(counters)), counters);
}

}  // namespace
}  // namespace tessera::proto
