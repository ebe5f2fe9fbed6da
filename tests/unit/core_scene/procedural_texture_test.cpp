// SPDX-License-Identifier: Apache-2.0
// Procedural textures: noise and patterns against their definitions, lanes against scalars, and their keys.
#include <gmock/gmock.h>
#include <pthread.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "core/math/lane_array.hpp"
#include "core/scene/loader/loader.hpp"
#include "core/scene/validation.hpp"
#include "core/textures/noise.hpp"
#include "core/textures/texture.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;

Texture pattern_texture(Pattern pattern, float max = 1) {
  return {.image = nullptr, .procedural = ProceduralTexture{.pattern = std::move(pattern), .max = max}};
}

Rgb pattern_at(const Texture& texture, Vec3 position, const std::vector<Texture>& all = {}) {
  return texture.evaluate_unclamped(all, {UvSets(), position});
}

TEST(Noise, ThePermutationHasEachNumberTwice) {
  std::multiset<float> seen(kNoisePermutation.begin(), kNoisePermutation.end());
  for (int i = 0; i < 256; ++i) EXPECT_EQ(seen.count(static_cast<float>(i)), 2) << i;
}

// The noise of Perlin 2002 from a table of its gradients, in double precision. The last four are as in pbrt.
double reference_noise(double x, double y, double z) {
  const auto p = [](int i) { return static_cast<int>(kNoisePermutation[static_cast<std::size_t>(i)]); };
  const auto gradient = [](int hash, double dx, double dy, double dz) {
    constexpr int kGradients[16][3] = {
        {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}, {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1},
        {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1}, {1, 1, 0}, {-1, 1, 0}, {0, 1, -1}, {0, -1, -1}};
    const auto& g = kGradients[hash & 15];
    return g[0] * dx + g[1] * dy + g[2] * dz;
  };
  const double fx = std::floor(x), fy = std::floor(y), fz = std::floor(z);
  const int ix = static_cast<int>(fx) & 255, iy = static_cast<int>(fy) & 255, iz = static_cast<int>(fz) & 255;
  const auto fade = [](double t) { return t * t * t * (t * (t * 6 - 15) + 10); };
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
    const double dx = x - fx - i, dy = y - fy - j, dz = z - fz - k;
    const auto weight = [&](int side, double d) { return side == 1 ? fade(d) : 1 - fade(d); };
    sum += weight(i, x - fx) * weight(j, y - fy) * weight(k, z - fz) *
           gradient(p(p(p(ix + i) + iy + j) + iz + k), dx, dy, dz);
  }
  return sum;
}

TEST(Noise, IsThatOfThePaper) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> coordinate(-300, 300);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p{coordinate(random), coordinate(random), coordinate(random)};
    ASSERT_NEAR(perlin_noise(p), reference_noise(double{p.x}, double{p.y}, double{p.z}), 1e-5)
        << p.x << ' ' << p.y << ' ' << p.z;
  }
}

TEST(Noise, IsFiniteWhereCellsHaveNoNumber) {
  EXPECT_TRUE(std::isfinite(perlin_noise(Vec3{1e30f, 0, -1e30f})));
  const Texture fbm = pattern_texture(FbmPattern());
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const float odd : {kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN(), 3e38f}) {
    const Rgb seen = fbm.evaluate_procedural({}, TexturePoint(UvSets(), {odd, 0.5f, 0.25f}));
    EXPECT_TRUE(seen.r >= 0 && seen.r <= 1) << odd;
  }
}

TEST(Patterns, NoiseAddsUpItsOctaves) {
  const Vec3 p{0.3f, 1.7f, -2.4f};
  const float first = perlin_noise(p), second = perlin_noise(p * 1.99f);
  EXPECT_FLOAT_EQ(pattern_at(pattern_texture(FbmPattern{2, 0.5f}), p).r, first + 0.5f * second);
  EXPECT_FLOAT_EQ(pattern_at(pattern_texture(WrinkledPattern{2, 0.5f}), p).r,
                  std::fabs(first) + 0.5f * std::fabs(second) + 0.25f * 0.2f);
  EXPECT_FLOAT_EQ(pattern_at(pattern_texture(WindyPattern()), p).r,
                  std::fabs(fbm(p * 0.1f, 0.5f, 3)) * fbm(p, 0.5f, 6));
}

