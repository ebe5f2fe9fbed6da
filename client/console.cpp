#include "client/console.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>

#include "core/base/printable.hpp"

namespace tessera::client {

int print_error(std::string_view message) {
  fmt::print(stderr, "tessera: error: {}\n", core::printable_lines(message));
  return kExitFailed;
}

int print_error(const core::Error& error) {
  return print_error(error.message);
}

void print_warning(std::string_view message) {
  fmt::print(stderr, "tessera: warning: {}\n", core::printable_lines(message));
}

void warn_about_darkness(std::string_view scene_path) {
  print_warning(fmt::format("'{}' has no light: the picture will be black", scene_path));
}

void print_hint(std::string_view command) {
  fmt::print(stderr, "Try: {}\n", core::printable(command));
}

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace tessera::client
