// SPDX-License-Identifier: Apache-2.0
#include "client/console.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>

#include "core/base/printable.hpp"

namespace tessera::client {

namespace {

// Unlike fmt::print, does not throw if writing fails.
void write(std::FILE* stream, std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stream);
  std::fflush(stream);
}

}  // namespace

const std::vector<cli::HelpText::ExitStatus> kUsualExitStatuses{{kExitOk, "done"},
                                                                {kExitFailed, "failed"},
                                                                {kExitUsage, "wrong command line"},
                                                                {kExitInterrupted, "interrupted"}};

void print_result(std::string_view text) {
  write(stdout, text);
}

bool results_are_lost() {
  return std::ferror(stdout) != 0;
}

int print_error(std::string_view message) {
  return cli::print_error("tessera", message);
}

int print_error(const core::Error& error) {
  return print_error(error.message);
}

void print_warning(std::string_view message) {
  write(stderr, fmt::format("tessera: warning: {}\n", core::printable_lines(message)));
}

void print_warnings(const std::vector<std::string>& messages) {
  for (const std::string& message : messages) print_warning(message);
}

void warn_about_darkness(std::string_view scene_path) {
  print_warning(fmt::format("'{}' has no light: the image will be black", scene_path));
}

void warn_about_ignored_media(std::string_view scene_path) {
  print_warning(
      fmt::format("'{}' has participating media, which the integrator whitted ignores", scene_path));
}

void warn_about_still_frames(std::string_view scene_path) {
  print_warning(
      fmt::format("nothing in '{}' changes from frame to frame: all are the same image (the animations of a "
                  "glTF file are rendered at one time: --animation-time)",
                  scene_path));
}

void print_hint(std::string_view command) {
  write(stderr, fmt::format("Try: {}\n", core::printable(command)));
}

void print_note(std::string_view line) {
  write(stderr, core::printable(line) + "\n");
}

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace tessera::client
