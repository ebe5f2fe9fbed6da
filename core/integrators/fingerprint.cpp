// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/fingerprint.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <cassert>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "core/integrators/fingerprint_jpeg.hpp"
#include "core/integrators/render.hpp"
#include "core/textures/image_decoder.hpp"

namespace tessera::core::integrators {
namespace {

// An environment map in linear floats with clouds and a sun, black below the horizon.
Texture sky() {
  constexpr int kWidth = 96, kHeight = 48;
  std::vector<float> texels;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const bool is_sun = (x == 63 || x == 64) && (y == 16 || y == 17);
      const float cloud = static_cast<float>((x * 7 + y * 11) % 13) / 40;
      const float blue = y < kHeight / 2 ? 0.4f : 0;
      texels.insert(texels.end(),
                    {is_sun ? 300 : cloud * blue, is_sun ? 250 : blue / 2, is_sun ? 200 : blue});
    }
  return {.image = std::make_shared<TextureImage>(TextureImage{kWidth, kHeight, std::move(texels)})};
}

// A 2 x 2 image in sRGB bytes.
Texture checks() {
  const TextureImage image{2, 2,
                           std::vector<std::uint8_t>{200, 30, 90, 20, 160, 70, 80, 80, 250, 240, 220, 10}};
  return {.image = std::make_shared<TextureImage>(image), .scale = {3, 2}};
}

// Decoded from JPEG.
Texture photograph() {
  const std::string_view bytes(reinterpret_cast<const char*>(kFingerprintJpeg), sizeof kFingerprintJpeg);
  auto image = decode_texture_image(bytes, ColorSpace::kSrgb);
  assert(image.has_value());
  return {.image = std::make_shared<TextureImage>(std::move(*image)), .scale = {2, 1}};
}

// A tent with tilted normals, and a small lamp beside it.
MeshDescription tent() {
  return {.positions = {{-1.5f, 0, -0.9f},
                        {-0.9f, 0.8f, -1.2f},
                        {-0.3f, 0, -0.9f},
                        {1.5f, 1, -1.5f},
                        {1.6f, 1.3f, -1.4f},
                        {1.3f, 1.2f, -1.6f}},
          .normals = {{-1, 0.2f, 1}, {0, 0.5f, 1}, {1, 0.2f, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
          .uvs = {{0, 0}, {0.5f, 1}, {1, 0}, {0, 0}, {1, 0}, {0, 1}},
          .triangles = {{0, 2, 1}, {3, 4, 5}},
          .triangle_materials = {4, 1}};
}

// A normal map with varied normals, in linear bytes.
Texture dents() {
  const TextureImage image{2, 2,
                           std::vector<std::uint8_t>{128, 128, 255, 200, 100, 230, 90, 170, 240, 60, 60, 200},
                           ColorSpace::kLinear};
  return {.image = std::make_shared<TextureImage>(image), .scale = {4, -4}};
}

// What the other scene lacks: layered materials and media, disks and cylinders.
SceneDescription layered_scene() {
  SceneDescription scene;
  scene.settings = {.width_px = 16, .height_px = 16, .spp = 8};
  scene.camera = {.position = {0, 1, 4}, .look_at = {0, 1, 0}};
  scene.grids = {{.size = {2, 2, 2}, .values = {0.2f, 1, 0.5f, 0.1f, 0.9f, 0.3f, 0.7f, 0.4f}}};
  scene.media = {
      {.name = "haze", .sigma_a = {0.01f, 0.02f, 0.03f}, .sigma_s = {0.1f, 0.08f, 0.05f}, .g = 0.3f},
      {.name = "smoke",
       .sigma_a = {0.2f, 0.3f, 0.4f},
       .sigma_s = {2, 1, 0.5f},
       .emission = {0.3f, 0.2f, 0.1f},
       .absorption_grid = 0,
       .scattering_grid = 0,
       .grid_to_world = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-0.5f, 0.2f, 0.2f}}}};
  scene.materials = {
      {.name = "layers",
       .model = Principled{.base_diffuse_roughness = 0.5f,
                           .base_metalness = 0.3f,
                           .specular_roughness_anisotropy = 0.5f,
                           .transmission_weight = 0.3f,
                           .coat_weight = 0.5f,
                           .fuzz_weight = 0.3f,
                           .thin_film_weight = 0.5f}},
      {.name = "plastic", .model = Plastic{.roughness = 0.4f}},
      {.name = "metal",
       .model = ConductorMaterial{.eta = {Rgb::gray(0.2f)}, .k = {Rgb::gray(3)}, .roughness = 0.3f}},
      {.name = "leaf", .model = DiffuseTransmission{}},
      {.name = "pane", .model = ThinDielectric{}},
      {.name = "blend", .model = Blend{.first = 1, .second = 2}},
      {.name = "lamp", .model = Lambert{}, .emission = {{9, 8, 7}}, .two_sided = false},
      {.name = "smoke", .model = Null{}, .media = {1, 0}},
      {.name = "solid",
       .model = Principled{.transmission_weight = 1,
                           .transmission_color = {{0.9f, 0.5f, 0.3f}},
                           .transmission_depth = 0.5f}}};
  scene.shapes = {QuadDescription{{-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, 0},
                  QuadDescription{{-2, 0, -2}, {4, 0, 0}, {0, 3, 0}, 5},
                  SphereDescription{{-1, 0.6f, 0}, 0.5f, 1},
                  SphereDescription{{1, 0.6f, 0}, 0.5f, 8},
                  SphereDescription{{0, 0.7f, 0.7f}, 0.6f, 7},
                  QuadDescription{{-1.5f, 1, 0}, {1, 0, 0}, {0, 1, 0}, 3},
                  QuadDescription{{0.5f, 1, 0}, {1, 0, 0}, {0, 1, 0}, 4},
                  DiskDescription{.center = {0, 2.8f, 0},
                                  .radius_u = {0.5f, 0, 0},
                                  .radius_v = {0, 0, 0.4f},
                                  .inner = 0.2f,
                                  .material = 6},
                  CylinderDescription{.start = {-1.7f, 0.2f, -1},
                                      .axis = {0, 2, 0.2f},
                                      .radius_u = {0.1f, 0, 0},
                                      .radius_v = {0, 0, 0.2f},
                                      .material = 6},
                  CylinderDescription{.start = {1.5f, 0.2f, -1},
                                      .axis = {0, 1, 0},
                                      .radius_u = {0.3f, 0, 0},
                                      .radius_v = {0, 0, 0.3f},
                                      .material = 2}};
  return scene;
}

SceneDescription scene_with_media() {
  SceneDescription scene = layered_scene();
  scene.camera_medium = 0;
  return scene;
}

SceneDescription scene_without_media() {
  SceneDescription scene = layered_scene();
  scene.materials[7].media = {};
  std::get<Principled>(scene.materials[8].model).transmission_depth = 0;  // which would add a medium
  return scene;
}

// A flag whose upper edge is at x; it waves between two steps.
MeshStep waved(float frame, float x) {
  return {
      .frame = frame,
      .positions = {{-0.4f, 0.2f, 0.6f}, {0.4f, 0.2f, 0.4f}, {x + 0.3f, 1.1f, 0.7f}, {x - 0.3f, 1.1f, 0.2f}},
      .normals = {{0, 0, 1}, {0.2f, 0, 1}, {x, 0.3f, 1}, {0, x, 1}}};
}

// What the other scenes lack: curves of both shapes and of hair, what moves while the shutter is open,
// Disney's surfaces, Beckmann's facets.
SceneDescription moving_scene() {
  SceneDescription scene;
  scene.settings = {.width_px = 16, .height_px = 16, .spp = 8};
  scene.camera = {.position = {0, 1, 4}, .look_at = {0, 1, 0}, .shutter_open = 0.1f, .shutter_close = 0.9f};
  scene.materials = {
      {.name = "floor", .model = Lambert{}},
      {.name = "hair", .model = Hair{.pheomelanin = 0.2f}},
      {.name = "ribbon",
       .model = Plastic{.roughness = 0.5f,
                        .microfacets = {MicrofacetDistribution::kBeckmann, SmithMasking::kSeparable}}},
      {.name = "paint",
       .model = Disney{.base_color = {{0.7f, 0.3f, 0.2f}},
                       .metallic = 0.3f,
                       .anisotropic = 0.5f,
                       .specular_tint = 0.5f,
                       .specular_transmission = 0.4f,
                       .flatness = 0.3f,
                       .sheen = 0.5f,
                       .clearcoat = 1,
                       .clearcoat_gloss = 0.7f}}};
  CurveStrands lock{.radii = {0.03f}}, ribbons{.shape = CurveShape::kRibbon, .radii = {0.08f}};
  for (int i = 0; i < 6; ++i) {
    const float x = -1.5f + 0.2f * static_cast<float>(i);
    lock.points.insert(lock.points.end(),
                       {{x, 0, 0}, {x - 0.1f, 0.7f, 0.2f}, {x + 0.2f, 1.3f, 0}, {x, 2, 0.3f}});
    lock.counts.push_back(4);
  }
  ribbons.points = {{1, 0.2f, 0}, {1.3f, 0.8f, 0.4f}, {0.8f, 1.4f, -0.2f}, {1.2f, 2.2f, 0}};
  ribbons.counts = {4};
  ribbons.normals = {{0, 0, 1}, {0.5f, 0, 1}};
  MeshDescription flag;
  flag.triangles = {{0, 1, 2}, {0, 2, 3}};
  flag.triangle_materials = {3};
  flag.steps = {waved(0, -0.3f), waved(1, 0.4f)};
  flag.positions = flag.steps[0].positions;
  flag.normals = flag.steps[0].normals;
  scene.shapes = {QuadDescription{{-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, 0},
                  CurvesDescription{lock, 1},
                  CurvesDescription{ribbons, 2},
                  std::move(flag),
                  SphereDescription{{0, 1.7f, -0.5f}, 0.4f, 3},
                  InstanceDescription{0, {}, std::nullopt}};
  scene.objects = {{"ball", {SphereDescription{{0.5f, 0.3f, 1}, 0.3f, 2}}, {}}};
  scene.animation.deforms = true;
  scene.animation.instances = {{5, {TranslationMotion{{{0, 1}, {{0, 0, 0}, {0.6f, 0.4f, 0}}}}}}};
  scene.lights = {PointLightDescription{{1, 3, 2}, Rgb::gray(12)}};
  scene.environment = {{Rgb::gray(0.4f)}};
  return scene;
}

Texture procedural(const Pattern& pattern, PatternSpace space = PatternSpace::kPosition) {
  return {.image = nullptr, .procedural = ProceduralTexture{.pattern = pattern, .space = space}};
}

// What the other scenes lack: light of a sun through a pane, and procedural textures.
SceneDescription sunlit_room() {
  SceneDescription scene;
  scene.settings = {.width_px = 16, .height_px = 16, .spp = 8};
  scene.camera = {.position = {0, 1, 4}, .look_at = {0, 1, 0}};
  const auto texture = [](int index) { return ColorParameter{Rgb::gray(1), index}; };
  scene.textures = {sky(),
                    checks(),
                    procedural(FbmPattern{}),
                    procedural(MarblePattern{.scale = 2}),
                    procedural(DotsPattern{}, PatternSpace::kUv),
                    procedural(MixPattern{texture(2), texture(3), {1, 4}}),
                    procedural(ProjectedPattern{texture(1), Projection::kSpherical}),
                    procedural(WrinkledPattern{}),
                    procedural(PowerPattern{texture(7), 0.6f}),
                    procedural(GridPattern{.layers = texture(1), .depth = 2, .columns = 2}),
                    procedural(FacingPattern{}, PatternSpace::kNormal),
                    procedural(ProductPattern{texture(9), texture(10)}),
                    procedural(WindyPattern{}),
                    procedural(StepPattern{texture(1)}),
                    procedural(MixPattern{texture(8), {Rgb::gray(0.5f)}, {1, 13}})};
  scene.materials = {{.name = "floor", .model = Lambert{texture(5)}},
                     {.name = "wall", .model = Lambert{texture(6)}, .bump = {.texture = 12, .height = 0.1f}},
                     {.name = "side", .model = Lambert{texture(14)}},
                     {.name = "ball", .model = Plastic{.diffuse = texture(11), .roughness = {1, 7}}},
                     {.name = "pane", .model = Glass{}}};
  scene.shapes = {QuadDescription{{-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, 0},
                  QuadDescription{{-2, 0, -2}, {4, 0, 0}, {0, 3, 0}, 1},
                  QuadDescription{{-2, 0, 2}, {0, 0, -4}, {0, 3, 0}, 2},
                  QuadDescription{{2, 0, -2}, {0, 0, 4}, {0, 3, 0}, 2},
                  QuadDescription{{-2, 3, -2}, {4, 0, 0}, {0, 0, 4}, 2},
                  SphereDescription{{0.5f, 0.6f, -0.5f}, 0.6f, 3},
                  QuadDescription{{-2, 0, 2.1f}, {4, 0, 0}, {0, 3, 0}, 4},
                  QuadDescription{{-2, 0, 2}, {0, 3, 0}, {4, 0, 0}, 4}};
  scene.environment = {{Rgb::gray(0.5f), 0}, 150};
  return scene;
}

// As few photons as fill the guides: every worker waits for the fingerprint when it starts.
constexpr std::uint32_t kFingerprintPhotonPaths = kPhotonPaths / 16;

void append_sums(const Scene& scene, Integrator integrator, std::vector<std::uint64_t>& sums) {
  RenderSettings settings = scene.settings();
  settings.integrator = integrator;
  const RenderPlan plan = prepare(scene, settings, 1, kFingerprintPhotonPaths);
  const FilmTile tile = render(plan, {0, 0, settings.width_px, settings.height_px}, {0, settings.spp}, 1);
  sums.insert(sums.end(), tile.sums.begin(), tile.sums.end());
}

}  // namespace

// A box, open to the front, with lights of every type (one of them textured), spheres of every material, a
// normal-mapped floor, microfacet walls, a bump-mapped quad that is partly transparent, a textured mesh with
// interpolated normals, and instances, seen through a five-bladed aperture and a Gaussian filter.
SceneDescription fingerprint_scene() {
  SceneDescription scene;
  scene.settings = {
      .width_px = 16, .height_px = 16, .spp = 8, .filter = default_filter(FilterKind::kGaussian)};
  scene.camera = {.position = {0, 1, 4},
                  .look_at = {0, 1, 0},
                  .aperture_radius = 0.05f,
                  .focus_distance = 4,
                  .aperture_blades = 5};
  scene.materials = {{.name = "wall", .model = Lambert{{{0.7f, 0.5f, 0.3f}}}},
                     {.name = "lamp", .model = Lambert{}, .emission = {9, 8, 7}},
                     {.name = "glass", .model = Glass{}},
                     {.name = "mirror", .model = Mirror{}},
                     {.name = "cloth", .model = Lambert{{Rgb::gray(0.9f), 0}}},
                     {.name = "screen", .model = Lambert{}, .emission = {{4, 4, 5}, 0}},
                     {.name = "frosted", .model = Glass{.roughness = 0.5f}},
                     {.name = "varnish", .model = Phong{.exponent = {60, 0}}, .normal_map = {2, 0.5f}},
                     {.name = "gold", .model = CookTorrance{.conductor = Conductor::kGold}},
                     {.name = "lacquer",
                      .model = CookTorrance{.diffuse = {{0.1f, 0.4f, 0.2f}}, .specular = {Rgb::gray(0.5f)}},
                      .normal_map = {2, 1}},
                     {.name = "tiles",
                      .model = CookTorrance{.diffuse = {Rgb::gray(0.8f), 0},
                                            .specular = {Rgb::gray(0.5f)},
                                            .roughness = {0.6f, 0},
                                            .masking = Masking::kSchlick},
                      .normal_map = {2, 1}},
                     {.name = "copper",
                      .model = CookTorrance{.conductor = Conductor::kCopper},
                      .sampling = Sampling::kHalfVector},
                     {.name = "leaf",
                      .model = Lambert{{Rgb::gray(0.9f), 3}},
                      .bump = {.texture = 3, .height = 0.05f},
                      .opacity = {0.8f, 0}}};
  scene.textures = {checks(), sky(), dents(), photograph()};
  scene.shapes = {tent(),
                  QuadDescription{{-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, 7},
                  QuadDescription{{-2, 0, -2}, {4, 0, 0}, {0, 3, 0}, 0},
                  QuadDescription{{2, 0, -2}, {0, 0, 4}, {0, 3, 0}, 10},
                  QuadDescription{{-2, 0, 0}, {0, 0, -2}, {0, 1, 0}, 11},
                  QuadDescription{{-2, 1, 0}, {0, 0, -2}, {0, 1, 0}, 9},
                  QuadDescription{{-0.5f, 2.9f, -0.5f}, {1, 0, 0}, {0, 0, 1}, 1},
                  SphereDescription{{-0.7f, 0.6f, 0.3f}, 0.6f, 2},
                  SphereDescription{{0.8f, 0.7f, -0.5f}, 0.7f, 3},
                  SphereDescription{{1.3f, 2.2f, 0.5f}, 0.15f, 1},
                  SphereDescription{{-1.4f, 1.9f, -0.5f}, 0.3f, 5},
                  SphereDescription{{-1.5f, 1.2f, -1}, 0.5f, 6},
                  SphereDescription{{0, 1.8f, -1.2f}, 0.4f, 8},
                  SphereDescription{{0.1f, 0.3f, 0.9f}, 0.3f, 9},
                  QuadDescription{{0.6f, 0.1f, 1.2f}, {0.8f, 0.1f, -0.3f}, {0, 0.9f, 0.1f}, 12}};
  scene.objects = {{"kite",
                    {tent(), SphereDescription{{-0.9f, 0.4f, -0.8f}, 0.2f, 8},
                     QuadDescription{{-1, -0.3f, -1}, {0.5f, 0, 0}, {0, 0.3f, 0}, 5}},
                    {}}};
  const Transform mirrored{{0.2f, 0.3f, 0}, {-0.3f, 0.1f, 0.1f}, {0, 0.1f, -0.4f}, {0.9f, 1.7f, 0.2f}};
  scene.shapes.push_back(InstanceDescription{0, mirrored, std::nullopt});
  scene.shapes.push_back(InstanceDescription{0, translation({1.5f, 0.1f, 1.5f}), 6});
  scene.lights = {
      PointLightDescription{{-1.2f, 2.4f, 1}, {2, 2, 1.5f}},
      SpotLightDescription{.position = {1.5f, 2.8f, 1}, .look_at = {0.5f, 0, 0.5f}, .intensity = {6, 5, 4}},
      DirectionalLightDescription{{0.3f, -0.5f, -1}, {0.4f, 0.5f, 0.6f}}};
  scene.environment = {{Rgb::gray(0.8f), 1}, 25};
  return scene;
}

std::string determinism_fingerprint() {
  std::vector<std::uint64_t> sums;
  for (SceneDescription (*describe)() :
       {&fingerprint_scene, &scene_without_media, &scene_with_media, &moving_scene, &sunlit_room}) {
    const auto scene = Scene::build(describe(), 1);
    if (!scene) throw std::logic_error(scene.error().message);
    append_sums(*scene, Integrator::kMis, sums);
    if (describe != &scene_with_media) append_sums(*scene, Integrator::kWhitted, sums);
  }
  return fmt::format("{:016x}", XXH3_64bits(sums.data(), sums.size() * sizeof(sums[0])));
}

}  // namespace tessera::core::integrators
