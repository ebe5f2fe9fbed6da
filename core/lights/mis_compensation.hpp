// SPDX-License-Identifier: Apache-2.0
// Whether light samples leave to BSDF samples what these find as well.
#pragma once

namespace tessera::core::lights {

// MIS compensation (Karlík, Šik, Vévoda, Skřivan and Křivánek 2019) applies where light samples are combined
// with BSDF samples by multiple importance sampling: then only light that is brighter than its surroundings
// needs light samples. Without such a partner every light must have a positive density.
enum class MisCompensation { kOff, kOn };

}  // namespace tessera::core::lights
