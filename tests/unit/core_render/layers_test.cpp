// SPDX-License-Identifier: Apache-2.0
// Layers of renders: they leave the beauty alone, do not depend on how a render is cut up, and hold what they
// say.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <random>
#include <string>

#include "core/film/develop.hpp"
#include "core/integrators/render.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

// The values of an image with layers, by the names of its channels.
class LayeredImage {
 public:
  explicit LayeredImage(const FilmTile& tile)
      : width_(tile.rect.width()),
        names_(image_channels(tile.layers)),
        values_(tile.rect.pixel_count() * names_.size()) {
    const Film::TileSums sums{tile.sums, tile.odd_sums, tile.range.count(), tile.range.odd_count(),
                              tile.planes};
    develop_layers(tile.layers, tile.rect, sums, values_);
  }

  float at(int x, int y, const std::string& name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    EXPECT_NE(found, names_.end()) << name;
    return values_[static_cast<std::size_t>(y * width_ + x) * names_.size() +
                   static_cast<std::size_t>(found - names_.begin())];
  }
  Rgb color(int x, int y, const std::string& layer) const {
    return {at(x, y, layer + "R"), at(x, y, layer + "G"), at(x, y, layer + "B")};
  }

 private:
  int width_;
  std::vector<std::string> names_;
  std::vector<float> values_;
};

FilmTile render_layers(const Scene& scene, RenderSettings settings, LayerSet layers, int threads = 2) {
  settings.layers = layers;
  return render(prepare(scene, settings, threads), settings.window(), {0, settings.spp}, threads);
}

// The room with an environment, a sheet that is half transparent, an instance, and fog if that is wanted.
SceneDescription varied_room(bool fog) {
  SceneDescription room = test::room();
  room.environment = {{Rgb{0.2f, 0.3f, 0.4f}}};
  room.environment->light_group = "sky";
  room.materials[2].light_group = "lamp";
  room.materials[3].light_group = "ember";
  Material sheet{"sheet", test::lambert(0.4f)};
  sheet.opacity = 0.5f;
  room.materials.push_back(sheet);
  const auto of_sheet = static_cast<std::uint32_t>(room.materials.size() - 1);
  room.shapes.emplace_back(QuadDescription{{-0.6f, 0.8f, 1.2f}, {1.2f, 0, 0}, {0, 0.5f, 0}, of_sheet});
  room.objects.push_back({"ball", {SphereDescription{{0, 0, 0}, 0.2f, 0}}, {"sphere"}});
  room.shapes.emplace_back(InstanceDescription{0, translation({0.2f, 1.4f, 0}), std::nullopt});
  if (fog) {
    room.media = {{.sigma_a = Rgb::gray(0.05f), .sigma_s = Rgb::gray(0.2f)}};
    room.camera_medium = 0;
  }
  room.settings.spp = 6;
  return room;
}

struct RenderCase {
  const char* name;
  Integrator integrator;
  bool fog = false;
  float clamp = 0;
};
constexpr std::array kRenderCases{RenderCase{"mis", Integrator::kMis},
                                  RenderCase{"clamped", Integrator::kMis, false, 0.5f},
                                  RenderCase{"naive", Integrator::kNaive},
                                  RenderCase{"nee", Integrator::kNee},
                                  RenderCase{"whitted", Integrator::kWhitted},
                                  RenderCase{"fog", Integrator::kMis, true},
                                  RenderCase{"clamped_fog", Integrator::kMis, true, 0.5f}};

class Layered : public testing::TestWithParam<RenderCase> {
 protected:
  Layered() : scene_(room(GetParam().fog)), settings_(scene_.settings()) {
    settings_.integrator = GetParam().integrator;
    settings_.clamp_indirect = GetParam().clamp;
  }

  // Built once, with what integrators prepare for it.
  static const Scene& room(bool fog) {
    static const std::array<Scene, 2> kRooms{Scene::build(varied_room(false), 2).value(),
                                             Scene::build(varied_room(true), 2).value()};
    return kRooms[fog ? 1 : 0];
  }

  const Scene& scene_;
  RenderSettings settings_;
};
INSTANTIATE_TEST_SUITE_P(All, Layered, testing::ValuesIn(kRenderCases),
                         [](const auto& of) { return std::string(of.param.name); });

