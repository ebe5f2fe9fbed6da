// SPDX-License-Identifier: Apache-2.0
// Random numbers of the operating system. Thread-safe.
#pragma once

#include <cstdint>
#include <string>

namespace tessera::base {

// 64 random bits.
std::uint64_t random_number();
// 128 random bits as 32 lower-case hexadecimal digits.
std::string random_id();

}  // namespace tessera::base
