// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/file_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/printable.hpp"

namespace tessera::core {
namespace {

constexpr std::size_t kMaxSceneWarnings = 100;

}  // namespace

FileWarnings::Entry* FileWarnings::find(std::string_view kind) {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.kind == kind; });
  return found == entries_.end() ? nullptr : &*found;
}

std::vector<std::string> FileWarnings::messages(std::string_view file) const {
  std::vector<Entry> ordered = entries_;
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const Entry& a, const Entry& b) { return a.line < b.line; });
  std::vector<std::string> messages;
  for (const Entry& entry : ordered) {
    std::string message = printable(file);
    if (entry.line > 0) message += fmt::format(":{}", entry.line);
    message += ": " + printable(entry.text);
    if (entry.count > 1) message += fmt::format(" ({} {})", entry.count, entry.unit);
    messages.push_back(std::move(message));
  }
  if (untold_ > 0) messages.push_back(fmt::format("{}: and {} more warnings", printable(file), untold_));
  return messages;
}

bool SceneWarnings::knows(std::string_view file) const {
  return std::any_of(files_.begin(), files_.end(), [&](const auto& known) { return known.first == file; });
}

FileWarnings& SceneWarnings::of(std::string_view file) {
  const auto known =
      std::find_if(files_.begin(), files_.end(), [&](const auto& one) { return one.first == file; });
  return known == files_.end() ? files_.emplace_back(file, FileWarnings()).second : known->second;
}

std::vector<std::string> SceneWarnings::messages() const {
  std::vector<std::string> all;
  for (const auto& [file, warnings] : files_)
    for (std::string& message : warnings.messages(file)) all.push_back(std::move(message));
  if (all.size() > kMaxSceneWarnings) {
    const std::size_t untold = all.size() - kMaxSceneWarnings;
    all.resize(kMaxSceneWarnings);
    all.push_back(fmt::format("and {} more warnings", untold));
  }
  return all;
}

}  // namespace tessera::core
