// SPDX-License-Identifier: Apache-2.0
// A scene that one process has loaded and another builds: it loses nothing, and nothing else passes for one.
#include "core/scene/cache/loaded_scene.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/integrators/fingerprint.hpp"
#include "core/scene/cache/archive.hpp"
#include "core/scene/cache/scene_maker.hpp"
#include "core/scene/scene.hpp"
#include "tests/support/temporary_folder.hpp"

namespace tessera::core {
namespace {

using testing::HasSubstr;

class LoadedScene : public testing::Test {
 protected:
  OpenFile open(int flags = O_RDWR) const { return OpenFile(::open(path().c_str(), flags | O_CREAT, 0600)); }
  std::string path() const { return folder_.path() / "file"; }

  // What is read after `loaded` was written.
  Result<SceneDescription> passed(const Result<SceneDescription>& loaded) const {
    EXPECT_TRUE(write_loaded(open(O_RDWR | O_TRUNC), loaded));
    return read_loaded(open(), 2);
  }
  std::string error_of(const Result<SceneDescription>& loaded) const {
    const auto read = passed(loaded);
    return read ? "no error" : read.error().message;
  }
  // Of a scene with something of everything, after this change.
  std::string error_after(const std::function<void(SceneDescription&)>& change) const {
    SceneDescription scene = integrators::fingerprint_scene();
    change(scene);
    return error_of(scene);
  }
  // Writes the start of a loaded scene, and then these numbers.
  template <typename... Numbers>
  std::string error_of_index(Numbers... numbers) const {
    auto out = BlockFileWriter::to(open(O_RDWR | O_TRUNC), "", stored::file_version(), 1);
    stored::Writer writer(out);
    (writer(numbers), ...);
    EXPECT_TRUE(out.finish(writer.bytes()));
    const auto read = read_loaded(open(), 1);
    return read ? "no error" : read.error().message;
  }

