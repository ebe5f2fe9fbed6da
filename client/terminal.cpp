// SPDX-License-Identifier: Apache-2.0
#include "client/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace tessera::client {
namespace {

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

TextStyle stdout_style() {
  if (::isatty(STDOUT_FILENO) == 0) return {};
  TextStyle style{.colored = variable("NO_COLOR").empty() && variable("TERM") != "dumb"};
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) style.columns = size.ws_col;
  return style;
}

std::string_view begin_color(Color color) {
  switch (color) {
    case Color::kNone:
      return "";
    case Color::kRed:
      return "\033[31m";
    case Color::kGreen:
      return "\033[32m";
    case Color::kYellow:
      return "\033[33m";
    case Color::kCyan:
      return "\033[36m";
    case Color::kDim:
      return "\033[2m";
  }
  return "";
}

std::string_view end_color() {
  return "\033[0m";
}

}  // namespace tessera::client
