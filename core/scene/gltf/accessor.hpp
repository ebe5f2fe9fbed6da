// SPDX-License-Identifier: Apache-2.0
// Arrays of numbers in buffers: glTF's accessors, of any component type, normalised or not, interleaved or
// sparse (glTF 2.0 specification, section 3.6.2). Reading an element needs no further checks. Not
// thread-safe; functions throw Refusals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "core/math/transform.hpp"
#include "core/math/vec3.hpp"
#include "core/scene/gltf/buffers.hpp"
#include "core/scene/gltf/document.hpp"

namespace tessera::core::gltf {

// The values are those in files.
enum class Component {
  kByte = 5120,
  kUnsignedByte = 5121,
  kShort = 5122,
  kUnsignedShort = 5123,
  kUnsignedInt = 5125,
  kFloat = 5126,
};

class Accessor {
 public:
  struct Layout {
    Component component = Component::kFloat;
    std::size_t components = 1;  // of an element
    bool normalized = false;
    std::size_t stride = 0;  // of elements, in bytes
    std::size_t count = 0;   // of elements
  };

  Accessor() = default;  // without elements
  // `bytes` hold all elements of the layout; `owned` keeps them alive, if they are not a buffer's.
  Accessor(const Layout& layout, std::string_view bytes, std::shared_ptr<const std::string> owned = {})
      : layout_(layout), bytes_(bytes), owned_(std::move(owned)) {}

  std::size_t count() const { return layout_.count; }
  std::size_t components() const { return layout_.components; }
  Component component() const { return layout_.component; }

  // Component `c` of element `i`; both in range. Normalised integers become 0 to 1, or -1 to 1.
  float number(std::size_t i, std::size_t c) const;
  // The same for integers as they are stored; 0 for negative ones and for what is no number.
  std::uint32_t whole(std::size_t i, std::size_t c = 0) const;
  Vec2 vec2(std::size_t i) const { return {number(i, 0), number(i, 1)}; }
  Vec3 vec3(std::size_t i) const { return {number(i, 0), number(i, 1), number(i, 2)}; }
  // The bytes of an element.
  std::string_view raw(std::size_t i) const;
  // Of 16 components, column by column; the last row is not looked at.
  Transform matrix(std::size_t i) const;

 private:
  template <typename T>
  T stored(std::size_t i, std::size_t c) const;

  Layout layout_;
  std::string_view bytes_;
  std::shared_ptr<const std::string> owned_;
};

class Accessors {
 public:
  Accessors(const Document& document, Buffers& buffers) : document_(document), buffers_(buffers) {}

  // The accessor that `index` names, which must have so many components: 1 (SCALAR), 2 to 4 (VEC), 16 (MAT4).
  // VEC4 is accepted where 3 are asked for with `or_four`.
  Accessor read(const Value& index, std::size_t components, bool or_four = false);

  // The layout of an accessor by its parameters alone, packed.
  static Accessor::Layout layout_of(const Value& accessor);

 private:
  Accessor read(const Value& accessor);
  Accessor plain(const Value& accessor, const Accessor::Layout& packed);
  Accessor sparse(const Value& accessor, const Accessor::Layout& packed);
  // Elements of a part of a view.
  Accessor elements(const Value& place, const Accessor::Layout& packed);
  // Refuses copies that take too much memory together.
  void count_copy(const Value& accessor, const Accessor::Layout& packed);

  const Document& document_;
  Buffers& buffers_;
  std::map<std::string, Accessor> sparse_;  // by path
  std::uint64_t copied_bytes_ = 0;
};

}  // namespace tessera::core::gltf
