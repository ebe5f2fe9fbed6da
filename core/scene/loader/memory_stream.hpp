// A std::istream over bytes in memory that are not copied. (std::ispanstream comes with C++23.)
#pragma once

#include <istream>
#include <streambuf>
#include <string_view>

namespace tessera::core {

class MemoryStream : private std::streambuf, public std::istream {
 public:
  // `bytes` must outlive the stream.
  explicit MemoryStream(std::string_view bytes) : std::istream(static_cast<std::streambuf*>(this)) {
    char* begin =
        const_cast<char*>(bytes.data());  // streambuf reads through pointers to char; nothing writes
    setg(begin, begin, begin + bytes.size());
  }
};

}  // namespace tessera::core
