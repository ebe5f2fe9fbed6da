// SPDX-License-Identifier: Apache-2.0
// A scene file as written, checked by itself: names are resolved and transforms of spheres and quads
// applied, but no asset is read. parse_scene_file combines the functions for its parts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/math/transform.hpp"
#include "core/scene/description.hpp"
#include "core/scene/loader/field.hpp"
#include "core/scene/loader/mistakes.hpp"
#include "core/scene/tables/shape_tables.hpp"

namespace tessera::core {

// An image file or a procedural texture.
struct TextureEntry {
  std::string name, file;
  Place file_place;
  std::optional<ColorSpace> color_space;  // nullopt: determined by the file's format
  TextureChannel channel = TextureChannel::kColor;
  std::string layer{};  // of an OpenEXR file
  Wrap wrap = Wrap::kRepeat;
  Vec2 scale{1, 1}, offset{0, 0};
  std::optional<Wrap> wrap_v{};
  Vec2 shear{0, 0};
  UvSet uv_set = UvSet::kFirst;
  TextureFilter filter = TextureFilter::kLinear;
  std::optional<ProceduralTexture> procedural{};
};

struct GridEntry {
  std::string name, file;
  Place file_place;
  GridFilter filter = GridFilter::kLinear;
  GridBorder border = GridBorder::kClamp;
};

struct MaterialEntry {
  Material material;
  Place place;
  ParameterTracks tracks{};
};

struct MeshEntry {
  std::string file;
  Track<std::string> steps{};  // files of a mesh that deforms, the first of which is `file`; else empty
  Place file_place;
  NormalsMode normals = NormalsMode::kFile;
  std::optional<std::uint32_t> material;          // of all triangles; nullopt: those of the OBJ file
  std::optional<std::uint32_t> default_material;  // of triangles without a material in the OBJ file
  std::vector<std::uint32_t> materials;           // those that a PLY file's "material_index" counts
  VertexColors colors = VertexColors::kUse;
  Transform transform;
};

struct CurvesEntry {
  CurveStrands strands;  // without points and counts if there is a file
  std::string file;      // empty: the points are in the scene file
  Place file_place;
  Place place;
  std::optional<float> radius{};  // of all points; nullopt: each has its own
  std::uint32_t material = 0;
  Transform transform;
};

// A transform as written.
struct TransformEntry {
  Transform transform;             // at frame 0
  std::vector<MotionStep> motion;  // empty unless animated
};

struct ShapeEntry {
  std::variant<MeshEntry, ShapeDescription, CurvesEntry> shape;
  Place place;
  // Of an animated shape. Its description is then in its own space, unless it is an instance.
  TransformEntry placement{};
  std::string name{};  // empty if the file gives none
};

// An object for instances.
struct ObjectEntry {
  std::string name;
  std::vector<ShapeEntry> shapes;
};

struct SceneFile {
  RenderSettings settings;
  CameraDescription camera;
  int camera_medium = kNoMedium;
  DisplaySettings display;
  std::vector<TextureEntry> textures;
  std::vector<GridEntry> grids;
  std::vector<MediumDescription> media;
  std::vector<MaterialEntry> materials;
  std::vector<ObjectEntry> objects;
  std::vector<ShapeEntry> shapes;
  Place shapes_place;
  std::vector<LightDescription> lights;
  std::optional<EnvironmentDescription> environment;
  CameraAnimation camera_animation;
  std::vector<LightAnimation> light_animations;
  std::vector<IndexedTracks> media_animations;
  ParameterTracks environment_animation;
};

// Errors are added to `mistakes`, which names the file; the result is complete only if there are none.
SceneFile parse_scene_file(std::string_view text, const std::string& display_path, Mistakes& mistakes);

RenderSettings read_render(const Field& field);
// At frame 0; fills `animation`.
CameraDescription read_camera(const Field& field, CameraAnimation& animation);
DisplaySettings read_output(const Field& field);
std::vector<TextureEntry> read_textures(const Field& field);
// The index in `textures`; -1 after a mistake.
int read_texture_name(const Field& field, const std::vector<TextureEntry>& textures);
std::vector<GridEntry> read_grids(const Field& field);
// At frame 0; appends to `animations`.
std::vector<MediumDescription> read_media(const Field& field, const std::vector<GridEntry>& grids,
                                          std::vector<IndexedTracks>& animations);
// The index in `grids`; -1 after a mistake.
int read_grid_name(const Field& field, const std::vector<GridEntry>& grids);
// The index in `media`; kNoMedium after a mistake.
int read_medium_name(const Field& field, const std::vector<MediumDescription>& media);
std::vector<MaterialEntry> read_materials(const Field& field, const std::vector<TextureEntry>& textures,
                                          const std::vector<MediumDescription>& media);
// Textures without a colour space that are used only for numbers (normal maps, roughness) become linear.
void settle_color_spaces(SceneFile& scene);
// Objects may hold instances of each other.
std::vector<ObjectEntry> read_objects(const Field& field, const std::vector<MaterialEntry>& materials);
// Instances may be those of `objects`. Shapes may move by themselves if they are the scene's own, and not
// those of an object.
enum class ShapeOwner { kScene, kObject };
std::vector<ShapeEntry> read_shapes(const Field& field, const std::vector<MaterialEntry>& materials,
                                    const std::vector<ObjectEntry>& objects, ShapeOwner owner);
// At frame 0; appends to `animations`.
std::vector<LightDescription> read_lights(const Field& field, const std::vector<TextureEntry>& textures,
                                          std::vector<LightAnimation>& animations);
// At frame 0; fills `tracks`.
EnvironmentDescription read_environment(const Field& field, const std::vector<TextureEntry>& textures,
                                        ParameterTracks& tracks);
// Finite and invertible at all keyframes; the identity after a mistake.
TransformEntry read_transform(const Field& field);

}  // namespace tessera::core