TEST(Patterns, MaterialsSeeValuesFrom0ToTheGreatest) {
  const Texture high = pattern_texture(ProductPattern{{Rgb{3, -1, 0.5f}, -1}, {}}, 2);
  EXPECT_EQ(high.evaluate_procedural({}, TexturePoint()), (Rgb{2, 0, 0.5f}));
  EXPECT_EQ(pattern_at(high, {}), (Rgb{3, -1, 0.5f}));
}

TEST(Patterns, CheckerboardsAreCubesFromTheOrigin) {
  const Texture board = pattern_texture(CheckerboardPattern{{Rgb{1, 0, 0}, -1}, {Rgb{0, 1, 0}, -1}});
  EXPECT_EQ(pattern_at(board, {0.5f, 0.5f, 0.5f}), (Rgb{1, 0, 0}));
  EXPECT_EQ(pattern_at(board, {1.5f, 0.5f, 0.5f}), (Rgb{0, 1, 0}));
  EXPECT_EQ(pattern_at(board, {1.5f, -0.5f, 0.5f}), (Rgb{1, 0, 0}));
  EXPECT_EQ(pattern_at(board, {-0.5f, -0.5f, -0.5f}), (Rgb{0, 1, 0}));
}

TEST(Patterns, LieInTheirOwnCoordinates) {
  Texture board = pattern_texture(CheckerboardPattern());
  board.procedural->transform = compose(scaling({2, 2, 2}), translation({1, 0, 0}));
  EXPECT_EQ(pattern_at(board, {-0.75f, 0.1f, 0.1f}).r, 1);
  EXPECT_EQ(pattern_at(board, {-0.25f, 0.1f, 0.1f}).r, 0);
  board.procedural->space = PatternSpace::kUv;
  board.procedural->transform = scaling({4, 4, 1});
  EXPECT_EQ(board.evaluate_unclamped({}, Vec2{0.3f, 0.1f}).r, 0);
  EXPECT_EQ(board.evaluate_unclamped({}, Vec2{0.3f, 0.3f}).r, 1);
}

TEST(Patterns, DotsCoverTheirShareOfThePlane) {
  const Texture dots = pattern_texture(DotsPattern());
  int inside = 0;
  constexpr int kSide = 800;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      inside += pattern_at(dots, {0.08f * static_cast<float>(x), 0.08f * static_cast<float>(y), 0}).r > 0.5f
                    ? 1
                    : 0;
  // Two of five cells have a disk of radius 0.35.
  EXPECT_NEAR(static_cast<double>(inside) / (kSide * kSide), 0.4 * 3.14159 * 0.35 * 0.35, 0.01);
}

TEST(Patterns, MarbleHasTheColoursOfItsSpline) {
  const Texture marble = pattern_texture(MarblePattern{.variation = 0});
  // At the ends of the spline, where sin(y) is -1 or 1.
  const Rgb low = pattern_at(marble, {0, -3.14159265f / 2, 0}),
            high = pattern_at(marble, {0, 3.14159265f / 2, 0});
  EXPECT_NEAR(low.r, 1.5f * 0.58f, 1e-5f);
  EXPECT_NEAR(low.b, 1.5f * 0.6f, 1e-5f);
  EXPECT_NEAR(high.b, 1.5f * 0.6f, 1e-4f);
  // In the middle of the six segments, a control point.
  EXPECT_NEAR(pattern_at(marble, {0, 0, 0}).r, 1.5f * 0.5f, 1e-5f);
}

TEST(Patterns, CombineOthers) {
  const std::vector<Texture> all{pattern_texture(ProductPattern{{Rgb::gray(2), -1}, {Rgb::gray(3), -1}}),
                                 pattern_texture(PowerPattern{{Rgb::gray(0.5f), 0}, 2})};
  EXPECT_FLOAT_EQ(pattern_at(all[1], {}, all).r, 9);  // (6 / 2)²
  const Texture mix = pattern_texture(MixPattern{{Rgb::gray(-1), -1}, {Rgb::gray(1), 1}, 0.25f});
  EXPECT_FLOAT_EQ(pattern_at(mix, {}, all).r, -0.75f + 9.0f / 4);
}

