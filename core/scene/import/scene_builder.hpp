// SPDX-License-Identifier: Apache-2.0
// A SceneDescription under construction from a file of another program. Front ends (front_ends.hpp) convert
// what they read by it: it finds and reads files, decodes images once, checks meshes, keeps the scene within
// its limits and collects warnings.
//
// Nothing is dropped in silence: a front end that approximates or ignores a parameter calls warn(), which
// counts equal warnings. Not thread-safe.
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/math/transform.hpp"
#include "core/scene/description.hpp"
#include "core/scene/loader/asset_cache.hpp"
#include "core/scene/loader/asset_source.hpp"
#include "core/scene/loader/file_warnings.hpp"
#include "core/scene/loader/scene_limits.hpp"

namespace tessera::core {

// How to interpret an image file as a texture.
struct ImageUse {
  // Of files with 8 or 16 bits. Files of floats are always linear, whatever is asked for.
  ColorSpace color_space = ColorSpace::kSrgb;
  TextureChannel channel = TextureChannel::kColor;
  std::string layer{};  // of OpenEXR files (DecodeOptions)
};

// The use of the channel or layer that a file calls `channel`: a letter as "r" or "a", or the name of a layer
// or channel of an OpenEXR file. Empty for the colours.
ImageUse use_of_channel(ColorSpace color_space, const std::string& channel);

// What a file without camera or light gets.
struct SceneDefaults {
  // A camera from the front that frames the bounds of all shapes.
  bool camera = true;
  // A studio: an environment with a soft key light behind the camera, and no ground. Only if the scene has
  // neither a light nor an environment; emissive shapes do not count.
  bool studio_light = true;
  Vec3 up{0, 1, 0};     // unit axes of the file: its vertical
  Vec3 front{0, 0, 1};  // and the direction that the front of objects faces; orthogonal to `up`
};

// A line of a file of the scene, for warnings; 0 if no line applies.
struct FilePlace {
  std::string file;
  int line = 0;
};

class SceneBuilder {
 public:
  using Image = std::shared_ptr<const TextureImage>;

  // `scene_path` and `display_path` are those of load_scene(). The arguments must outlive this object.
  SceneBuilder(AssetSource& assets, std::string scene_path, std::string display_path,
               const SceneLimits& limits);
  SceneBuilder(const SceneBuilder&) = delete;
  SceneBuilder& operator=(const SceneBuilder&) = delete;

  // For what the methods below do not cover: settings, display, animation.
  SceneDescription& scene() { return scene_; }
  const SceneLimits& limits() const { return limits_; }

  // --- Files. A path is relative to the folder of the scene file, as path_beside() gives it.

  const std::string& scene_path() const { return scene_path_; }
  // The name of a file in messages: display_path for the scene file, else the path as it is.
  std::string shown(const std::string& path) const;
  // Errors name the path and the reason.
  Result<std::string> read(const std::string& path) { return assets_.read(path); }
  // The path of the file that `beside` calls `written`: as written, decoded, with '/' for '\', its last
  // component, and then in any spelling (file_names.hpp). nullopt if there is none. A file of another name is
  // told once, at `place`, or else of the scene file.
  std::optional<std::string> find(const std::string& written, const std::string& beside) {
    return find(written, std::vector{beside}, {scene_path_, 0});
  }
  // The same beside several files, of which the first that has one counts.
  std::optional<std::string> find(const std::string& written, const std::vector<std::string>& beside) {
    return find(written, beside, {scene_path_, 0});
  }
  std::optional<std::string> find(const std::string& written, const std::vector<std::string>& beside,
                                  const FilePlace& place);

  // What decodes and keeps the files, for readers that need it: OBJ and MTL files.
  AssetCache& files() { return cache_; }

  // --- Warnings

  SceneWarnings& warnings() { return warnings_; }

  // Says what is wrong or unsupported at `file`:`line` (0: no line applies), and what is done instead.
  // `text()` returns the sentence. Warnings of equal file and `kind` are told once, with their count.
  template <std::invocable Text>
  void warn(const std::string& file, int line, std::string_view kind, const Text& text,
            std::uint64_t count = 1, std::string_view unit = "times") {
    warnings_.of(shown(file)).add(kind, line, text, count, unit);
  }
  void warn(const std::string& file, int line, std::string_view kind, std::string_view text) {
    warn(file, line, kind, [text] { return std::string(text); });
  }

