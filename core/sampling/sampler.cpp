#include "core/sampling/sampler.hpp"

#include "core/sampling/sobol.hpp"

namespace tessera::core {

std::array<float, 4> Sampler::pad(std::uint32_t pad) const {
  const std::uint64_t key = hash(pixel_key_, pad);
  const auto shuffle_seed = static_cast<std::uint32_t>(key);
  const std::uint32_t index = reverse_bits(owen_scramble_reversed(reverse_bits(sample_), shuffle_seed));
  const auto point = sobol_reversed(index);
  std::array<std::uint32_t, 4> seeds;
  for (std::size_t d = 0; d < 4; ++d) seeds[d] = static_cast<std::uint32_t>(mix_bits(key + d + 1) >> 32);
  std::array<float, 4> u;
  for (std::size_t d = 0; d < 4; ++d)  // all four at once, in vector registers
    u[d] = unit_float(reverse_bits(owen_scramble_reversed(point[d], seeds[d])));
  return u;
}

std::array<double, 3> Sampler::film_dither() const {
  const std::uint64_t key = hash(~pixel_key_, sample_);
  const auto part = [key](int shift) { return static_cast<double>((key >> shift) & 0x1fffff) * 0x1p-21; };
  return {part(0), part(21), part(42)};
}

}  // namespace tessera::core
