// SPDX-License-Identifier: Apache-2.0
#include "core/sandbox/check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string_view>
#include <vector>

#include "core/sandbox/flags.hpp"
#include "core/sandbox/memory_file.hpp"
#include "core/sandbox/process.hpp"

namespace tessera::sandbox {

using core::ErrorCode;

namespace {

constexpr std::chrono::seconds kTimeout{30};
constexpr std::size_t kMaxBytes = 1 << 16;

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

core::Result<core::OpenFile> no_file(std::uint32_t) {
  return core::fail(ErrorCode::kNotFound, "there are no files to check a sandbox with");
}

// The sentences that the program prints.
core::Result<std::vector<std::string>> missing_of(const std::string& path) {
  const auto in = create_memory_file("request"), out = create_memory_file("missing");
  if (!in) return core::fail(in.error());
  if (!out) return core::fail(out.error());
  const auto ending =
      run({.path = path, .arguments = {kCheckFlag}, .timeout = kTimeout}, {*in, *out, no_file});
  if (!ending) return core::fail(ending.error());
  if (!ending->succeeded()) return core::fail(ErrorCode::kInternal, describe(*ending, path));
  const auto printed = read_memory_file(*out, kMaxBytes);
  if (!printed) return core::fail(printed.error());
  return lines_of(*printed);
}

}  // namespace

core::Status check_sandbox(const std::string& path, bool must_be_complete,
                           const std::function<void(const std::string& line)>& warn) {
  const std::string name = std::filesystem::path(path).filename().string();
  const auto found = missing_of(path);
  const std::vector<std::string> missing =
      found ? *found : std::vector{fmt::format("it cannot be checked ({})", found.error().message)};
  if (!must_be_complete) {
    for (const std::string& part : missing)
      warn(fmt::format("the sandbox of {} is incomplete: {}", name, part));
    return {};
  }
  if (missing.empty()) return {};
  return core::fail(ErrorCode::kFailedPrecondition,
                    fmt::format("the sandbox of {} is incomplete: {}; without {}, that is accepted", name,
                                fmt::join(missing, "; "), kCompleteFlag));
}

}  // namespace tessera::sandbox
