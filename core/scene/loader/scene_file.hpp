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

namespace tessera::core {

struct TextureEntry {
  std::string name, file;
  Place file_place;
  std::optional<ColorSpace> color_space;  // nullopt: determined by the file's format
  TextureChannel channel = TextureChannel::kColor;
  Wrap wrap = Wrap::kRepeat;
  Vec2 scale{1, 1}, offset{0, 0};
};

struct MaterialEntry {
  Material material;
  Place place;
};

// The shading normals of a mesh.
enum class NormalsMode {
  kFile,    // the file's, or else means of the faces around each vertex that meet without a
            // edge
  kSmooth,  // means of all faces around each vertex, ignoring the file's
  kFlat,    // none
};

struct MeshEntry {
  std::string file;
  Place file_place;
  NormalsMode normals = NormalsMode::kFile;
  std::optional<std::uint32_t> material;          // of all triangles; nullopt: those of the OBJ file
  std::optional<std::uint32_t> default_material;  // of triangles without a material in the OBJ file
  Transform transform;
};

// A transform as written.
struct TransformEntry {
  Transform transform;             // at frame 0
  std::vector<MotionStep> motion;  // empty unless animated
};

struct ShapeEntry {
  std::variant<MeshEntry, ShapeDescription> shape;
  Place place;
  // Of an animated shape. Its description is then in its own space, unless it is an instance.
  TransformEntry placement{};
};

// An object for instances.
struct ObjectEntry {
  std::string name;
  std::vector<ShapeEntry> shapes;  // no instances
};

struct SceneFile {
  RenderSettings settings;
  CameraDescription camera;
  DisplaySettings display;
  std::vector<TextureEntry> textures;
  std::vector<MaterialEntry> materials;
  std::vector<ObjectEntry> objects;
  std::vector<ShapeEntry> shapes;
  Place shapes_place;
  std::vector<LightDescription> lights;
  std::optional<EnvironmentDescription> environment;
  CameraAnimation camera_animation;
  std::vector<LightAnimation> light_animations;
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
std::vector<MaterialEntry> read_materials(const Field& field, const std::vector<TextureEntry>& textures);
// Textures without a colour space that are used only for numbers (normal maps, roughness) become linear.
void settle_color_spaces(SceneFile& scene);
// Objects must not contain instances.
std::vector<ObjectEntry> read_objects(const Field& field, const std::vector<MaterialEntry>& materials);
// If `objects` is null, instances are a mistake.
std::vector<ShapeEntry> read_shapes(const Field& field, const std::vector<MaterialEntry>& materials,
                                    const std::vector<ObjectEntry>* objects);
// At frame 0; appends to `animations`.
std::vector<LightDescription> read_lights(const Field& field, std::vector<LightAnimation>& animations);
EnvironmentDescription read_environment(const Field& field, const std::vector<TextureEntry>& textures);
// Finite and invertible at all keyframes; the identity after a mistake.
TransformEntry read_transform(const Field& field);

}  // namespace tessera::core