  TemporaryFolder folder_;
};

constexpr const char* kDamaged = "the process that loads scenes has written what no scene is";

MeshDescription& mesh_of(SceneDescription& scene) {
  for (ShapeDescription& shape : scene.shapes)
    if (auto* const mesh = std::get_if<MeshDescription>(&shape)) return *mesh;
  return std::get<MeshDescription>(scene.shapes.emplace_back());
}

TEST_F(LoadedScene, LosesNothing) {
  const auto read = passed(integrators::fingerprint_scene());
  ASSERT_TRUE(read) << read.error().message;
  const std::string first = read_file(path());
  ASSERT_TRUE(passed(*read));
  EXPECT_TRUE(read_file(path()) == first);
  EXPECT_TRUE(Scene::build(*read, 1)->bvh() == Scene::build(integrators::fingerprint_scene(), 1)->bvh());
}

TEST_F(LoadedScene, KeepsSecondTextureCoordinates) {
  SceneDescription scene = integrators::fingerprint_scene();
  MeshDescription& mesh = mesh_of(scene);
  mesh.uvs.resize(mesh.positions.size());
  mesh.second_uvs.assign(mesh.positions.size(), {0.25f, 7});
  scene.textures.at(0).uv_set = UvSet::kSecond;
  const auto read = passed(scene);
  ASSERT_TRUE(read) << read.error().message;
  SceneDescription copy = *read;
  EXPECT_EQ(mesh_of(copy).second_uvs, mesh.second_uvs);
  EXPECT_EQ(read->textures.at(0).uv_set, UvSet::kSecond);
}

TEST_F(LoadedScene, KeepsProceduralTextures) {
  SceneDescription scene = integrators::fingerprint_scene();
  const auto last = static_cast<int>(scene.textures.size());
  const ProceduralTexture marble{MarblePattern{3, 0.25f, 2, 0.5f}, PatternSpace::kUv, scaling({2, 3, 4}),
                                 0.75f};
  scene.textures.push_back({.image = nullptr, .uv_set = UvSet::kSecond, .procedural = marble});
  scene.textures.push_back(
      {.image = nullptr,
       .procedural = ProceduralTexture{MixPattern{{Rgb::gray(0.5f), last}, {Rgb{1, 0, 0}, -1}, {0.5f, 0}}}});
  const auto read = passed(scene);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->textures.at(static_cast<std::size_t>(last)).procedural, marble);
  EXPECT_EQ(read->textures.back().procedural, scene.textures.back().procedural);
  EXPECT_EQ(read->textures.back().image, nullptr);
}

TEST_F(LoadedScene, KeepsTangents) {
  SceneDescription scene = integrators::fingerprint_scene();
  MeshDescription& mesh = mesh_of(scene);
  mesh.tangents.assign(mesh.positions.size(), {{0.5f, 1, 2}, -1});
  const auto read = passed(scene);
  ASSERT_TRUE(read) << read.error().message;
  SceneDescription copy = *read;
  EXPECT_EQ(mesh_of(copy).tangents, mesh.tangents);
  mesh.tangents[0].direction.x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(passed(scene));
}

TEST_F(LoadedScene, KeepsMedia) {
  SceneDescription scene = integrators::fingerprint_scene();
  scene.grids = {{.size = {2, 1, 1}, .values = {1, 2}, .border = GridBorder::kZero}};
  scene.media = {{.name = "smoke", .sigma_s = {1, 2, 3}, .g = 0.5f, .scattering_grid = 0}};
  scene.materials[0].media.interior = 0;
  scene.camera_medium = 0;
  const auto read = passed(scene);
  ASSERT_TRUE(read) << read.error().message;
  const std::string first = read_file(path());
  ASSERT_TRUE(passed(*read));
  EXPECT_TRUE(read_file(path()) == first);
  EXPECT_EQ(read->grids.at(0).values, scene.grids[0].values);
  EXPECT_EQ(read->media.at(0).sigma_s, scene.media[0].sigma_s);
  EXPECT_EQ(read->materials[0].media, scene.materials[0].media);
  EXPECT_EQ(read->camera_medium, 0);
}

// A scene with keyframes of every kind.
SceneDescription animated_scene() {
  SceneDescription scene = integrators::fingerprint_scene();
  scene.objects.push_back({"ball", {SphereDescription{{0, 0, 0}, 1, 0}}, {}});
  scene.shapes.emplace_back(
      InstanceDescription{static_cast<std::uint32_t>(scene.objects.size()) - 1, {}, std::nullopt});
  scene.lights.emplace_back(PointLightDescription{{0, 9, 0}, {1, 1, 1}});
  Animation& animation = scene.animation;
  animation.camera.vertical_fov_degrees = {{1, 2}, {40, 41}};
  animation.lights = {{.light = static_cast<std::uint32_t>(scene.lights.size()) - 1,
                       .position = {{1, 2}, {{0, 9, 0}, {1, 9, 0}}},
                       .color = {{1, 3}, {{1, 1, 1}, {2, 2, 2}}}}};
  animation.instances = {{static_cast<std::uint32_t>(scene.shapes.size()) - 1,
                          {translation({1, 2, 3}), ScaleMotion{{{1, 2}, {{1, 1, 1}, {2, 2, 2}}}},
                           TurnMotion{{0, 1, 0}, {{1, 2}, {0, 360}}},
                           RotationMotion{{{1, 2}, {Quaternion{}, rotation_quaternion({1, 0, 0}, 90)}}},
                           TranslationMotion{{{1, 2}, {{0, 0, 0}, {5, 0, 0}}}}}}};
  animation.materials = {{0, {{{"opacity", {{1, 2}, {1, 0.5f}}}}, {{"emission", {{1}, {{0, 0, 0}}}}}}}};
  scene.media = {{.name = "fog"}};
  animation.media = {{0, {{{"scale", {{1, 2}, {1, 2}}}}, {}}}};
  animation.environment = {{{"rotation_degrees", {{1, 2}, {0, 90}}}}, {}};
  scene.camera.shutter_open = -0.25f;
  scene.camera.shutter_close = 0.25f;
  return scene;
}

TEST_F(LoadedScene, KeepsKeyframes) {
  const auto read = passed(animated_scene());
  ASSERT_TRUE(read) << read.error().message;
  const std::string first = read_file(path());
  ASSERT_TRUE(passed(*read));
  EXPECT_TRUE(read_file(path()) == first);
  const auto expected = animated_scene();
  ASSERT_EQ(read->animation.instances.size(), 1u);
  EXPECT_EQ(transform_at(read->animation.instances[0].steps, 1.5f).point({1, 1, 1}),
            transform_at(expected.animation.instances[0].steps, 1.5f).point({1, 1, 1}));
  EXPECT_EQ(values_at(read->materials[0], read->animation.materials[0].tracks, 1.5f).opacity.value, 0.75f);
  EXPECT_EQ(read->camera.shutter_close, 0.25f);
  EXPECT_TRUE(Scene::build(*read, 1)->set_frame(2, 1));
}

TEST_F(LoadedScene, WithUnsoundKeyframesIsRefused) {
  const auto error = [this](const auto& change) {
    SceneDescription scene = animated_scene();
    change(scene.animation);
    return error_of(scene);
  };
  EXPECT_EQ(error([](Animation& a) { a.camera.vertical_fov_degrees.frames = {2, 1}; }), kDamaged);
  EXPECT_EQ(error([](Animation& a) { a.lights[0].color.values.pop_back(); }), kDamaged);
  EXPECT_EQ(error([](Animation& a) { a.materials[0].tracks.numbers[0].track.frames = {2, 1}; }), kDamaged);
  EXPECT_EQ(error([](Animation& a) { a.environment.numbers[0].track.values[0] = INFINITY; }), kDamaged);
  EXPECT_EQ(
      error([](Animation& a) { std::get<TurnMotion>(a.instances[0].steps[2]).degrees.values[0] = 1e30f; }),
      kDamaged);
  EXPECT_EQ(error([](Animation& a) {
              std::get<RotationMotion>(a.instances[0].steps[3]).rotations.values[0] = {0, 0, 0, 0};
            }),
            kDamaged);
}

TEST_F(LoadedScene, PassesErrors) {
  const auto read = passed(fail(ErrorCode::kNotFound, "a.obj:1: \xc3\xa4\nand more"));
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kNotFound);
  EXPECT_EQ(read.error().message, "a.obj:1: \xc3\xa4\nand more");
}

