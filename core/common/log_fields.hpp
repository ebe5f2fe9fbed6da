// SPDX-License-Identifier: Apache-2.0
// What a log line is about, for programs that read logs. Plain data.
#pragma once

#include <spdlog/common.h>

#include <string>

namespace tessera::common {

// Empty fields are left out.
struct LogFields {
  std::string job{};        // id
  std::string worker{};     // id
  std::string principal{};  // the authenticated caller
  std::string peer{};       // the address of the caller

  bool operator==(const LogFields&) const = default;
};

struct LogLine {
  std::string message;
  LogFields fields{};
  spdlog::level::level_enum level = spdlog::level::warn;
};

}  // namespace tessera::common
