// Tells builds apart whose arithmetic differs.
#pragma once

#include <string>

namespace tessera::core {

// 16 hexadecimal digits: a hash of the exact film of a small built-in scene. Machines whose fingerprints are
// equal render the same bytes, as far as that scene can tell. Takes some milliseconds.
std::string arithmetic_fingerprint();

}  // namespace tessera::core
