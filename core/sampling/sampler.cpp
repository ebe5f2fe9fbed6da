// SPDX-License-Identifier: Apache-2.0
#include "core/sampling/sampler.hpp"

#include "core/sampling/sobol.hpp"

namespace tessera::core::sampling {

namespace {

// A pad's numbers as 32 bits each, of one sample or of several at once.
template <typename U32, typename U64>
std::array<U32, 4> scrambled_point(U64 key, U32 sample) {
  const U32 index = reverse_bits(owen_scramble_reversed(reverse_bits(sample), low_word(key)));
  const std::array<U32, 4> point = sobol_reversed(index);
  const U64 first = mix_bits(key + U64(1)), second = mix_bits(key + U64(2));
  const std::array<U32, 4> seeds{low_word(first), high_word(first), low_word(second), high_word(second)};
  std::array<U32, 4> scrambled;
  for (std::size_t d = 0; d < 4; ++d) scrambled[d] = reverse_bits(owen_scramble_reversed(point[d], seeds[d]));
  return scrambled;
}

}  // namespace

std::array<float, 4> Sampler::pad(std::uint32_t pad) const {
  const auto bits = scrambled_point(hash(pixel_key_, pad), sample_);
  return {unit_float(bits[0]), unit_float(bits[1]), unit_float(bits[2]), unit_float(bits[3])};
}

namespace {

std::array<FloatN, 4> unit_floats(const std::array<U32xN, 4>& bits) {
  return {unit_float(bits[0]), unit_float(bits[1]), unit_float(bits[2]), unit_float(bits[3])};
}

}  // namespace

std::array<FloatN, 4> Sampler::pads(const std::array<const Sampler*, 8>& samplers, std::uint32_t pad) {
  std::array<std::uint64_t, 8> keys;
  std::array<std::uint32_t, 8> samples;
  for (std::size_t lane = 0; lane < 8; ++lane) {
    keys[lane] = samplers[lane]->pixel_key_;
    samples[lane] = samplers[lane]->sample_;
  }
  return unit_floats(scrambled_point(hash(U64xN::of(keys), pad), U32xN::load(samples.data())));
}

std::array<FloatN, 4> Sampler::pads(const std::array<const Sampler*, 8>& samplers,
                                    const std::array<std::uint32_t, 8>& pads) {
  std::array<std::uint64_t, 8> keys;
  std::array<std::uint32_t, 8> samples;
  for (std::size_t lane = 0; lane < 8; ++lane) {
    keys[lane] = hash(samplers[lane]->pixel_key_, pads[lane]);
    samples[lane] = samplers[lane]->sample_;
  }
  return unit_floats(scrambled_point(U64xN::of(keys), U32xN::load(samples.data())));
}

float Sampler::opacity_number(std::uint64_t ray, std::uint32_t crossing) const {
  return pad(opacity_pad(ray, crossing))[crossing % kCrossingsPerPad];
}

NumberStream Sampler::stream(std::uint64_t name, std::uint32_t first_pad) const {
  constexpr std::uint64_t kStreamKey = 0x73747265616d0000u;
  const auto first = pad(first_pad);
  return NumberStream(hash(hash(hash(pixel_key_, kStreamKey), sample_), name), {first[0], first[1]});
}

std::array<double, 3> Sampler::film_dither() const {
  const std::uint64_t key = hash(~pixel_key_, sample_);
  const auto part = [key](int shift) { return static_cast<double>((key >> shift) & 0x1fffff) * 0x1p-21; };
  return {part(0), part(21), part(42)};
}

}  // namespace tessera::core::sampling