TEST(Patterns, StepsCompareWhatIsInterpolated) {
  // Two texels of 0 and 1.
  const std::vector<Texture> all{
      {.image = std::make_shared<TextureImage>(2, 1, std::vector<float>{0, 0, 0, 1, 1, 1})},
      pattern_texture(StepPattern{{Rgb{1, 0.5f, 1}, 0}, 0.5f})};
  const auto at = [&](float u) { return all[1].evaluate_unclamped(all, Vec2{u, 0.5f}); };
  EXPECT_EQ(at(0.49f), Rgb());
  EXPECT_EQ(at(0.51f), (Rgb{1, 0, 1}));
  EXPECT_EQ(at(0.75f), Rgb::gray(1));
  EXPECT_EQ(all[1].mean(all), Rgb::gray(0.5f));
}

TEST(Patterns, FacingIsTheCosineToTheAxis) {
  Texture facing = pattern_texture(FacingPattern());
  facing.procedural->space = PatternSpace::kNormal;
  EXPECT_FLOAT_EQ(facing.evaluate_unclamped({}, {UvSets(), {5, 5, 5}, {0.6f, 0, -0.8f}}).r, 0.8f);
}

// Two layers of 3 x 2 voxels in a column: 10 z + x + 0.1 y at each of them.
std::vector<Texture> grid_of_layers(Wrap wrap, TextureFilter filter) {
  std::vector<float> voxels;
  for (int row = 0; row < 4; ++row)
    for (int x = 0; x < 3; ++x)
      voxels.insert(
          voxels.end(), 3,
          10 * static_cast<float>(row / 2) + static_cast<float>(x) + 0.1f * static_cast<float>(row % 2));
  std::vector<Texture> all{{.image = std::make_shared<TextureImage>(3, 4, std::move(voxels))}};
  all.push_back(pattern_texture(GridPattern{{Rgb::gray(2), 0}, 2, 1, wrap, filter}, 100));
  return all;
}

TEST(Patterns, GridsAreTrilinearBetweenVoxels) {
  const auto all = grid_of_layers(Wrap::kClamp, TextureFilter::kLinear);
  EXPECT_FLOAT_EQ(pattern_at(all[1], {0.5f, 0.25f, 0.25f}, all).r, 2 * 1.0f);
  EXPECT_FLOAT_EQ(pattern_at(all[1], {2.0f / 3, 0.5f, 0.5f}, all).r, 2 * (5 + 1.5f + 0.05f));
  // Beyond the outermost centres, and the cube.
  EXPECT_FLOAT_EQ(pattern_at(all[1], {0, 0, 0}, all).r, 0);
  EXPECT_FLOAT_EQ(pattern_at(all[1], {9, 9, 9}, all).r, 2 * 12.1f);
  EXPECT_FLOAT_EQ(pattern_at(all[1], {-9, 3e38f, -3e38f}, all).r, 2 * 0.1f);
}

TEST(Patterns, GridsRepeatOrAreMirrored) {
  const auto repeated = grid_of_layers(Wrap::kRepeat, TextureFilter::kNearest),
             mirrored = grid_of_layers(Wrap::kMirror, TextureFilter::kNearest),
             smooth = grid_of_layers(Wrap::kRepeat, TextureFilter::kLinear);
  EXPECT_FLOAT_EQ(pattern_at(repeated[1], {1.2f, -0.1f, 2.9f}, repeated).r, 2 * 10.1f);
  EXPECT_FLOAT_EQ(pattern_at(mirrored[1], {1.2f, -0.1f, 2.9f}, mirrored).r, 2 * 12.0f);
  EXPECT_FLOAT_EQ(pattern_at(smooth[1], {1, 0.25f, 0.25f}, smooth).r, 2 * 1.0f);  // between voxels 2 and 0
}

// Layers beside each other are those of a column.
TEST(Patterns, GridsMayHaveColumnsOfLayers) {
  const std::vector<Texture> all{
      {.image = std::make_shared<TextureImage>(2, 2, std::vector<float>{0, 0, 0, 1, 1, 1, 2, 2, 2, 9, 9, 9})},
      pattern_texture(GridPattern{{Rgb::gray(1), 0}, 3, 2, Wrap::kClamp, TextureFilter::kNearest}, 100)};
  for (const float layer : {0.0f, 1.0f, 2.0f})
    EXPECT_EQ(pattern_at(all[1], {0.5f, 0.5f, (layer + 0.5f) / 3}, all).r, layer);
}

