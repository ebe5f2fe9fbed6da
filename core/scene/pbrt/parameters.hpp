// SPDX-License-Identifier: Apache-2.0
// The typed parameters of a directive: "float fov" [ 40 ]. Not thread-safe: reading a parameter marks it as
// used, and remarks what is replaced, so that both can be reported (report.hpp).
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/math/vec3.hpp"
#include "core/scene/pbrt/token_stream.hpp"

namespace tessera::core::pbrt {

struct Parameter {
  std::string type, name;
  Place place{};
  std::string color_space = "srgb";  // of RGB values: that of the place
  std::vector<float> floats{};       // of all numeric types but integers
  std::vector<std::int32_t> integers{};
  std::vector<std::string> strings{};  // also names of textures and spectra
  std::vector<std::string> written{};  // the same with their escapes, for names of files
  std::vector<bool> booleans{};
  mutable bool is_used = false;
  std::shared_ptr<bool> is_used_anywhere{};  // of a default, which several lists share

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
  // Makes copies of its parameters tell each other when one is read.
  void share_use();
  // Defaults for what this list does not give: of the directive Attribute.
  void set_defaults(std::shared_ptr<const Parameters> defaults) { defaults_ = std::move(defaults); }
  const std::vector<Parameter>& list() const { return list_; }
  const std::shared_ptr<const Parameters>& defaults() const { return defaults_; }

  // The last parameter of this name, whatever its type, or that of the defaults; else null. Marks it as used.
  const Parameter* find(std::string_view name) const;
  bool has(std::string_view name) const { return find(name) != nullptr; }
  // Whether a later one has the name of this one of the list.
  bool is_repeated(const Parameter& parameter) const { return last(parameter.name) != &parameter; }

  // The first value of a parameter; nullopt if it is not given, or has no value of this kind, which is
  // remarked. Integers count as numbers, and numbers as integers, without their fraction.
  std::optional<float> number(std::string_view name) const;
  float number(std::string_view name, float otherwise) const { return number(name).value_or(otherwise); }
  std::optional<int> integer(std::string_view name) const;
  int integer(std::string_view name, int otherwise) const { return integer(name).value_or(otherwise); }
  // The same within limits; a value outside becomes the nearer limit, which is remarked.
  float number_in(std::string_view name, float otherwise, float min, float max) const;
  int integer_in(std::string_view name, int otherwise, int min, int max) const;
  // A number above 0; nullopt if it is not given, or is not above 0, which is remarked.
  std::optional<float> positive(std::string_view name) const;
  // One of several texts; any other becomes `otherwise`, which is remarked.
  std::string choice(std::string_view name, std::string_view otherwise,
                     std::initializer_list<std::string_view> known) const;
  bool boolean(std::string_view name, bool otherwise) const;
  std::string text(std::string_view name, std::string_view otherwise = {}) const;
  // For find_file().
  std::string file_name(std::string_view name) const;
  std::vector<std::string> texts(std::string_view name) const;
  std::vector<float> numbers(std::string_view name) const;
  // Finite ones; empty, with a remark, if they are not four.
  std::vector<float> four_numbers(std::string_view name) const;
  // `each` belong together, as the corners of a triangle do.
  std::vector<std::int32_t> integers(std::string_view name, std::size_t each) const;
  std::optional<Vec3> vector(std::string_view name) const;
  Vec3 vector(std::string_view name, Vec3 otherwise) const { return vector(name).value_or(otherwise); }
  // Three or two numbers each; the rest of an incomplete list is left out, which is remarked.
  std::vector<Vec3> vectors(std::string_view name) const;
  std::vector<Vec2> points2(std::string_view name) const;

  // What is done instead of a value. `text` continues "the parameter 'fov' of the camera"; remarks of equal
  // kind are counted together.
  struct Remark {
    std::string name;
    Place place;
    std::string kind, text;
  };
  void remark(std::string_view name, std::string_view kind, std::string text) const;
  void remark(std::string_view name, std::string_view text) const { remark(name, text, std::string(text)); }
  const std::vector<Remark>& remarks() const { return remarks_; }

  // Those of this list that nothing has read.
  std::vector<const Parameter*> unused() const;

 private:
  // The last one of the list that has this name, or null.
  const Parameter* last(std::string_view name) const;
  // The rest of its values is not used.
  void expect_multiple(const Parameter& parameter, std::size_t values, std::size_t of) const;

  Place place_;
  std::vector<Parameter> list_;
  std::shared_ptr<const Parameters> defaults_;
  mutable std::vector<Remark> remarks_;
};

// Reads parameters up to the first token that is not the declaration of one: "type name" and a value, or
// several in brackets. Errors do not name the place, which is that of `tokens`.
Result<Parameters> parse_parameters(TokenStream& tokens, Place place, const std::string& color_space);

// A number of a scene file, such as "-1.5e3" or "+.5"; nullopt if it is not one. Infinite ones are the
// largest finite number; what programs write for a number that is none, such as "-nan(ind)", is NaN.
std::optional<float> parse_number(std::string_view text);

}  // namespace tessera::core::pbrt
