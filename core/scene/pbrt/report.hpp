// SPDX-License-Identifier: Apache-2.0
// What the reader of pbrt files says of a file: warnings with their place, and the texts of errors. Not
// thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/scene/import/scene_builder.hpp"
#include "core/scene/pbrt/parameters.hpp"

namespace tessera::core::pbrt {

inline FilePlace file_place(const Place& place) {
  return {*place.file, place.line};
}

class Report {
 public:
  // `builder` must outlive this object.
  explicit Report(SceneBuilder& builder) : builder_(builder) {}

  // Warnings of equal text are counted together.
  void warn(const Place& place, std::string_view text) const {
    builder_.warn(*place.file, place.line, text, text);
  }
  // Warnings of equal kind are counted together; the text of the first is told.
  void warn(const Place& place, std::string_view kind, const std::string& text) const {
    builder_.warn(*place.file, place.line, kind, [&] { return text; });
  }
  // Warns of each parameter that was not read, and of all remarks. `owner` names what they belong to: "the
  // shape 'sphere'".
  void tell(const Parameters& parameters, std::string_view owner) const;
  // "scene.pbrt:12"
  std::string shown(const Place& place) const;
  // INVALID_ARGUMENT: "scene.pbrt:12: TEXT".
  tl::unexpected<Error> error(const Place& place, std::string_view text) const;

 private:
  SceneBuilder& builder_;
};

}  // namespace tessera::core::pbrt
