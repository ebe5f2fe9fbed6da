// SPDX-License-Identifier: Apache-2.0
// The widest float vector of the processor that a file is compiled for: two FloatN wide with AVX-512, else
// one. For code that works with any number of lanes and whose result does not depend on it.
#pragma once

#include "core/math/simd_double.hpp"
#include "core/math/simd_integer.hpp"
#ifdef __AVX512F__
#include "core/math/simd_avx512.hpp"
#endif

namespace tessera::core {

#ifdef __AVX512F__
using DoubleRegister = DoubleN;
#else
using FloatVector = FloatN;
using MaskVector = MaskN;
using DoubleVector = DoubleN;  // with the same number of lanes
using DoubleRegister = DoubleHalf;
#endif
inline constexpr std::size_t kVectorLanes = kLanes<FloatVector>;
// Padding and alignment of arrays that are read in vectors, independent of the target processor.
inline constexpr std::size_t kMaxVectorLanes = 16, kVectorAlignment = 64;

}  // namespace tessera::core
