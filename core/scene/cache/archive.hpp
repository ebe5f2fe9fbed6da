// SPDX-License-Identifier: Apache-2.0
// Serialises values of all types in scene_fields.hpp: small ones to a byte string, the contents of large
// arrays to blocks of a file, in order.
#pragma once

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "core/scene/cache/block_file.hpp"
#include "core/scene/cache/scene_fields.hpp"

namespace tessera::core::stored {

// Arrays of at least this size become blocks.
inline constexpr std::size_t kBlockBytes = 4096;

// `Blocks` is BlockFileWriter or any other sink of blocks.
template <typename Blocks>
class Writer {
 public:
  explicit Writer(Blocks& blocks) : blocks_(blocks) {}

  const std::vector<std::byte>& bytes() const { return bytes_; }

  template <typename T>
  void operator()(const T& value) {
    if constexpr (Plain<T>) {
      append(std::as_bytes(std::span(&value, 1)));
    } else {
      visit_fields(value, *this);
    }
  }
  void operator()(const std::string& text) { array(text); }
  template <typename T>
  void operator()(const std::vector<T>& elements) {
    array(elements);
  }
  template <typename T>
  void operator()(const accel::HugePageArray<T>& elements) {
    array(elements);
  }
  template <typename T>
  void operator()(const std::optional<T>& value) {
    (*this)(value.has_value());
    if (value) (*this)(*value);
  }
  template <typename... Ts>
  void operator()(const std::variant<Ts...>& value) {
    (*this)(static_cast<std::uint32_t>(value.index()));
    std::visit(*this, value);
  }
  // An image that several textures share is written once; procedural textures have none.
  void operator()(const std::shared_ptr<const TextureImage>& image) {
    (*this)(image != nullptr);
    if (!image) return;
    const auto [known, is_new] = images_.emplace(image.get(), static_cast<std::uint32_t>(images_.size()));
    (*this)(known->second);
    if (is_new) (*this)(image->texels());
  }

 private:
  void append(std::span<const std::byte> bytes) {
    const std::size_t end = bytes_.size();
    bytes_.resize(end + bytes.size());
    if (!bytes.empty()) std::memcpy(bytes_.data() + end, bytes.data(), bytes.size());
  }

  template <typename Array>
  void array(const Array& elements) {
    using Element = std::remove_cvref_t<decltype(elements[0])>;
    (*this)(std::uint64_t{elements.size()});
    if constexpr (Plain<Element>) {
      (*this)(static_cast<std::uint32_t>(sizeof(Element)));
      const auto bytes = std::as_bytes(std::span(elements.data(), elements.size()));
      if (bytes.size() < kBlockBytes) return append(bytes);
      blocks_.write_block(bytes);
    } else {
      for (const auto& element : elements) (*this)(element);
    }
  }

  Blocks& blocks_;
  std::vector<std::byte> bytes_;
  std::map<const TextureImage*, std::uint32_t> images_;
};

// The number of bytes that a Writer would write.
template <typename T>
std::uint64_t stored_bytes(const T& value) {
  struct Counter {
    std::uint64_t bytes = 0;
    void write_block(std::span<const std::byte> block) { bytes += block.size(); }
  };
  Counter blocks;
  Writer writer(blocks);
  writer(value);
  return blocks.bytes + writer.bytes().size();
}

// Reads what a Writer has written. It fails on what no Writer writes: sizes beyond the file, truths that are
// neither true nor false, enumerators that do not exist, texels that make no image. After a failure, values
// are unspecified. Memory for an array is taken only if the file is long enough to hold it.
class Reader {
 public:
  explicit Reader(BlockFileReader& file) : file_(file), rest_(file.index()) {}

  // Whether all reads so far succeeded.
  bool good() const { return good_; }
  // Whether all reads succeeded and no data is left.
  bool complete() const { return good_ && rest_.empty(); }

  template <typename T>
  void operator()(T& value) {
    if constexpr (std::is_enum_v<T>) {
      const auto number = read<std::underlying_type_t<T>>();
      good_ = good_ && is_known(static_cast<T>(number));
      if (good_) value = static_cast<T>(number);
    } else if constexpr (Plain<T>) {
      take(std::as_writable_bytes(std::span(&value, 1)));
    } else {
      visit_fields(value, *this);
    }
  }
  void operator()(bool& value) {
    const auto byte = read<std::uint8_t>();
    good_ = good_ && byte <= 1;
    value = byte == 1;
  }
  void operator()(std::string& text) {
    array(text, [&](std::size_t size) { text.resize(size); });
  }
  template <typename T>
  void operator()(std::vector<T>& elements) {
    array(elements, [&](std::size_t size) { elements.resize(size); });
  }
  template <typename T>
  void operator()(accel::HugePageArray<T>& elements) {
    array(elements, [&](std::size_t size) { elements = accel::HugePageArray<T>(size); });
  }
  template <typename T>
  void operator()(std::optional<T>& value) {
    value.reset();
    if (read<bool>() && good_) (*this)(value.emplace());
  }
  template <typename... Ts>
  void operator()(std::variant<Ts...>& value) {
    const auto index = read<std::uint32_t>();
    const auto take_if = [&]<typename T>(std::uint32_t own_index, std::type_identity<T>) {
      if (index == own_index) (*this)(value.template emplace<T>());
    };
    std::uint32_t own_index = 0;
    (take_if(own_index++, std::type_identity<Ts>{}), ...);
    good_ = good_ && index < own_index;
  }
  void operator()(std::shared_ptr<const TextureImage>& image) {
    image = nullptr;
    if (!read<bool>() || !good_) return;
    const auto index = read<std::uint32_t>();
    good_ = good_ && index <= images_.size();
    if (!good_) return;
    if (index == images_.size()) {
      auto texels = read<TextureImage::Texels>();
      good_ = good_ && TextureImage::is_sound(texels);
      if (!good_) return;
      images_.push_back(std::make_shared<TextureImage>(std::move(texels)));
    }
    image = images_[index];
  }

 private:
  template <typename T>
  T read() {
    T value{};
    (*this)(value);
    return value;
  }

  void take(std::span<std::byte> into) {
    good_ = good_ && into.size() <= rest_.size();
    if (!good_) return;
    std::ranges::copy(rest_.first(into.size()), into.begin());
    rest_ = rest_.subspan(into.size());
  }

  template <typename Array, typename Resize>
  void array(Array& elements, const Resize& resize) {
    using Element = std::remove_cvref_t<decltype(elements[0])>;
    static_assert(!std::is_enum_v<Element>, "the values of arrays are not checked");
    const auto size = read<std::uint64_t>();
    if constexpr (Plain<Element>) {
      good_ = good_ && read<std::uint32_t>() == sizeof(Element) &&
              size <= std::max<std::uint64_t>(rest_.size(), file_.bytes_left()) / sizeof(Element);
      if (!good_) return;
      resize(size);
      const auto bytes = std::as_writable_bytes(std::span(elements.data(), elements.size()));
      if (bytes.size() < kBlockBytes) return take(bytes);
      good_ = file_.read_block(bytes);
    } else {
      good_ = good_ && size <= rest_.size();  // every element takes at least one byte
      // One by one: elements may be much larger than the least that they take in a file.
      for (elements.clear(); good_ && elements.size() < size;) (*this)(elements.emplace_back());
    }
  }

  BlockFileReader& file_;
  std::span<const std::byte> rest_;
  bool good_ = true;
  std::vector<std::shared_ptr<const TextureImage>> images_;
};

}  // namespace tessera::core::stored
