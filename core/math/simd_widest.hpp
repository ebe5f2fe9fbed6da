// SPDX-License-Identifier: Apache-2.0
// As many floats at once as the widest registers hold that a file is compiled for: sixteen with AVX-512, or
// eight. For code that reads the same with any number of lanes, and whose result does not depend on it.
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
using DoubleVector = WideOf<FloatVector>;  // of as many lanes
inline constexpr std::size_t kVectorLanes = kLanes<FloatVector>;
// Of arrays that are read in vectors, whoever is compiled for which.
inline constexpr std::size_t kMaxVectorLanes = 16, kVectorAlignment = 64;

}  // namespace tessera::core