TEST_F(LoadedScene, PassesRequests) {
  const LoadRequest request{"a/scene.json", {"", "b.obj", "a/scene.json"}};
  EXPECT_TRUE(write_load_request(open(), request));
  const auto read = read_load_request(open());
  ASSERT_TRUE(read);
  EXPECT_EQ(read->scene_path, request.scene_path);
  EXPECT_EQ(read->names, request.names);
}

TEST_F(LoadedScene, ErrorsThatAreNoneAreMadeReadable) {
  EXPECT_EQ(error_of(fail(ErrorCode::kInternal, "\x1b[2J\xff")), "\\x1b[2J\\xff");
  EXPECT_LE(error_of(fail(ErrorCode::kInternal, std::string(1 << 20, '\xff'))).size(), std::size_t{16} << 10);
  EXPECT_EQ(error_of(fail(ErrorCode::kInternal, "")), kDamaged);
  const auto odd = passed(fail(static_cast<ErrorCode>(99), "odd"));
  ASSERT_FALSE(odd);
  EXPECT_EQ(odd.error().code, ErrorCode::kInternal);
}

TEST_F(LoadedScene, OfAnotherBuildIsRefused) {
  auto out = BlockFileWriter::to(open(), "", Checksum{1, 2}, 1);
  EXPECT_TRUE(out.finish({}));
  const auto read = read_loaded(open(), 1);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kFailedPrecondition);
  EXPECT_THAT(read.error().message, HasSubstr("of another build"));
  EXPECT_FALSE(read_load_request(open()));
}

TEST_F(LoadedScene, IsRefusedWithAnyPieceMissing) {
  ASSERT_TRUE(passed(integrators::fingerprint_scene()));
  const std::string good = read_file(path());
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, std::size_t{88}, good.size() / 2, good.size() - 1}) {
    write_file(path(), good.substr(0, size));
    const auto read = read_loaded(open(), 1);
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().code, ErrorCode::kInternal);
    EXPECT_EQ(read.error().message, kDamaged) << size;
  }
}

// Under checksums that are in order, as a process writes them that was taken over.
TEST_F(LoadedScene, ThatNoLoaderMakesIsRefused) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity(),
                  kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(error_after([](SceneDescription&) {}), "no error");
  const std::function<void(SceneDescription&)> changes[] = {
      [](SceneDescription& s) { s.settings.integrator = static_cast<Integrator>(4); },
      [](SceneDescription& s) { s.camera.type = static_cast<CameraType>(3); },
      [](SceneDescription& s) { s.settings.heuristic = static_cast<Heuristic>(-1); },
      [](SceneDescription& s) { s.settings.filter.kind = static_cast<FilterKind>(3); },
      [](SceneDescription& s) { s.display.tone_curve = static_cast<ToneCurve>(1 << 20); },
      [](SceneDescription& s) { s.materials[0].sampling = static_cast<Sampling>(3); },
      [](SceneDescription& s) { s.materials[0].model = Glass{.fresnel = static_cast<DielectricFresnel>(3)}; },
      [](SceneDescription& s) { s.materials[0].model = Phong{.lobe = static_cast<PhongLobe>(2)}; },
      [](SceneDescription& s) {
        s.materials[0].model = CookTorrance{.conductor = static_cast<Conductor>(1000)};
      },
      [](SceneDescription& s) { s.materials[0].model = CookTorrance{.masking = static_cast<Masking>(2)}; },
      [](SceneDescription& s) { s.textures[0].wrap = static_cast<Wrap>(3); },
      [](SceneDescription& s) {
        s.grids = {{.size = {1, 1, 1}, .values = {1}, .filter = static_cast<GridFilter>(2)}};
      },
      [](SceneDescription& s) {
        s.grids = {{.size = {1, 1, 1}, .values = {1}, .border = static_cast<GridBorder>(2)}};
      },
      [=](SceneDescription& s) { s.textures[0].scale.x = kNan; },
      [=](SceneDescription& s) { s.textures[0].offset.y = kInfinity; },
      [=](SceneDescription& s) {
        mesh_of(s).normals.assign(mesh_of(s).positions.size(), {kNan, 0, 0});
      },
      [=](SceneDescription& s) {
        mesh_of(s).uvs.assign(mesh_of(s).positions.size(), {0, -kInfinity});
      },
  };
  for (std::size_t i = 0; i < std::size(changes); ++i) EXPECT_EQ(error_after(changes[i]), kDamaged) << i;
}

