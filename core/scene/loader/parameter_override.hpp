// SPDX-License-Identifier: Apache-2.0
// Replaces parameters of a scene file by their paths, and chooses among what it holds, before it is read. The
// file's text is changed, so that both travel with the scene wherever it is read again.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/loader/asset_source.hpp"

namespace tessera::core {

struct ParameterOverride {
  enum class Kind { kParameter, kSelection };

  // Of a parameter: the field's path in error messages, "camera.position", "lights[0].intensity". Of a
  // selection: what is chosen (core/scene/import/selection.hpp).
  std::string path;
  std::string value;  // of a parameter: as given; of a selection: JSON
  Kind kind = Kind::kParameter;
};

// "PATH=VALUE". INVALID_ARGUMENT if it is written otherwise.
Result<ParameterOverride> parse_override(std::string_view text);

// The choice of a camera, scene, variant or animation by its name or number.
ParameterOverride select_by_name(std::string_view what, const std::string& name);
// The choice of the time of an animation, and of how long the shutter is open then.
ParameterOverride select_time(double seconds);
ParameterOverride select_shutter(double seconds);

// The scene file with the values replaced, one after the other; lines keep their numbers. An object that
// lacks the key gets it, so that an unknown key is found when the scene is read. Values are JSON, or a word.
// In a Mitsuba scene the path is the name of a parameter, which gets a <default> before all others, whose
// value is any text, or JSON without quotes and brackets. A selection becomes an extension of a glTF file,
// TESSERA_selection, and a <default> of a Mitsuba scene. INVALID_ARGUMENT names the path, and what is not
// there. A text that is neither JSON nor XML is returned as it is, for the reader to report.
Result<std::string> with_overrides(std::string text, std::span<const ParameterOverride> overrides);

// Other files as they are, and the scene file with overrides, also the JSON of a .glb file; INVALID_ARGUMENT
// if its format has no parameters that can be replaced, or nothing to choose. The names of replaced
// parameters are added to a scene of another program, so that its reader refuses those that nothing uses.
class OverriddenAssets : public AssetSource {
 public:
  OverriddenAssets(AssetSource& inner, std::string scene_path, std::vector<ParameterOverride> overrides)
      : inner_(inner), scene_path_(std::move(scene_path)), overrides_(std::move(overrides)) {}
  bool exists(const std::string& path) override { return inner_.exists(path); }
  std::vector<std::string> find_in_any_spelling(const std::string& path) override {
    return inner_.find_in_any_spelling(path);
  }
  Result<std::string> read(const std::string& path) override;

 private:
  AssetSource& inner_;
  std::string scene_path_;
  std::vector<ParameterOverride> overrides_;
};

}  // namespace tessera::core
