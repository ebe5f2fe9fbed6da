// SPDX-License-Identifier: Apache-2.0
// The log of a long-running program: lines on stderr, written by a thread of its own. Nothing that is logged
// waits for stderr: if nobody reads it, the oldest lines are dropped and counted. Many lines contain texts of
// others (names, reasons), so every line is made printable here. Thread-safe.
#pragma once

#include <spdlog/common.h>

#include <string>
#include <string_view>

#include "core/common/log_fields.hpp"

namespace tessera::common {

enum class LogFormat {
  kText,  // 2026-11-25T17:30:00.123Z info tessera-worker: registered with the coordinator
  kJson,  // an object with time, level, program, message and fields in each line
};

struct LogOptions {
  spdlog::level::level_enum level = spdlog::level::info;
  LogFormat format = LogFormat::kText;
};

// From now on spdlog writes to stderr, as `program`; to systemd's journal with priorities instead of levels
// and times. flush_log() is called when the program exits.
void log_to_stderr(const std::string& program, const LogOptions& options = {});

// Logs a line with what it is about. JSON has the fields as they are; text has those that the message does
// not mention, in brackets at its end. spdlog's functions log lines without fields.
void log(spdlog::level::level_enum level, std::string_view message, const LogFields& fields);
inline void log(const LogLine& line) {
  log(line.level, line.message, line.fields);
}

// Waits until everything is written, for at most a second. Call it before the process ends without exit().
void flush_log();

// Logs a defect of this program, with what is wrong, and ends the process.
[[noreturn]] void abort_with(const std::string& defect);

}  // namespace tessera::common