TEST_F(LoadedScene, WithTexelsThatMakeNoImageIsRefused) {
  using Texels = TextureImage::Texels;
  using Format = TextureImage::Format;
  const auto error_with = [&](Texels texels) {
    return error_after([&](SceneDescription& scene) {
      scene.textures[0].image = std::make_shared<TextureImage>(std::move(texels));
    });
  };
  const std::vector<TextureImage::Tile> tiles(6);
  EXPECT_EQ(error_with({9, 5, Format::kSrgbBytes, tiles, {}}), "no error");
  EXPECT_EQ(error_with({2, 1, Format::kFloats, {}, {0, 1, 2, 3, 4, 5}}), "no error");
  const Texels unsound[] = {
      {13, 5, Format::kSrgbBytes, tiles, {}},
      {9, 9, Format::kLinearBytes, tiles, {}},
      {0, 5, Format::kSrgbBytes, {}, {}},
      {-9, 5, Format::kSrgbBytes, tiles, {}},
      {1 << 20, 1, Format::kSharedExponent, std::vector<TextureImage::Tile>(1 << 18), {}},
      {9, 5, Format::kSrgbBytes, tiles, {0, 0, 0}},
      {9, 5, static_cast<Format>(4), tiles, {}},
      {2, 1, Format::kFloats, {}, {0, 1, 2, 3, 4}},
      {2, 1, Format::kFloats, {}, {0, 1, 2, 3, 4, -1}},
      {2, 1, Format::kFloats, {}, {0, 1, 2, 3, 4, std::nanf("")}},
      {2, 1, Format::kFloats, tiles, {0, 1, 2, 3, 4, 5}}};
  for (std::size_t i = 0; i < std::size(unsound); ++i) EXPECT_EQ(error_with(unsound[i]), kDamaged) << i;
}

// Indices of materials, textures, vertices and objects are checked where the scene is built.
TEST_F(LoadedScene, WithIndicesOfNothingCannotBeBuilt) {
  const std::function<void(SceneDescription&)> changes[] = {
      [](SceneDescription& s) { mesh_of(s).triangles.at(0)[1] = 1u << 31; },
      [](SceneDescription& s) { mesh_of(s).triangle_materials.at(0) = 1u << 30; },
      [](SceneDescription& s) { s.materials[0].emission.texture = 1 << 30; },
      [](SceneDescription& s) { s.materials[0].normal_map.texture = 1 << 30; },
      [](SceneDescription& s) { s.materials[0].opacity.texture = 1 << 30; },
      [](SceneDescription& s) { s.textures[0].image = nullptr; },
      [](SceneDescription& s) {
        const auto itself = static_cast<int>(s.textures.size());
        s.textures.push_back(
            {.image = nullptr, .procedural = ProceduralTexture{PowerPattern{{Rgb::gray(1), itself}, 2}}});
      },
      [](SceneDescription& s) {
        s.shapes.emplace_back(InstanceDescription{1u << 30, {}, {}});
      },
      [](SceneDescription& s) {
        s.shapes.emplace_back(SphereDescription{{}, 1, 1u << 30});
      },
      [](SceneDescription& s) { s.environment.emplace().radiance.texture = 1 << 30; }};
  for (std::size_t i = 0; i < std::size(changes); ++i) {
    SceneDescription scene = integrators::fingerprint_scene();
    changes[i](scene);
    auto read = passed(scene);
    ASSERT_TRUE(read) << i;
    EXPECT_FALSE(Scene::build(std::move(*read), 1)) << i;
  }
}

// A short file cannot make its reader take much memory.
TEST_F(LoadedScene, TakesNoMemoryForElementsThatAreNotThere) {
  const auto huge = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(error_of_index(true, huge), kDamaged);
  EXPECT_EQ(error_of_index(std::uint8_t{2}), kDamaged);
  EXPECT_EQ(error_of_index(), kDamaged);
}

}  // namespace
}  // namespace tessera::core