  // --- Textures. Images are decoded once for each use.

  Result<Image> image_file(const std::string& path, const ImageUse& use);
  // An image file in memory, such as a buffer view of a .glb. `name` identifies it in this scene, and names
  // it in messages: "model.glb, image 3".
  Result<Image> image_bytes(const std::string& name, std::string_view bytes, const ImageUse& use);
  // A generated image, counted against the limits on textures.
  Result<Image> image_pixels(const std::string& name, TextureImage image);
  // The same for a large one: make() is called once the limits have allowed its size.
  Result<Image> image_pixels(const std::string& name, TextureSize size,
                             const std::function<TextureImage()>& make);

  // The index of the texture, for ColorParameter and ScalarParameter. Equal textures have one index.
  int add_texture(const Texture& texture);
  // Decodes the file and adds a texture that repeats. `use` as above.
  Result<int> add_texture(const std::string& path, const ImageUse& use);

  // --- Materials

  // The index of the new material, for shapes.
  std::uint32_t add_material(Material material);
  Material& material(std::uint32_t index) { return scene_.materials[index]; }
  // A gray diffuse material, the same at each call.
  std::uint32_t default_material();

  // --- Shapes. `object` is the object that gets the shape; nullopt for the scene itself.

  // An object is rendered through instances only.
  std::uint32_t add_object(std::string name);
  // Repairs the mesh (repair_mesh()) and counts its triangles, those of a mesh that deforms for each step. A
  // mesh without triangles is left out, with a warning at `file`. RESOURCE_EXHAUSTED beyond the limit on
  // triangles. `name` names the shape in messages.
  Status add_mesh(MeshDescription mesh, std::string name, std::optional<std::uint32_t> object,
                  const std::string& file, int line = 0);
  // Curves with a radius for each point; those that agree in all else with the curves added before join them.
  // A segment counts as kMaxCurveParts triangles. Curves that cannot be rendered are left out, with a
  // warning. RESOURCE_EXHAUSTED as above.
  Status add_curves(CurvesDescription curves, std::string name, std::optional<std::uint32_t> object,
                    const FilePlace& place);
  // A sphere, quad, ... or instance. Whether it was added: one that cannot be rendered is left out, with a
  // warning at `place`. Its material must have been added.
  bool add_shape(ShapeDescription shape, std::string name, std::optional<std::uint32_t> object,
                 const FilePlace& place);
  bool add_instance(std::uint32_t object, const Transform& to_world, std::string name, const FilePlace& place,
                    std::optional<std::uint32_t> material = {});
  // Whether the limits allow so many triangles more; before memory is taken for them.
  Status check_triangles(const std::string& path, std::uint64_t more) const;
  // The same, and adds them to the scene's total, for meshes that add_shape() adds. add_mesh() counts its
  // own.
  Status count_triangles(const std::string& path, std::uint64_t more);

  // --- Lights and camera

  // A light without power, or that cannot be computed with, is left out, with a warning at `place`.
  void add_light(LightDescription light, const FilePlace& place);
  void set_environment(EnvironmentDescription environment) { scene_.environment = std::move(environment); }
  // The camera to render with. The last one counts.
  void set_camera(const CameraDescription& camera);
  bool has_camera() const { return has_camera_; }

  // The scene, with defaults for what it lacks, and all warnings. Call once, at the end.
  // INVALID_ARGUMENT if nothing can be rendered, RESOURCE_EXHAUSTED beyond the limit on lights.
  Result<SceneDescription> finish(const SceneDefaults& defaults);

 private:
  Error nothing_to_render() const;
  // After a warning at `place`, false.
  bool can_be_rendered(const ShapeDescription& shape, const FilePlace& place);
  void append_shape(ShapeDescription shape, std::string name, std::optional<std::uint32_t> object);
  void clamp_materials();

  AssetSource& assets_;
  std::string scene_path_, display_path_;
  const SceneLimits& limits_;
  SceneWarnings warnings_;
  AssetCache cache_;
  SceneDescription scene_;
  std::set<std::string> told_names_;  // of files that are found by another name
  std::uint64_t triangles_ = 0;
  bool has_camera_ = false;
  std::optional<std::uint32_t> default_material_;
};

}  // namespace tessera::core
