// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/accessor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

// Elements of an accessor without a view, which takes memory that no file pays for.
constexpr std::uint64_t kMaxZeros = std::uint64_t{1} << 22;

std::size_t size_of(Component component) {
  switch (component) {
    case Component::kByte:
    case Component::kUnsignedByte:
      return 1;
    case Component::kShort:
    case Component::kUnsignedShort:
      return 2;
    case Component::kUnsignedInt:
    case Component::kFloat:
      return 4;
  }
  return 4;
}

std::size_t packed_size(const Accessor::Layout& layout) {
  return size_of(layout.component) * layout.components;
}

Component component_of(const Value& place) {
  const std::uint64_t type = place.whole_or("componentType", 0);
  switch (type) {
    case 5120:
    case 5121:
    case 5122:
    case 5123:
    case 5125:
    case 5126:
      return static_cast<Component>(type);
    default:
      place.refuse(fmt::format("there is no componentType {}", type));
  }
}

std::size_t components_of(const Value& accessor) {
  const std::string type = accessor.text("type");
  constexpr std::pair<std::string_view, std::size_t> kTypes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
  for (const auto& [name, count] : kTypes)
    if (type == name) return count;
  accessor.refuse(fmt::format("the type {} cannot be used here", in_quotes(type)));
}

// An integer as a part of the largest one (section 3.6.2.2).
template <typename T>
float normalized_value(T stored) {
  const float part = static_cast<float>(stored) / static_cast<float>(std::numeric_limits<T>::max());
  return std::max(part, -1.0f);
}

template <typename T>
float value_of(T stored, bool normalized) {
  if constexpr (std::is_same_v<T, float>)
    return stored;
  else
    return normalized ? normalized_value(stored) : static_cast<float>(stored);
}

std::uint32_t whole_of(float stored) {
  return stored > 0 && stored < 16777216.0f ? static_cast<std::uint32_t>(stored) : 0;
}
template <typename T>
std::uint32_t whole_of(T stored) {
  if constexpr (std::is_signed_v<T>)
    if (stored < 0) return 0;
  return static_cast<std::uint32_t>(stored);
}

// Calls visit(T()) with the C++ type of a component.
template <typename Visit>
auto with_type(Component component, const Visit& visit) {
  switch (component) {
    case Component::kByte:
      return visit(std::int8_t{});
    case Component::kUnsignedByte:
      return visit(std::uint8_t{});
    case Component::kShort:
      return visit(std::int16_t{});
    case Component::kUnsignedShort:
      return visit(std::uint16_t{});
    case Component::kUnsignedInt:
      return visit(std::uint32_t{});
    case Component::kFloat:
      break;
  }
  return visit(float{});
}

}  // namespace

template <typename T>
T Accessor::stored(std::size_t i, std::size_t c) const {
  T value;
  std::memcpy(&value, bytes_.data() + i * layout_.stride + c * sizeof(T), sizeof(T));
  return value;
}

float Accessor::number(std::size_t i, std::size_t c) const {
  return with_type(layout_.component,
                   [&](auto type) { return value_of(stored<decltype(type)>(i, c), layout_.normalized); });
}

std::uint32_t Accessor::whole(std::size_t i, std::size_t c) const {
  return with_type(layout_.component, [&](auto type) { return whole_of(stored<decltype(type)>(i, c)); });
}

std::string_view Accessor::raw(std::size_t i) const {
  return bytes_.substr(i * layout_.stride, packed_size(layout_));
}

Transform Accessor::matrix(std::size_t i) const {
  const auto column = [&](std::size_t c) {
    return Vec3{number(i, 4 * c), number(i, 4 * c + 1), number(i, 4 * c + 2)};
  };
  return {column(0), column(1), column(2), column(3)};
}

Accessor Accessors::read(const Value& index, std::size_t components, bool or_four) {
  const Value accessor = document_.element("accessors", index);
  Accessor read_elements = read(accessor);
  const std::size_t found = read_elements.components();
  if (found != components && !(or_four && found == 4))
    index.refuse(fmt::format("must be an accessor of {} components, and {} has {}", components,
                             accessor.path(), found));
  return read_elements;
}