TEST_P(Layered, LeaveTheBeautyAlone) {
  const FilmTile plain = render_layers(scene_, settings_, {});
  const FilmTile layered = render_layers(scene_, settings_, kAllLayers);
  EXPECT_EQ(layered.sums, plain.sums);
  EXPECT_EQ(layered.odd_sums, plain.odd_sums);
  EXPECT_TRUE(plain.planes.empty());
  const RenderCounters a = plain.counters, b = layered.counters;
  EXPECT_EQ(a.samples, b.samples);
  EXPECT_EQ(a.shadow_rays, b.shadow_rays);
}

TEST_P(Layered, OfLightAddUpToTheBeauty) {
  const LayeredImage image(render_layers(scene_, settings_, kAllLayers));
  double found = 0;
  for (int y = 0; y < settings_.height_px; ++y)
    for (int x = 0; x < settings_.width_px; ++x) {
      const Rgb beauty = image.color(x, y, "");
      const Rgb sum = image.color(x, y, "Direct.") + image.color(x, y, "Indirect.") +
                      image.color(x, y, "Emit.") + image.color(x, y, "Env.");
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(sum[c], beauty[c], 1e-6f + 1e-5f * beauty[c]) << x << ", " << y << ", " << c;
      found += static_cast<double>(beauty.r);
    }
  EXPECT_GT(found, 1);
}

TEST_P(Layered, OfLightGroupsAddUpToTheBeautyWithoutClamp) {
  settings_.clamp_indirect = 0;
  const LayerSet layers = with_group_names(kAllLayers, scene_.light_groups()).value();
  EXPECT_EQ(layers.groups, (std::vector<std::string>{"ember", "lamp", "sky"}));
  const LayeredImage image(render_layers(scene_, settings_, layers));
  std::array<double, 3> found{};
  for (int y = 0; y < settings_.height_px; ++y)
    for (int x = 0; x < settings_.width_px; ++x) {
      const Rgb beauty = image.color(x, y, "");
      Rgb sum{};
      for (std::size_t i = 0; i < layers.groups.size(); ++i) {
        const Rgb part = image.color(x, y, group_channel(layers.groups[i]) + ".");
        found[i] += static_cast<double>(part.r);
        sum += part;
      }
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(sum[c], beauty[c], 1e-6f + 1e-5f * beauty[c]) << x << ", " << y << ", " << c;
    }
  // Nothing of the sky comes through fog without end.
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool is_hidden = GetParam().fog && layers.groups[i] == "sky";
    EXPECT_GT(found[i], is_hidden ? -1 : 1) << layers.groups[i];
  }
}

TEST_P(Layered, OfLightGroupsAreThoseThatAreAskedFor) {
  LayerSet one = LayerSet{}.with(Layer::kDepth).with(Layer::kStandardError);
  one.groups = {"sky"};
  const FilmTile alone = render_layers(scene_, settings_, one);
  const LayerSet layers = with_group_names(kAllLayers, scene_.light_groups()).value();
  const LayeredImage all(render_layers(scene_, settings_, layers)), some(alone);
  EXPECT_EQ(alone.planes.size(), 4u);
  for (int x = 0; x < settings_.width_px; ++x)
    EXPECT_EQ(some.color(x, 9, "Combined_sky."), all.color(x, 9, "Combined_sky.")) << x;
}

TEST_P(Layered, HaveTheSameBytesHoweverARenderIsCutUp) {
  settings_.layers = with_group_names(kAllLayers, scene_.light_groups()).value();
  const TileGrid grid(settings_.window(), 16);
  Film whole(grid, settings_.layers), pieces(grid, settings_.layers);
  const RenderPlan plan = prepare(scene_, settings_, 3);
  whole.add(render(plan, grid.window(), {0, settings_.spp}, 3));
  std::mt19937 random(5);
  std::vector<std::pair<int, SampleRange>> work;
  for (int tile = 0; tile < grid.tile_count(); ++tile)
    for (const SampleRange range : {SampleRange{0, 1}, SampleRange{1, 4}, SampleRange{4, settings_.spp}})
      work.emplace_back(tile, range);
  std::shuffle(work.begin(), work.end(), random);
  for (const auto& [tile, range] : work) pieces.add(render(plan, grid.rect(tile), range, 1));
  EXPECT_TRUE(pieces == whole);
  const FilmLayout layout = film_layout(settings_.layers);
  for (int tile = 0; tile < grid.tile_count(); ++tile) {
    const auto possible = check_planes(layout, whole.tile(tile).planes, grid.rect(tile), settings_.spp);
    EXPECT_TRUE(possible) << possible.error().message;
  }
}

