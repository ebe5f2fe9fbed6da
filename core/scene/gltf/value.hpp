// SPDX-License-Identifier: Apache-2.0
// A value of a glTF file's JSON with its place in the file, and checked access to it. Within this folder what
// cannot be read is a Refusal, which is thrown. Document::try_to() replaces a part that is refused and tells
// it; read_gltf_scene() returns what is left as an Error. Values are cheap to copy and valid as long as their
// document.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"
#include "core/scene/loader/json_document.hpp"

namespace tessera::core::gltf {

class Document;

struct Refusal {
  int line = 0;  // in the JSON; 0: no line applies
  Error error;
  bool names_file = false;  // whether the error's message begins with the file's name
};

class Value {
 public:
  Value() = default;  // absent
  Value(const JsonValue* json, std::string path, const Document* document)
      : json_(json), path_(std::move(path)), document_(document) {}

  // Members that are absent or null are absent values.
  bool exists() const { return json_ != nullptr; }
  int line() const { return json_ == nullptr ? 0 : json_->line; }
  // As in "meshes[3].primitives[0].material".
  const std::string& path() const { return path_; }
  // Throws a Refusal: "PATH: WHAT".
  [[noreturn]] void refuse(std::string_view what, ErrorCode code = ErrorCode::kInvalidArgument) const;

  // The member of an object; absent in anything else.
  Value operator[](std::string_view key) const;
  // Whether an access to it, by a key or an index, came before.
  bool is_used() const { return json_ != nullptr && json_->is_used; }
  // The value at a path like path(), without using it; absent if there is none.
  Value at_path(std::string_view path) const;
  // The keys of its members that were used.
  std::vector<std::string_view> used_keys() const;
  // The length of a list; 0 of anything else.
  std::size_t size() const;
  Value at(std::size_t i) const;  // i < size()
  std::vector<std::string> keys() const;

  // The value itself. Refused if it is something else, or too large.
  float number() const;
  std::uint64_t whole() const;
  // The same; nullopt if it is something else.
  std::optional<std::uint64_t> as_whole() const;

  // A member that the layout of bytes depends on. `otherwise` if it is absent; refused if it is something
  // else.
  std::uint64_t whole_or(std::string_view key, std::uint64_t otherwise) const;

  // Other members. `otherwise` if they are absent, and after a warning if they are something else.
  float number_or(std::string_view key, float otherwise) const;
  bool is_true(std::string_view key, bool otherwise = false) const;
  Rgb color_or(std::string_view key, Rgb otherwise) const;
  Vec3 vector_or(std::string_view key, Vec3 otherwise) const;
  // A list of `count` numbers; empty if the member is absent or, after a warning, something else.
  std::vector<float> numbers(std::string_view key, std::size_t count) const;
  // A list of any length; 0, after a warning, for what is no number.
  std::vector<float> numbers(std::string_view key) const;
  // Empty if it is absent or no text.
  std::string text(std::string_view key) const;

  Value extension(std::string_view name) const { return (*this)["extensions"][name]; }

 private:
  // What get(member) returns.
  template <typename T, typename Get>
  T member_or(std::string_view key, T otherwise, const Get& get) const;
  template <typename T, typename Get>
  T value_or(T otherwise, const Get& get) const;

  const JsonValue* json_ = nullptr;
  std::string path_;
  const Document* document_ = nullptr;
};

}  // namespace tessera::core::gltf
