// SPDX-License-Identifier: Apache-2.0
// The random numbers of one sample of one pixel: a pure function of (seed, pixel, sample number, dimension).
// There is no state and no stream, so that any sample can be taken anywhere, in any order.
//
// Dimensions come in pads of four. Within a pad the samples of a pixel form a four-dimensional Sobol'
// sequence, Owen-scrambled; pads are decorrelated by shuffling the sample numbers, and pixels by their
// scrambling (Burley 2020).
#pragma once

#include <array>
#include <cstdint>

#include "core/math/simd.hpp"
#include "core/sampling/hash.hpp"

namespace tessera::core::sampling {

// A sequence of independent random numbers, for decisions whose number nobody knows in advance. The first
// ones may come from a pad.
class NumberStream {
 public:
  explicit NumberStream(std::uint64_t key, std::array<float, 2> first) : key_(key), first_(first) {}

  // In [0, 1).
  float next() {
    const std::uint32_t index = count_++;
    if (index < first_.size()) return first_[index];
    return unit_float(static_cast<std::uint32_t>(hash(key_, index) >> 32));
  }

 private:
  std::uint64_t key_;
  std::array<float, 2> first_;
  std::uint32_t count_ = 0;
};

class Sampler {
 public:
  Sampler(std::uint64_t seed, int x, int y, std::uint32_t sample)
      : pixel_key_(hash(seed, (static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32) |
                                  static_cast<std::uint32_t>(x))),
        sample_(sample) {}

  // The four numbers of pad `pad`, each in [0, 1).
  std::array<float, 4> pad(std::uint32_t pad) const;
  // pad() of samplers, one in each lane.
  static std::array<FloatN, 4> pads(const std::array<const Sampler*, 8>& samplers, std::uint32_t pad);
  // As above, with a separate pad for each lane.
  static std::array<FloatN, 4> pads(const std::array<const Sampler*, 8>& samplers,
                                    const std::array<std::uint32_t, 8>& pads);

  // A number in [0, 1) that decides whether a ray hits a surface or passes through it, after `crossing`
  // earlier surfaces. `ray` distinguishes the rays of a sample.
  float opacity_number(std::uint64_t ray, std::uint32_t crossing) const;

  // The stream of this name, which begins with the first numbers of the pad. Streams of one sample with
  // different names are independent.
  NumberStream stream(std::uint64_t name, std::uint32_t first_pad) const;

  // Three numbers in [0, 1) for rounding a sample's channels to the film, independent of every pad.
  std::array<double, 3> film_dither() const;

 private:
  std::uint64_t pixel_key_;
  std::uint32_t sample_;
};

// Assigns pads to decisions. The layout affects the rendered bytes.
inline constexpr std::uint32_t kCameraPad = 0;  // pixel x, y; lens u, v
// The time at which the camera sends the ray, if the shutter is open for some time; the other numbers of the
// pad are unused. Its name is a hash, so that other pads keep their numbers.
inline constexpr std::uint32_t kTimePad = static_cast<std::uint32_t>(hash(0x74696d6500000000u, 0));
// The lamp that the lens connects to: u, v; choice, coarse and fine. Its name is a hash, too.
inline constexpr std::uint32_t kLensLightPad = static_cast<std::uint32_t>(hash(0x6c656e7300000000u, 0));
// At path vertex `depth` (the first surface the camera sees is 0):
inline constexpr std::uint32_t scatter_pad(int depth) {
  return 1 + 2 * static_cast<std::uint32_t>(depth);
}  // BSDF u, v, lobe; roulette
inline constexpr std::uint32_t light_pad(int depth) {
  return 2 + 2 * static_cast<std::uint32_t>(depth);
}  // light u, v; choice, coarse and fine

// At vertex `depth` of a path whose wavelength is still open: the wavelength. The other numbers are unused.
// Names are hashes, so that other pads keep their numbers.
inline constexpr std::uint32_t wavelength_pad(int depth) {
  constexpr std::uint64_t kWavelengthKey = 0x77617665006c656eu;
  return static_cast<std::uint32_t>(hash(kWavelengthKey, static_cast<std::uint64_t>(depth)));
}

// In a scene with media, for the segment that ends at vertex `depth`: collision distance and kind; for the
// first one, the channel that samples distances. Names are hashes, so that other pads keep their numbers.
inline constexpr std::uint32_t medium_pad(int depth) {
  constexpr std::uint64_t kMediumKey = 0x6d656469756d0000u;
  return static_cast<std::uint32_t>(hash(kMediumKey, static_cast<std::uint64_t>(depth)));
}
// The same for the shadow ray from vertex `depth`.
inline constexpr std::uint32_t shadow_medium_pad(int depth) {
  constexpr std::uint64_t kShadowMediumKey = 0x6d656469756d0001u;
  return static_cast<std::uint32_t>(hash(kShadowMediumKey, static_cast<std::uint64_t>(depth)));
}

// Whitted ray tracing has a tree of rays with a name for each node: the camera ray is the root, and the
// reflected (0) and refracted (1) rays at a ray's end are its children. Each node has a pad for each
// sampled light. Names and pads are hashes, so trees may have any depth.
inline constexpr std::uint64_t kTreeRoot = 0;
inline constexpr std::uint64_t tree_child(std::uint64_t node, std::uint32_t branch) {
  return hash(node, branch);
}
inline constexpr std::uint32_t tree_light_pad(std::uint64_t node, std::uint32_t light) {
  return static_cast<std::uint32_t>(hash(~node, light));
}  // light u, v; choice, coarse and fine

inline constexpr std::uint32_t tree_wavelength_pad(std::uint64_t node) {
  return static_cast<std::uint32_t>(hash(tree_child(node, ~0u), 0));
}  // the wavelength at the node

// Four crossings of a ray share a pad, whose name is a hash, too.
inline constexpr std::uint32_t kCrossingsPerPad = 4;
inline constexpr std::uint32_t opacity_pad(std::uint64_t ray, std::uint32_t crossing) {
  constexpr std::uint64_t kOpacityKey = 0x6f70616369747900u;
  return static_cast<std::uint32_t>(hash(hash(kOpacityKey, ray), crossing / kCrossingsPerPad));
}

}  // namespace tessera::core::sampling