Accessor::Layout Accessors::layout_of(const Value& accessor) {
  Accessor::Layout layout;
  layout.component = component_of(accessor);
  layout.components = components_of(accessor);
  layout.normalized = accessor.is_true("normalized");
  layout.count = static_cast<std::size_t>(accessor.whole_or("count", 0));
  layout.stride = packed_size(layout);
  return layout;
}

Accessor Accessors::read(const Value& accessor) {
  const Accessor::Layout packed = layout_of(accessor);
  if (!accessor["sparse"].exists()) return plain(accessor, packed);
  const auto known = sparse_.find(accessor.path());
  if (known != sparse_.end()) return known->second;
  return sparse_.emplace(accessor.path(), sparse(accessor, packed)).first->second;
}

void Accessors::count_copy(const Value& accessor, const Accessor::Layout& packed) {
  constexpr std::uint64_t kMaxCopied = std::uint64_t{4} << 30;
  copied_bytes_ += std::uint64_t{packed.count} * packed.stride;
  if (copied_bytes_ > kMaxCopied)
    accessor.refuse("accessors without bytes of their own take too much memory",
                    ErrorCode::kResourceExhausted);
}

Accessor Accessors::plain(const Value& accessor, const Accessor::Layout& packed) {
  if (accessor["bufferView"].exists()) return elements(accessor, packed);
  if (packed.count > kMaxZeros)
    accessor.refuse(
        fmt::format("has {} elements and no bufferView; at most {} can be without", packed.count, kMaxZeros),
        ErrorCode::kResourceExhausted);
  count_copy(accessor, packed);
  auto zeros = std::make_shared<const std::string>(packed.count * packed.stride, '\0');
  const std::string_view bytes = *zeros;
  return {packed, bytes, std::move(zeros)};
}

Accessor Accessors::elements(const Value& place, const Accessor::Layout& packed) {
  const Value index = place["bufferView"];
  if (!index.exists()) place.refuse("names no bufferView");
  const BufferView view = buffers_.view(index);
  const std::uint64_t offset = place.whole_or("byteOffset", 0);
  if (offset > view.bytes.size()) place.refuse("byteOffset lies beyond the bufferView");
  const std::string_view bytes = view.bytes.substr(static_cast<std::size_t>(offset));
  Accessor::Layout layout = packed;
  if (view.stride != 0) layout.stride = view.stride;
  const std::size_t size = packed_size(packed);
  if (layout.stride < size)
    place.refuse(fmt::format("elements of {} bytes are {} apart", size, layout.stride));
  const bool fits = packed.count == 0 ||
                    (bytes.size() >= size && packed.count - 1 <= (bytes.size() - size) / layout.stride);
  if (!fits)
    place.refuse(
        fmt::format("{} elements of {} bytes, {} apart, reach beyond the bufferView, which has {} from "
                    "there",
                    packed.count, size, layout.stride, bytes.size()));
  return {layout, bytes};
}

// A copy of the elements, some of them replaced.
Accessor Accessors::sparse(const Value& accessor, const Accessor::Layout& packed) {
  const Accessor base = plain(accessor, packed);
  auto bytes = std::make_shared<std::string>();
  const Value changes = accessor["sparse"];
  Accessor::Layout index_layout{component_of(changes["indices"]), 1, false, 0,
                                static_cast<std::size_t>(changes.whole_or("count", 0))};
  index_layout.stride = packed_size(index_layout);
  Accessor::Layout value_layout = packed;
  value_layout.count = index_layout.count;
  const Accessor indices = elements(changes["indices"], index_layout);
  const Accessor values = elements(changes["values"], value_layout);
  count_copy(accessor, packed);
  bytes->reserve(packed.count * packed.stride);
  for (std::size_t i = 0; i < packed.count; ++i) bytes->append(base.raw(i));
  for (std::size_t k = 0; k < indices.count(); ++k) {
    const std::size_t i = indices.whole(k);
    if (i >= packed.count)
      changes.refuse(fmt::format("replaces element {}; the accessor has {}", i, packed.count));
    const std::string_view value = values.raw(k);
    std::copy(value.begin(), value.end(), bytes->begin() + static_cast<std::ptrdiff_t>(i * packed.stride));
  }
  const std::string_view all = *bytes;
  return {packed, all, std::move(bytes)};
}

}  // namespace tessera::core::gltf
