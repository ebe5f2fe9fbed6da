// SPDX-License-Identifier: Apache-2.0
// A glTF 2.0 file, as JSON (.gltf) or in its binary form (.glb), parsed and with its version and extensions
// checked (Khronos Group 2021, glTF 2.0 specification, sections 3 and 4). Immutable.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/scene/gltf/value.hpp"
#include "core/scene/import/scene_builder.hpp"

namespace tessera::core::gltf {

class Document {
 public:
  // Throws a Refusal. `builder` gets warnings, and must outlive this object.
  Document(std::string bytes, SceneBuilder& builder);
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  Value root() const { return {&json_, ""}; }
  // An element of one of the root's lists, by an index as written in the file: refused if there is none.
  Value element(std::string_view list, const Value& index) const;
  // The BIN chunk of a .glb file.
  std::optional<std::string_view> binary_chunk() const { return binary_; }

  // Whether the extension is read.
  static bool knows_extension(std::string_view name);
  // Tells once, with a count, what is approximated or ignored at a place.
  void warn(const Value& place, std::string_view kind, std::string_view text) const;
  SceneBuilder& builder() const { return builder_; }
  // The line of a place; 0 in a .glb file, which has no lines.
  int line_of(const Value& place) const { return is_binary_ ? 0 : place.line(); }
  bool is_binary() const { return is_binary_; }

 private:
  // Splits a .glb file; returns its JSON.
  std::string_view split();
  void check_version() const;
  void check_extensions() const;

  SceneBuilder& builder_;
  std::string bytes_;
  std::optional<std::string_view> binary_;
  bool is_binary_ = false;
  JsonValue json_;
};

}  // namespace tessera::core::gltf
