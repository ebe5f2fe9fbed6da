// SPDX-License-Identifier: Apache-2.0
// The typed parameters of a directive: "float fov" [ 40 ]. Not thread-safe: reading a parameter marks it as
// used, so that the others can be reported.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/math/vec3.hpp"
#include "core/scene/pbrt/tokenizer.hpp"

namespace tessera::core::pbrt {

// A line of a file of the scene. `file` is its path in the scene's assets.
struct Place {
  std::shared_ptr<const std::string> file;
  int line = 0;
};

struct Parameter {
  std::string type, name;
  int line = 0;
  std::vector<float> floats{};  // of all numeric types but integers
  std::vector<std::int32_t> integers{};
  std::vector<std::string> strings{};  // also names of textures and spectra
  std::vector<bool> booleans{};
  mutable bool is_used = false;

  std::size_t size() const { return floats.size() + integers.size() + strings.size() + booleans.size(); }
};

class Parameters {
 public:
  Parameters() = default;
  explicit Parameters(Place place) : place_(std::move(place)) {}

  const Place& place() const { return place_; }
  // Where the parameter is, or the directive if it is not given.
  Place place_of(const Parameter* parameter) const;
  void add(Parameter parameter) { list_.push_back(std::move(parameter)); }
  // Defaults for what this list does not give: of the directive Attribute.
  void set_defaults(std::shared_ptr<const Parameters> defaults) { defaults_ = std::move(defaults); }
  const std::vector<Parameter>& list() const { return list_; }
  const std::shared_ptr<const Parameters>& defaults() const { return defaults_; }

  // The last parameter of this name, whatever its type, or that of the defaults; else null. Marks it as used.
  const Parameter* find(std::string_view name) const;
  bool has(std::string_view name) const { return find(name) != nullptr; }

  // The first value of a parameter; nullopt if it is not given or has no value of this kind. Integers count
  // as numbers, and whole numbers as integers.
  std::optional<float> number(std::string_view name) const;
  float number(std::string_view name, float otherwise) const { return number(name).value_or(otherwise); }
  std::optional<int> integer(std::string_view name) const;
  int integer(std::string_view name, int otherwise) const { return integer(name).value_or(otherwise); }
  bool boolean(std::string_view name, bool otherwise) const;
  std::string text(std::string_view name, std::string_view otherwise = {}) const;
  std::vector<std::string> texts(std::string_view name) const;
  std::vector<float> numbers(std::string_view name) const;
  std::vector<std::int32_t> integers(std::string_view name) const;
  std::optional<Vec3> vector(std::string_view name) const;
  Vec3 vector(std::string_view name, Vec3 otherwise) const { return vector(name).value_or(otherwise); }
  // Three or two numbers each; the rest of an incomplete list is left out.
  std::vector<Vec3> vectors(std::string_view name) const;
  std::vector<Vec2> points2(std::string_view name) const;

  // Those of this list that nothing has read.
  std::vector<const Parameter*> unused() const;

 private:
  Place place_;
  std::vector<Parameter> list_;
  std::shared_ptr<const Parameters> defaults_;
};

// Reads parameters up to the first token that is not the declaration of one: "type name" and a value, or
// several in brackets. Errors do not name the line, which is the tokenizer's.
Result<Parameters> parse_parameters(Tokenizer& tokens, Place place);

// A number of a scene file, such as "-1.5e3" or "+.5"; nullopt if it is not one. Infinite ones are the
// largest finite number.
std::optional<float> parse_number(std::string_view text);

}  // namespace tessera::core::pbrt
