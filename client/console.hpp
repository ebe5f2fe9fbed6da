// What a command says besides its result, always on stderr, and made printable (core/base/printable.hpp).
#pragma once

#include <string_view>

#include "core/base/error.hpp"

namespace tessera::client {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitInterrupted = 130;

// "tessera: error: MESSAGE". Returns kExitFailed, so that a command can end with it.
int print_error(std::string_view message);
int print_error(const core::Error& error);

// "tessera: warning: MESSAGE"
void print_warning(std::string_view message);

// That the scene at `path` gives no light and its picture will be black.
void warn_about_darkness(std::string_view scene_path);

// "Try: COMMAND"
void print_hint(std::string_view command);

// Seconds on a clock that never runs backwards; its zero means nothing.
double steady_seconds();

}  // namespace tessera::client
