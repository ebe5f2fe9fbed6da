// SPDX-License-Identifier: Apache-2.0
// Textures and environments in lanes are to the bit what each is alone.
#include <array>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "core/sampling/warp.hpp"
#include "tests/unit/core_render/vertex_lanes.hpp"

namespace tessera::core::integrators {
namespace {

// An image of each format that images are kept in.
std::vector<std::shared_ptr<const TextureImage>> images_of_every_format() {
  std::mt19937 generator(2);
  constexpr int kWidth = 37, kHeight = 21;
  std::vector<std::uint8_t> bytes(3 * kWidth * kHeight);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(generator());
  std::vector<float> exact, odd;
  for (const std::uint8_t byte : bytes) {
    exact.push_back(static_cast<float>(byte) / 8);
    odd.push_back(static_cast<float>(byte) / 3);
  }
  return {std::make_shared<TextureImage>(kWidth, kHeight, bytes),
          std::make_shared<TextureImage>(kWidth, kHeight, bytes, ColorSpace::kLinear),
          std::make_shared<TextureImage>(kWidth, kHeight, exact),
          std::make_shared<TextureImage>(1, 1, std::vector<std::uint8_t>{10, 100, 200}),
          std::make_shared<TextureImage>(1, 1, std::vector<float>{0.1f, 2, 3}),
          std::make_shared<TextureImage>(kWidth, kHeight, odd)};
}

TEST_F(VertexLanes, OfTextures) {
  const auto images = images_of_every_format();
  for (int i = 0; i < 2000; ++i) {
    std::array<Texture, kLaneCount> textures;
    std::array<const Texture*, kLaneCount> pointers;
    FloatLanes u, v, second_u, second_v;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const auto& image = images[generator_() % (i % 2 == 0 ? 3 : images.size())];
      textures[lane] = {image, random() < 0.5f ? Wrap::kRepeat : Wrap::kClamp, {3, -2}, {0.2f, random()}};
      if (random() < 0.3f) textures[lane].wrap_v = Wrap::kMirror;
      if (random() < 0.2f) textures[lane].wrap = Wrap::kMirror;
      if (random() < 0.3f) textures[lane].filter = TextureFilter::kNearest;
      if (random() < 0.3f) textures[lane].shear = {0.7f, random()};
      if (i % 3 == 0 && random() < 0.5f) textures[lane].uv_set = UvSet::kSecond;
      pointers[lane] = &textures[lane];
      constexpr float kOdd[] = {std::numeric_limits<float>::quiet_NaN(),
                                std::numeric_limits<float>::infinity(),
                                -std::numeric_limits<float>::infinity(), 1e30f};
      u.set(lane, random() < 0.1f ? kOdd[generator_() % 4] : 2 * random() - 0.5f);
      v.set(lane, random() < 0.1f ? 0 : 3 * random() - 1);
      second_u.set(lane, random());
      second_v.set(lane, random());
    }
    using Uv = Vec2Of<FloatN>;
    const UvSetsOf<FloatN> uv(Uv{u.all(), v.all()}, Uv{second_u.all(), second_v.all()});
    const RgbLanes together(Texture::evaluate(pointers, uv));
    const FloatLanes reds(Texture::evaluate_red(pointers, uv));
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const UvSets of_lane({u[lane], v[lane]}, {second_u[lane], second_v[lane]});
      ASSERT_EQ(together[lane], textures[lane].evaluate(of_lane));
      ASSERT_EQ(reds[lane], together[lane].r);
      ASSERT_EQ(textures[lane].evaluate_red(of_lane), together[lane].r);
    }
  }
}

TEST_F(VertexLanes, OfSurroundings) {
  auto images = images_of_every_format();
  images.push_back(nullptr);
  for (const auto& image : images) {
    const lights::Environment environment({0.5f, 1, 2}, image, 40);
    for (int i = 0; i < 2000; ++i) {
      FloatLanes u_x, u_y;
      Vec3Lanes directions, normals;
      for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
        u_x.set(lane, random()), u_y.set(lane, random());
        directions.set(lane, {random() - 0.5f, random() < 0.1f ? 0 : random() - 0.5f, random() - 0.5f});
        normals.set(lane, random() < 0.2f ? Vec3{} : sampling::sample_sphere({random(), random()}));
      }
      const auto compensation = i % 2 == 0 ? lights::MisCompensation::kOff : lights::MisCompensation::kOn;
      const lights::LightSamples samples =
          environment.sample(normals.all(), Vec2Of<FloatN>{u_x.all(), u_y.all()}, compensation);
      const auto [radiance, pdf] = environment.see(normals.all(), directions.all(), compensation);
      for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
        ASSERT_EQ(RgbLanes(radiance)[lane], environment.radiance(directions[lane]));
        ASSERT_EQ(FloatLanes(pdf)[lane], environment.pdf(normals[lane], directions[lane], compensation));
        const auto sample = environment.sample(normals[lane], {u_x[lane], u_y[lane]}, compensation);
        ASSERT_EQ(has(samples.found, lane), sample.has_value());
        if (!sample) continue;
        ASSERT_EQ(Vec3Lanes(samples.wi)[lane], sample->wi);
        ASSERT_EQ(RgbLanes(samples.radiance)[lane], sample->radiance);
        ASSERT_EQ(FloatLanes(samples.pdf)[lane], sample->pdf);
      }
    }
  }
}

}  // namespace
}  // namespace tessera::core::integrators
