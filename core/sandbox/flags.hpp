// SPDX-License-Identifier: Apache-2.0
// The options of every program that confines itself, and by which they are set.
#pragma once

namespace tessera::sandbox {

inline constexpr const char* kParentFlag = "--parent";
inline constexpr const char* kCompleteFlag = "--require-sandbox";
inline constexpr const char* kCheckFlag = "--check-sandbox";

}  // namespace tessera::sandbox
