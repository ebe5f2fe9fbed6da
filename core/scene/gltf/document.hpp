// SPDX-License-Identifier: Apache-2.0
// A glTF 2.0 file, as JSON (.gltf) or in its binary form (.glb), parsed and with its version and extensions
// checked (Khronos Group 2021, glTF 2.0 specification, sections 3 and 4). Immutable.
#pragma once

#include <memory>
#include <optional>
#include <set>
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

  Value root() const { return {&json_, "", this}; }
  // To change values. Those that were taken before may be no longer valid.
  JsonValue& json() { return json_; }
  // An element of a list, or of one of the root's, by an index as written in the file: refused if there is
  // none.
  static Value element(const Value& list, const Value& index);
  Value element(std::string_view list, const Value& index) const { return element(root()[list], index); }
  // The same; if there is none, absent after a warning that says what is done instead.
  Value element_or_none(const Value& list, const Value& index, std::string_view instead) const;
  Value element_or_none(std::string_view list, const Value& index, std::string_view instead) const {
    return element_or_none(root()[list], index, instead);
  }
  // The BIN chunk of a .glb file.
  std::optional<std::string_view> binary_chunk() const { return binary_; }

  // Whether the extension is read.
  static bool knows_extension(std::string_view name);
  // Whether no pixel depends on the extension, which is then ignored without a warning.
  static bool is_invisible_extension(std::string_view name);
  // Those that the file says it uses or requires.
  std::set<std::string> listed_extensions() const;
  void tell_unsupported_extension(const Value& place, std::string_view name) const;
  // Tells once, with a count, what is approximated or ignored at a place.
  void warn(const Value& place, std::string_view kind, std::string_view text) const;
  // Calls read(). What it refuses because of a mistake in the file, or a file that is missing, is told with
  // what is done instead: "PLACE: INSTEAD: WHY". Other Refusals, such as those beyond a limit, are passed on.
  // Returns whether it was read.
  template <typename Read>
  bool try_to(const Value& place, std::string_view kind, std::string_view instead, const Read& read) const {
    try {
      read();
      return true;
    } catch (const Refusal& refusal) {
      tell_refusal(refusal, place, kind, instead);
      return false;
    }
  }
  SceneBuilder& builder() const { return builder_; }
  // The line of a place; 0 in a .glb file, which has no lines.
  int line_of(const Value& place) const { return is_binary_ ? 0 : place.line(); }
  bool is_binary() const { return is_binary_; }

 private:
  // Splits a .glb file; returns its JSON.
  std::string_view split();
  void check_version() const;
  void check_extensions() const;
  void tell_unreadable_images(const Value& place, std::string_view name) const;
  // Within the handler of the refusal.
  void tell_refusal(const Refusal& refusal, const Value& place, std::string_view kind,
                    std::string_view instead) const;

  SceneBuilder& builder_;
  std::string bytes_;
  std::optional<std::string_view> binary_;
  bool is_binary_ = false;
  JsonValue json_;
};

}  // namespace tessera::core::gltf
