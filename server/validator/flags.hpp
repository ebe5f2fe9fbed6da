// SPDX-License-Identifier: Apache-2.0
// The option names by which the coordinator passes limits to tessera-validator. Limits of the coordinator's
// command line have the same names there.
#pragma once

namespace tessera::validator {

inline constexpr const char* kTrianglesFlag = "--max-triangles";
inline constexpr const char* kLightsFlag = "--max-lights";
inline constexpr const char* kTexturePixelsFlag = "--max-texture-pixels";
inline constexpr const char* kSceneTexturePixelsFlag = "--max-scene-texture-pixels";
inline constexpr const char* kMemoryFlag = "--validator-mib";
inline constexpr const char* kSecondsFlag = "--validator-seconds";

}  // namespace tessera::validator
