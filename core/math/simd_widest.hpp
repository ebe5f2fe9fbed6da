// SPDX-License-Identifier: Apache-2.0
// The widest float vector of the processor that a file is compiled for: sixteen lanes with AVX-512, else
// eight. For code that works with any number of lanes and whose result does not depend on it.
#pragma once

#include "core/math/simd_double8.hpp"
#include "core/math/simd_integer.hpp"
#ifdef __AVX512F__
#include "core/math/simd_float16.hpp"
#endif

namespace tessera::core {

#ifdef __AVX512F__
using FloatVector = Float16;
using DoubleRegister = Double8;
#else
using FloatVector = Float8;
using DoubleRegister = Double4;
#endif
using MaskVector = MaskOf<FloatVector>;
using DoubleVector = WideOf<FloatVector>;  // with the same number of lanes
inline constexpr std::size_t kVectorLanes = kLanes<FloatVector>;
// Padding and alignment of arrays that are read in vectors, independent of the target processor.
inline constexpr std::size_t kMaxVectorLanes = 16, kVectorAlignment = 64;

}  // namespace tessera::core
