// SPDX-License-Identifier: Apache-2.0
// The determinism fingerprint of this release: the result of core::integrators::determinism_fingerprint()
// (core/integrators). A coordinator, which cannot render, accepts only workers with this fingerprint. It
// changes with every change of the rendered bytes; fingerprint_test.cpp compares it and prints the new
// value.
#pragma once

#include <string_view>

namespace tessera::core {

inline constexpr std::string_view kDeterminismFingerprint = "1babfa0636cdabbd";

}  // namespace tessera::core