// The texture coordinates that a projection gives to a point: of an image of a ramp along one of them.
Vec2 projected(Projection projection, Vec3 p) {
  const auto along = [&](bool is_v) {
    std::vector<float> ramp;
    for (int i = 0; i < 4096; ++i)
      ramp.insert(ramp.end(), 3, (static_cast<float>(is_v ? 4095 - i : i) + 0.5f) / 4096);
    const std::vector<Texture> all{
        {.image = std::make_shared<TextureImage>(is_v ? 1 : 4096, is_v ? 4096 : 1, std::move(ramp))},
        pattern_texture(ProjectedPattern{{Rgb::gray(1), 0}, projection})};
    return pattern_at(all[1], p, all).r;
  };
  return {along(false), along(true)};
}

TEST(Patterns, ProjectionsGiveTextureCoordinatesToSpace) {
  const auto expect = [](Vec2 got, Vec2 wanted) {
    EXPECT_NEAR(got.x, wanted.x, 2e-4f);
    EXPECT_NEAR(got.y, wanted.y, 2e-4f);
  };
  expect(projected(Projection::kPlanar, {0.3f, 1.7f, 9}), {0.3f, 0.7f});
  expect(projected(Projection::kSpherical, {0, 2, 0}), {0.5f, 0.25f});
  expect(projected(Projection::kSpherical, {-1, -1, std::sqrt(2.0f)}), {0.25f, 0.625f});
  expect(projected(Projection::kCylindrical, {3, 0, 0.2f}), {0.5f, 0.2f});
  expect(projected(Projection::kCylindrical, {0, -1, 5.9f}), {0.25f, 0.9f});
}

// As deep as textures may refer to each other, on a stack of a thread that is smaller than usual.
TEST(Patterns, ChainsOfTexturesFitOnTheStack) {
  std::vector<Texture> all{pattern_texture(FbmPattern())};
  while (static_cast<int>(all.size()) < kMaxTextureWeight) {
    const int last = static_cast<int>(all.size()) - 1;
    all.push_back(pattern_texture(MixPattern{{Rgb::gray(1), -1}, {Rgb::gray(1), last}, 0.999f}));
  }
  struct Work {
    const std::vector<Texture>& all;
    Rgb one{};
    RgbOf<FloatN> lanes{};
  } work{all};
  const auto evaluate_last = [](void* given) -> void* {
    auto& [textures, one, lanes] = *static_cast<Work*>(given);
    one = textures.back().evaluate_procedural(textures, {UvSets(), {0.3f, 0.4f, 0.5f}});
    lanes = textures.back().evaluate_procedural(
        textures, TexturePointOf<FloatN>(UvSetsOf<FloatN>(), {FloatN(0.3f), FloatN(0.4f), FloatN(0.5f)}));
    return nullptr;
  };
  constexpr std::size_t kStackBytes = std::size_t{2} << 20;
  pthread_attr_t small;
  ASSERT_EQ(pthread_attr_init(&small), 0);
  ASSERT_EQ(pthread_attr_setstacksize(&small, kStackBytes), 0);
  pthread_t thread{};
  ASSERT_EQ(pthread_create(&thread, &small, evaluate_last, &work), 0);
  ASSERT_EQ(pthread_join(thread, nullptr), 0);
  pthread_attr_destroy(&small);
  EXPECT_EQ(RgbLanes(work.lanes)[0], work.one);
  EXPECT_GT(work.one.r, 0);
}

