// SPDX-License-Identifier: Apache-2.0
// Executes the directives of a scene file and of the files that it includes (pbrt-v4 file format). Not
// thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/import/scene_builder.hpp"
#include "core/scene/pbrt/colors.hpp"
#include "core/scene/pbrt/graphics_state.hpp"
#include "core/scene/pbrt/lights.hpp"
#include "core/scene/pbrt/materials.hpp"
#include "core/scene/pbrt/matrix.hpp"
#include "core/scene/pbrt/media.hpp"
#include "core/scene/pbrt/parameters.hpp"
#include "core/scene/pbrt/report.hpp"
#include "core/scene/pbrt/shapes.hpp"
#include "core/scene/pbrt/surfaces.hpp"
#include "core/scene/pbrt/texture_baker.hpp"
#include "core/scene/pbrt/textures.hpp"
#include "core/scene/pbrt/token_stream.hpp"
#include "core/scene/pbrt/view.hpp"

namespace tessera::core::pbrt {

class Interpreter {
 public:
  // `builder` must outlive this object.
  explicit Interpreter(SceneBuilder& builder) : builder_(builder) {}
  Interpreter(const Interpreter&) = delete;
  Interpreter& operator=(const Interpreter&) = delete;

  // Reads the scene into the builder. Errors name file and line.
  Status run();

 private:
  // A file that is being read, with those that it includes.
  struct File {
    TokenStream tokens;
    Place directive{};  // where the current one begins
  };
  using Handler = Status (Interpreter::*)(File& file);
  static Handler handler_of(std::string_view directive);

  Status run_directives(File& file);
  // The text of a file, uncompressed. Errors name it.
  Result<SourceText> source(const std::string& path) const;
  // The same for the file that a directive names; errors name file and line.
  Result<SourceText> named_source(File& file);

  // Reading of arguments. Errors name file and line.
  const Place& place(const File& file) const { return file.directive; }
  Result<std::string> text(File& file, bool without_escapes = true);
  Result<std::vector<float>> numbers(File& file, std::size_t count);
  Result<Parameters> parameters(File& file);
  Result<Parameters> parameters(File& file, AttributeTarget target);
  Result<KindAndParameters> kind_and_parameters(File& file);
  tl::unexpected<Error> at(const File& file, const Error& error) const;

  // Directives, in the order of their table.
  Status accelerator(File& file);
  Status active_transform(File& file);
  Status area_light_source(File& file);
  Status attribute(File& file);
  Status attribute_begin(File& file);
  Status attribute_end(File& file);
  Status camera(File& file);
  Status color_space(File& file);
  Status concat_transform(File& file);
  Status coord_sys_transform(File& file);
  Status coordinate_system(File& file);
  Status film(File& file);
  Status identity(File& file);
  Status import_file(File& file);
  Status include_file(File& file);
  Status integrator(File& file);
  Status light_source(File& file);
  Status look_at_directive(File& file);
  Status make_named_material(File& file);
  Status make_named_medium(File& file);
  Status material(File& file);
  Status medium_interface(File& file);
  Status named_material(File& file);
  Status object_begin(File& file);
  Status object_end(File& file);
  Status object_instance(File& file);
  Status option(File& file);
  Result<Parameters> option_value(File& file);
  Status pixel_filter(File& file);
  Status reverse_orientation(File& file);
  Status rotate_directive(File& file);
  Status sampler(File& file);
  Status scale_directive(File& file);
  Status shape(File& file);
  Status texture(File& file);
  Status transform_begin(File& file);
  Status transform_directive(File& file);
  Status transform_end(File& file);
  Status transform_times(File& file);
  Status translate_directive(File& file);
  Status world_begin(File& file);
  Status world_end(File& file);

  Status push_state(const File& file, std::string_view begin);
  Status pop_state(const File& file, bool is_attribute);
  // Forgets all but the first `count` states; warns that the directives that saved them have no end.
  void end_states(std::size_t count);
  void apply(const Matrix& matrix);
  void set_transform(const AnimatedMatrix& matrix);
  // The transformation of what does not move; `what` is as in "the light".
  const Matrix& still_transform(const Place& place, std::string_view what) const;
  // The motion of what stands here; nullopt if it does not move, or cannot.
  std::optional<std::vector<MotionStep>> motion_here(const Place& place);
  // Adds an instance that moves.
  void add_moving(std::uint32_t object, std::vector<MotionStep> steps, std::string name, const Place& place);
  Result<Matrix> matrix_argument(File& file);
  void tell_redefinition(const File& file, std::string_view what, const std::string& name) const;
  Status read_setting(File& file, std::optional<KindAndParameters>& setting);
  Status start_world();
  void tell_unused_attributes() const;
  // Adds a shape, at the end if its material is not made yet.
  Status add_shape(const std::string& kind, const Parameters& given, ShapePlacement placement);
  Status add_waiting_shapes();
  MediumInterface media_here(const Place& place) const;

  SceneBuilder& builder_;
  Report report_{builder_};
  Colors colors_{builder_, report_};
  Textures textures_{builder_, report_, colors_};
  TextureBaker baker_{builder_, report_};
  Materials materials_{builder_, report_, colors_, textures_, baker_};
  Lights lights_{builder_, report_, colors_, textures_, baker_};
  Media media_{builder_, report_, colors_};
  Surfaces surfaces_{builder_, report_, materials_, baker_};
  Shapes shapes_{builder_, report_, surfaces_, textures_};

  struct WaitingShape {
    std::string kind;
    Parameters parameters;
    ShapePlacement placement;
  };
  std::vector<WaitingShape> waiting_shapes_;

  GraphicsState state_;
  struct SavedState {
    GraphicsState state;
    Place place;
    std::string_view begin;  // the directive

    bool is_attribute() const { return begin != "TransformBegin"; }
  };
  std::vector<SavedState> saved_;
  struct AttributeUse {
    Place place;
    std::string target, name;
    std::shared_ptr<bool> is_used;
  };
  std::vector<AttributeUse> attributes_;  // all that the directive Attribute has given
  std::map<std::string, AnimatedMatrix> coordinate_systems_;
  std::map<std::string, std::uint32_t> objects_;
  std::optional<std::uint32_t> object_;  // that is being defined
  ViewDirectives view_;
  std::optional<Place> camera_medium_place_;
  std::string camera_medium_;
  bool in_world_ = false;
  std::uint64_t files_ = 0;      // that were included or imported
  std::size_t outer_files_ = 0;  // are open around the file that is imported
};

}  // namespace tessera::core::pbrt