TEST_P(Layered, DoNotDependOnTheOtherLayers) {
  const LayerSet some = LayerSet{}.with(Layer::kIndirect).with(Layer::kCryptoMaterial);
  const FilmTile all = render_layers(scene_, settings_, kAllLayers),
                 few = render_layers(scene_, settings_, some);
  ASSERT_EQ(few.planes.size(), 4u);
  EXPECT_EQ(few.planes[0], all.planes[first_plane(kAllLayers, Layer::kIndirect)]);
  EXPECT_EQ(few.planes[3], all.planes[first_plane(kAllLayers, Layer::kCryptoMaterial)]);
}

// A wall that faces the camera, a lamp in front of its left half, and the environment where the wall ends.
class Wall : public testing::Test {
 protected:
  static SceneDescription describe() {
    test::SceneMaker maker({.position = {0, 0, 4}, .look_at = {0, 0, 0}});
    const auto wall = maker.material(Lambert{{{0.5f, 0.25f, 0.125f}, -1}});
    const auto lamp = maker.material(test::lambert(0), {2, 2, 2});
    maker.add(QuadDescription{{-10, -10, 0}, {10.0f, 0, 0}, {0, 20, 0}, wall});
    maker.add(QuadDescription{{-0.9f, -0.5f, 1}, {0.8f, 0, 0}, {0, 1, 0}, lamp});
    maker.description().shape_names = {"wall", "lamp"};
    maker.description().environment = {{Rgb::gray(0.25f)}};
    maker.description().settings = {.width_px = 32, .height_px = 8, .spp = 4};
    return maker.description();
  }

  const SceneDescription description_ = describe();
  const Scene scene_ = Scene::build(description_, 1).value();
  const LayeredImage image_{render_layers(scene_, scene_.settings(), kAllLayers)};
};

TEST_F(Wall, IsDescribedAtItsFirstSurface) {
  EXPECT_EQ(image_.at(2, 4, "A"), 1);
  EXPECT_NEAR(image_.at(2, 4, "Depth.Z"), 4, 1e-5);
  EXPECT_NEAR(image_.at(2, 4, "Normal.Z"), 1, 1e-5);
  EXPECT_NEAR(image_.at(2, 4, "Position.Z"), 0, 1e-5);
  EXPECT_NEAR(image_.at(2, 4, "Position.X"), 10 * (image_.at(2, 4, "UV.U") - 1), 1e-4);
  EXPECT_NEAR(image_.at(2, 4, "DiffCol.G"), 0.25, 1e-6);
  EXPECT_EQ(image_.at(2, 4, "IndexOB.X"), 1);
  EXPECT_EQ(image_.at(2, 4, "IndexMA.X"), 1);
  EXPECT_EQ(image_.at(2, 4, "InstanceID.X"), 0);
  EXPECT_EQ(image_.at(2, 4, "Debug Sample Count.X"), 4);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(image_.at(2, 4, "CryptoObject00.r")), crypto_id("wall"));
  EXPECT_EQ(image_.at(2, 4, "CryptoObject00.g"), 1);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(image_.at(2, 4, "CryptoMaterial00.r")), crypto_id("m0"));
  EXPECT_EQ(std::bit_cast<std::uint32_t>(image_.at(2, 4, "CryptoAsset00.r")), crypto_id("wall"));
}

TEST_F(Wall, EndsWhereTheEnvironmentBegins) {
  EXPECT_EQ(image_.at(30, 4, "A"), 0);
  EXPECT_EQ(image_.at(30, 4, "Depth.Z"), kNoDepth);
  EXPECT_EQ(image_.at(30, 4, "IndexOB.X"), 0);
  EXPECT_EQ(image_.at(30, 4, "CryptoObject00.g"), 0);
  EXPECT_EQ(image_.color(30, 4, "Env."), Rgb::gray(0.25f));
  EXPECT_EQ(image_.color(30, 4, ""), Rgb::gray(0.25f));
}