std::vector<Texture> one_of_each() {
  std::vector<Texture> all{{.image = std::make_shared<TextureImage>(2, 2, std::vector<float>(12, 0.3f))},
                           pattern_texture(FbmPattern{5, 0.6f}),
                           pattern_texture(WrinkledPattern{}, 3),
                           pattern_texture(WindyPattern{}),
                           pattern_texture(MarblePattern{.scale = 3, .variation = 2}),
                           pattern_texture(DotsPattern{{Rgb::gray(1), 4}, {Rgb{0.1f, 0.5f, 0.2f}, 0}}),
                           pattern_texture(CheckerboardPattern{{Rgb::gray(1), 1}, {Rgb::gray(1), 5}}),
                           pattern_texture(MixPattern{{Rgb::gray(1), 4}, {Rgb{1, 0, 0}, -1}, {1, 2}}),
                           pattern_texture(ProductPattern{{Rgb::gray(1), 3}, {Rgb{1, 2, 3}, 7}}, 5),
                           pattern_texture(PowerPattern{{Rgb::gray(1), 1}, 0.25f}),
                           pattern_texture(FacingPattern()),
                           pattern_texture(GridPattern{{Rgb{1, 2, 3}, 0}, 3, 2, Wrap::kMirror}),
                           pattern_texture(ProjectedPattern{{Rgb::gray(1), 6}, Projection::kSpherical}),
                           pattern_texture(StepPattern{{Rgb{1, 2, 0.5f}, 4}, 0.6f})};
  all[10].procedural->space = PatternSpace::kNormal;
  all[1].procedural->transform = compose(rotation({1, 2, 3}, 40), scaling({2, 3, 4}));
  all[5].procedural->space = PatternSpace::kUv;
  all[5].procedural->transform = scaling({7, 5, 1});
  all[6].uv_set = UvSet::kSecond;
  all[6].procedural->space = PatternSpace::kUv;
  return all;
}

TEST(Patterns, LanesHaveTheBitsOfScalars) {
  const std::vector<Texture> all = one_of_each();
  std::mt19937 random(2);
  std::uniform_real_distribution<float> usual(-20, 20);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr std::array kOdd{kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN(), 3e38f, -1e9f,
                            -3.0f,     0.0f};
  const auto coordinate = [&](std::mt19937& from) {
    return from() % 16 == 0 ? kOdd[from() % kOdd.size()] : usual(from);
  };
  for (int i = 0; i < 300; ++i) {
    std::array<ColorParameter, kLaneCount> colors;
    std::array<const ColorParameter*, kLaneCount> pointers{};
    std::array<ScalarParameter, kLaneCount> numbers;
    std::array<const ScalarParameter*, kLaneCount> number_pointers{};
    std::array<TexturePoint, kLaneCount> points;
    FloatLanes u, v, second_u, second_v;
    Vec3Lanes position, normal;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const int texture = static_cast<int>(random() % (all.size() + 1)) - 1;
      colors[lane] = {{0.5f, 0.6f, 0.7f}, i % 3 == 0 ? 8 : texture};
      numbers[lane] = {0.8f, texture};
      pointers[lane] = &colors[lane];
      number_pointers[lane] = &numbers[lane];
      points[lane] = {UvSets({coordinate(random), coordinate(random)}, {coordinate(random), 0.25f}),
                      {coordinate(random), coordinate(random), coordinate(random)},
                      {usual(random), usual(random), usual(random)}};
      u.set(lane, points[lane].uv.first.x), v.set(lane, points[lane].uv.first.y);
      second_u.set(lane, points[lane].uv.second.x), second_v.set(lane, points[lane].uv.second.y);
      position.set(lane, points[lane].position), normal.set(lane, points[lane].normal);
    }
    using Uv = Vec2Of<FloatN>;
    const TexturePointOf<FloatN> together(
        UvSetsOf<FloatN>(Uv{u.all(), v.all()}, Uv{second_u.all(), second_v.all()}), position.all(),
        normal.all());
    const RgbLanes in_lanes(evaluate(pointers, all, together));
    const FloatLanes numbers_in_lanes(evaluate(number_pointers, all, together));
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      ASSERT_EQ(in_lanes[lane], colors[lane].evaluate(all, points[lane])) << colors[lane].texture;
      ASSERT_EQ(numbers_in_lanes[lane], numbers[lane].evaluate(all, points[lane])) << numbers[lane].texture;
    }
  }
}

Result<SceneDescription> scene_of_textures(const std::string& textures, const std::string& albedo = "\"t\"") {
  const std::string text = R"({"camera": {"position": [0, 0, 3], "look_at": [0, 0, 0]}, "textures": {)" +
                           textures + R"(}, "materials": {"m": {"type": "lambert", "albedo": {"texture": )" +
                           albedo +
                           R"(}}}, "environment": {"radiance": 1},
                           "shapes": [{"type": "sphere", "radius": 1, "material": "m"}]})";
  MemoryAssets assets({{"scene.json", text}});
  return load_scene(assets, "scene.json", "scene.json");
}

