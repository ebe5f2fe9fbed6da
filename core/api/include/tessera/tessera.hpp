// SPDX-License-Identifier: Apache-2.0
//
// The public interface of libtessera: loads a scene file and renders it in this process. It includes no
// other header of Tessera and hides the implementation, so a program built against 0.x.y works with every
// later y.
//
// The image is the same, byte for byte, for any number of threads and any partition of the render, and
// identical to that of the program `tessera` and of a farm of this version.
//
// Functions throw Error for failures outside the program (files, memory). Const member functions are
// thread-safe; other calls need external synchronisation.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#if defined(__GNUC__)
#define TESSERA_EXPORT __attribute__((visibility("default")))
#else
#define TESSERA_EXPORT
#endif

namespace tessera {

// A message that says what is wrong, where, and how to fix it.
class TESSERA_EXPORT Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The version of the loaded library, such as "0.2.0" or "0.2.0-14-gc88247d".
TESSERA_EXPORT std::string version();

// An image in linear light.
struct Image {
  int width = 0, height = 0;  // pixels
  std::vector<float> rgb;     // height * width * 3, row-major, the upper row first; sRGB primaries, linear
};

// Replacements for the settings of the scene file.
struct RenderOptions {
  std::optional<int> width, height;  // pixels
  std::optional<std::uint32_t> spp;  // samples per pixel
  std::optional<std::uint64_t> seed;
  int threads = 0;  // 0: one for each processor that this process may use
  // Called a few times a second with the completed fraction of the samples, from 0 to 1. If it returns
  // false, the render stops and the image holds the samples so far.
  std::function<bool(double)> progress;
};

// A scene that is built and ready to render.
class TESSERA_EXPORT Scene {
 public:
  // Reads a scene file and all files that it names, and builds the acceleration structure. Throws Error if
  // a file is missing or invalid, with file, line and field, or if memory runs out.
  static Scene load(const std::string& path);

  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  // Blocks until the image is complete or `options.progress` stops it. Throws Error if an option is out of
  // range or memory runs out.
  Image render(const RenderOptions& options = {}) const;

 private:
  struct Impl;
  explicit Scene(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Writes an image. The extension of `path` selects the format: .png (8 bits, sRGB), .exr, .hdr or .pfm
// (linear). The file is written atomically. Throws Error if the extension is unknown or the file cannot be
// written.
TESSERA_EXPORT void write_image(const Image& image, const std::string& path);

}  // namespace tessera
