// Images looked up by surface coordinates. Immutable once built, shared by all threads.
//
// u runs to the right and v upwards, as in OBJ files: (0, 0) is the lower left corner of the picture.
// Texel centres lie at ((i + 0.5) / width, (j + 0.5) / height).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

enum class ColorSpace { kSrgb, kLinear };
enum class Wrap { kRepeat, kClamp };

// Decoded texels: width * height * 3 values, row-major from the top left.
struct TextureImage {
  int width = 0, height = 0;
  // Bytes as stored in PNG and JPEG files, or linear floats as in HDR files.
  std::variant<std::vector<std::uint8_t>, std::vector<float>> texels;
  ColorSpace color_space = ColorSpace::kSrgb;  // of bytes; floats are linear

  Rgb texel(int x, int y) const;                          // linear; 0 <= x < width, 0 <= y < height
  Rgb bilinear(Vec2 uv, Wrap wrap_u, Wrap wrap_v) const;  // linear, between the nearest four texels
  Rgb mean() const;                                       // of all texels, linear
  Rgb largest() const;                                    // of each channel, linear
};

struct Texture {
  std::shared_ptr<const TextureImage> image;  // never null; one image may serve many textures
  Wrap wrap = Wrap::kRepeat;
  Vec2 scale{1, 1};  // uv are multiplied by it, then `offset` is added
  Vec2 offset{0, 0};

  Rgb evaluate(Vec2 uv) const;  // bilinear, linear colour
};

// A constant, or a texture times a constant.
struct ColorParameter {
  Rgb value = Rgb::gray(1);
  int texture = -1;  // index among the scene's textures, -1 for none

  Rgb evaluate(const std::vector<Texture>& textures, Vec2 uv) const {
    return texture < 0 ? value : value * textures[static_cast<std::size_t>(texture)].evaluate(uv);
  }
};

// A number, or the red channel of a texture times a number.
struct ScalarParameter {
  ScalarParameter(float constant = 0, int texture_index = -1) : value(constant), texture(texture_index) {}

  float value;
  int texture;  // as above

  float evaluate(const std::vector<Texture>& textures, Vec2 uv) const {
    return texture < 0 ? value : value * textures[static_cast<std::size_t>(texture)].evaluate(uv).r;
  }
};

}  // namespace tessera::core