std::string mistake_of_textures(const std::string& textures) {
  const auto scene = scene_of_textures(textures);
  return scene ? "none" : scene.error().message;
}

TEST(ProceduralKeys, AreThoseOfTheirType) {
  const auto scene = scene_of_textures(
      R"("a": {"type": "fbm", "octaves": 3, "roughness": 0.7, "transform": [{"scale": 2}]},
         "t": {"type": "mix", "first": [0, 0, 1], "second": {"texture": "a", "tint": 0.5}, "amount": 0.3,
               "coordinates": "uv", "uv_set": "second", "max": 0.9})");
  ASSERT_TRUE(scene.has_value()) << scene.error().message;
  const Texture &noise = scene->textures.at(0), &mix = scene->textures.at(1);
  EXPECT_EQ(noise.procedural->pattern, Pattern(FbmPattern{3, 0.7f}));
  EXPECT_EQ(noise.procedural->transform, scaling({2, 2, 2}));
  EXPECT_EQ(mix.procedural->pattern, Pattern(MixPattern{{Rgb{0, 0, 1}, -1}, {Rgb::gray(0.5f), 0}, 0.3f}));
  EXPECT_EQ(mix.procedural->space, PatternSpace::kUv);
  EXPECT_EQ(mix.uv_set, UvSet::kSecond);
  EXPECT_EQ(mix.procedural->max, 0.9f);
}

TEST(ProceduralKeys, MistakesAreTold) {
  EXPECT_THAT(mistake_of_textures(R"("t": {"type": "marbel"})"), HasSubstr("did you mean 'marble'"));
  EXPECT_THAT(mistake_of_textures(R"("t": {"type": "fbm", "octaves": 99})"), HasSubstr("octaves"));
  EXPECT_THAT(mistake_of_textures(R"("t": {"type": "fbm", "file": "a.png"})"), HasSubstr("file"));
  EXPECT_THAT(mistake_of_textures(
                  R"("t": {"type": "power", "base": {"texture": "later"}}, "later": {"type": "windy"})"),
              HasSubstr("there is no texture"));
  EXPECT_THAT(mistake_of_textures(R"("t": {"type": "mix", "amount": {"keyframes": [{"frame": 0, "value": 0},
                                                                        {"frame": 9, "value": 1}]}})"),
              HasSubstr("cannot be animated"));
}

TEST(ProceduralKeys, GridsNeedImagesOfWholeLayers) {
  auto scene =
      scene_of_textures(R"("w": {"type": "windy"}, "t": {"type": "grid", "layers": {"texture": "w"}})");
  ASSERT_TRUE(scene.has_value()) << scene.error().message;
  EXPECT_THAT(validate_scene(*scene).error().message, HasSubstr("layers: the texture must be an image"));
  scene->textures.at(0) = {.image = std::make_shared<TextureImage>(4, 6, std::vector<float>(72, 0.5f))};
  EXPECT_TRUE(validate_scene(*scene).has_value());
  std::get<GridPattern>(scene->textures.at(1).procedural->pattern).depth = 4;
  EXPECT_THAT(validate_scene(*scene).error().message,
              HasSubstr("4 x 6 cannot be divided into 1 columns and 4 rows"));
}

TEST(ProceduralKeys, NormalMapsNeedImages) {
  auto scene = scene_of_textures(R"("t": {"type": "windy"})");
  ASSERT_TRUE(scene.has_value());
  scene->materials.at(0).normal_map.texture = 0;
  EXPECT_THAT(validate_scene(*scene).error().message, HasSubstr("normal_map: the texture must be an image"));
}

// Each refers twice to the one before, so 20 of them would evaluate a million.
TEST(ProceduralKeys, TexturesOfTexturesAreLimited) {
  std::string textures = R"("t": {"type": "windy"})", last = "t";
  for (int i = 0; i < 20; ++i) {
    const std::string name = "p" + std::to_string(i);
    textures += ", \"" + name + R"(": {"type": "product", "first": {"texture": ")" + last +
                R"("}, "second": {"texture": ")" + last + R"("}})";
    last = name;
  }
  const auto scene = scene_of_textures(textures);
  const std::string message = scene ? validate_scene(*scene).error().message : scene.error().message;
  EXPECT_THAT(message, HasSubstr("refers to more than 500 textures"));
}

}  // namespace
}  // namespace tessera::core::test
