// SPDX-License-Identifier: Apache-2.0
//
// The public interface of libtessera: loads a scene file and renders it in this process. It includes nothing of
// Tessera's own and hides everything behind it, so that a program built against one 0.x.y works with every later y.
//
// The image is the same, byte for byte, for any number of threads and any way of cutting the render into pieces, and the
// same as that of the program `tessera` and of a farm of this version.
//
// Functions throw Error where something is wrong outside the program (files, memory). Objects may be used from several
// threads at once as long as none of them calls a function that is not const.
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

// A sentence that says what is wrong, where, and what to mend.
class TESSERA_EXPORT Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The version of the library that is loaded, such as "0.2.0" or "0.2.0-14-gc88247d".
TESSERA_EXPORT std::string version();

// An image in linear light.
struct Image {
  int width = 0, height = 0;     // pixels
  std::vector<float> rgb;        // height * width * 3, row-major, the upper row first; sRGB primaries, linear
};

// Replacements for the settings of the scene file.
struct RenderOptions {
  std::optional<int> width, height;         // pixels
  std::optional<std::uint32_t> spp;         // samples per pixel
  std::optional<std::uint64_t> seed;
  int threads = 0;                          // 0: one for each processor
  // Called a few times a second with the share of the samples that are done, from 0 to 1. The render stops when it
  // answers false, and the image then has the samples so far.
  std::function<bool(double)> progress;
};

// A scene, built and ready to be rendered.
class TESSERA_EXPORT Scene {
 public:
  // Reads a scene file and all files that it names, and builds the acceleration structure. Error: a file is missing or
  // wrong, with file, line and field; or not enough memory.
  static Scene load(const std::string& path);

  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  // Blocks until the image is complete or `options.progress` stops it. Error: an option is out of range, or not enough
  // memory.
  Image render(const RenderOptions& options = {}) const;

 private:
  struct Impl;
  explicit Scene(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Writes an image; the ending of `path` picks the format: .png (8 bits, sRGB), .exr, .hdr or .pfm (linear). The file appears
// whole or not at all. Error: the ending is unknown, or the file cannot be written.
TESSERA_EXPORT void write_image(const Image& image, const std::string& path);

}  // namespace tessera