TEST_F(Wall, LampsAreEmissionAndLightTheWallDirectly) {
  float most = 0;
  for (int x = 0; x < 32; ++x) most = std::max(most, image_.at(x, 4, "Emit.R"));
  EXPECT_EQ(most, 2);
  EXPECT_GT(image_.at(2, 4, "Direct.R"), 0);
  EXPECT_EQ(image_.at(2, 4, "Emit.R"), 0);
  EXPECT_EQ(image_.at(2, 4, "Env.R"), 0);
}

TEST_F(Wall, NamesAreThoseOfTheManifest) {
  const CryptoNames names = crypto_names(description_);
  EXPECT_EQ(names.objects, (std::vector<std::string>{"wall", "lamp"}));
  EXPECT_EQ(names.assets, names.objects);
  EXPECT_EQ(names.materials, (std::vector<std::string>{"m0", "m1"}));
}

TEST(FirstSurfaces, AreSeenThroughWhatRaysPassBy) {
  test::SceneMaker maker({.position = {0, 0, 4}, .look_at = {0, 0, 0}});
  const auto wall = maker.material(test::lambert(0.5f));
  const auto nothing = maker.material(Null{});
  const auto glass = maker.material(Glass{});
  maker.add(QuadDescription{{-10, -10, 0}, {20, 0, 0}, {0, 20, 0}, wall});
  maker.add(QuadDescription{{-10, -10, 2}, {20, 0, 0}, {0, 20, 0}, nothing});
  maker.description().settings = {.width_px = 4, .height_px = 4, .spp = 2};
  const LayerSet layers =
      LayerSet{}.with(Layer::kDepth).with(Layer::kObjectIndex).with(Layer::kInstanceIndex);
  const LayeredImage through(render_layers(maker.build(), maker.description().settings, layers));
  EXPECT_NEAR(through.at(1, 1, "Depth.Z"), 4, 1e-5);
  EXPECT_EQ(through.at(1, 1, "IndexOB.X"), 1);
  // Glass is a surface of its own.
  maker.add(SphereDescription{{0, 0, 2}, 0.9f, glass});
  maker.description().objects.push_back({"ball", {SphereDescription{{0, 0, 0}, 0.1f, wall}}, {"sphere"}});
  maker.add(InstanceDescription{0, translation({50, 0, 0}), std::nullopt});
  maker.add(InstanceDescription{0, translation({0, 0, 3.2f}), std::nullopt});
  const LayeredImage before(render_layers(maker.build(), maker.description().settings, layers));
  EXPECT_EQ(before.at(0, 1, "IndexOB.X"), 3);
  EXPECT_LT(before.at(0, 1, "Depth.Z"), 3);
  EXPECT_EQ(before.at(0, 1, "InstanceID.X"), 0);
}

// The matte of a surface whose opacity is a half covers about half of its pixels.
TEST(FirstSurfaces, AreMetAsOftenAsTheyAreOpaque) {
  test::SceneMaker maker({.position = {0, 0, 4}, .look_at = {0, 0, 0}});
  const auto sheet = maker.material(test::lambert(0.5f));
  maker.description().materials[sheet].opacity = 0.5f;
  maker.add(QuadDescription{{-10, -10, 0}, {20, 0, 0}, {0, 20, 0}, sheet});
  maker.description().settings = {.width_px = 8, .height_px = 8, .spp = 64};
  const LayerSet layers = LayerSet{}.with(Layer::kAlpha).with(Layer::kCryptoObject);
  for (const Integrator integrator : {Integrator::kMis, Integrator::kWhitted}) {
    RenderSettings settings = maker.description().settings;
    settings.integrator = integrator;
    const LayeredImage image(render_layers(maker.build(), settings, layers));
    for (int x = 0; x < 8; ++x) {
      EXPECT_NEAR(image.at(x, 3, "A"), 0.5, 0.25);
      EXPECT_EQ(image.at(x, 3, "CryptoObject00.g"), image.at(x, 3, "A")) << "paths and mattes pass alike";
    }
  }
}

TEST(FirstSurfaces, CountInstancesFromOne) {
  test::SceneMaker maker({.position = {0, 0, 4}, .look_at = {0, 0, 0}});
  const auto white = maker.material(test::lambert(0.5f));
  maker.description().objects.push_back({"ball", {SphereDescription{{0, 0, 0}, 3, white}}, {"sphere"}});
  maker.add(SphereDescription{{50, 0, 0}, 1, white});
  maker.add(InstanceDescription{0, translation({90, 0, 0}), std::nullopt});
  maker.add(InstanceDescription{0, translation({0, 0, 0}), std::nullopt});
  maker.description().settings = {.width_px = 2, .height_px = 2, .spp = 1};
  const LayeredImage image(render_layers(maker.build(), maker.description().settings, kAllLayers));
  EXPECT_EQ(image.at(1, 1, "IndexOB.X"), 3);
  EXPECT_EQ(image.at(1, 1, "InstanceID.X"), 2);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(image.at(1, 1, "CryptoAsset00.r")), crypto_id("ball"));
  EXPECT_EQ(std::bit_cast<std::uint32_t>(image.at(1, 1, "CryptoObject00.r")), crypto_id("shapes[2]"));
}

// Where all lights are sampled alone, a group is the image of its lights but for rounding.
TEST(LightGroups, AreTheImagesOfTheirLights) {
  const auto scene_of = [](bool key, bool fill) {
    test::SceneMaker maker({.position = {0, 1, 4}, .look_at = {0, 1, 0}});
    const auto white = maker.material(test::lambert(0.7f));
    maker.material(Mirror{{Rgb::gray(0.8f), -1}});
    maker.add(QuadDescription{{-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, white});
    maker.add(SphereDescription{{0, 0.8f, 0}, 0.8f, 1});
    SceneDescription& scene = maker.description();
    if (key) scene.lights.push_back(DirectionalLightDescription{{1, -1, -1}, {3, 2, 1}, "key"});
    if (fill) scene.lights.push_back(DirectionalLightDescription{{-1, -2, 0}, {0, 1, 2}, "fill"});
    scene.settings = {.width_px = 24, .height_px = 20, .spp = 2, .integrator = Integrator::kWhitted};
    return Scene::build(scene, 1).value();
  };
  const Scene both = scene_of(true, true);
  const LayerSet layers = with_group_names({0, true}, both.light_groups()).value();
  const LayeredImage image(render_layers(both, both.settings(), layers));
  const Scene key_alone = scene_of(true, false), fill_alone = scene_of(false, true);
  const LayeredImage key(render_layers(key_alone, key_alone.settings(), {})),
      fill(render_layers(fill_alone, fill_alone.settings(), {}));
  double sum = 0;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 24; ++x) {
      for (const char* const c : {"R", "G", "B"}) {
        EXPECT_NEAR(image.at(x, y, std::string("Combined_key.") + c), key.at(x, y, c), 1e-6f);
        EXPECT_NEAR(image.at(x, y, std::string("Combined_fill.") + c), fill.at(x, y, c), 1e-6f);
      }
      sum += static_cast<double>(key.at(x, y, "R"));
    }
  EXPECT_GT(sum, 10);
}

TEST(LightGroups, OfTheSceneAreNamedInItsSettings) {
  SceneDescription room = varied_room(false);
  room.settings.layers.light_groups = true;
  EXPECT_EQ(Scene::build(room, 1).value().settings().layers.groups.size(), 3u);
  room.settings.layers.groups = {"moon"};
  EXPECT_EQ(Scene::build(room, 1).error().message,
            "layers: there is no light group 'moon'; the scene has ember, lamp, sky");
  const auto all = resolve_settings(varied_room(false), {.layers = kAllLayers});
  EXPECT_EQ(layer_names(all->layers).back(), "group.sky");
  EXPECT_EQ(resolve_settings(test::room(), {.layers = kAllLayers})->layers, LayerSet{kAllLayers.bits});
  room = varied_room(false);
  room.materials[0].light_group = "a.b";
  EXPECT_NE(Scene::build(room, 1).error().message.find("group must be 1 to 64 letters"), std::string::npos);
}

}  // namespace
}  // namespace tessera::core::integrators
