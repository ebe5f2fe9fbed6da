// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/file_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "core/base/printable.hpp"

namespace tessera::core {
FileWarnings::Entry* FileWarnings::find(std::string_view kind) {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.kind == kind; });
  return found == entries_.end() ? nullptr : &*found;
}

std::vector<FileWarnings::Entry> FileWarnings::ordered() const {
  std::vector<Entry> entries = entries_;
  if (!limits_.every_place) {
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry& a, const Entry& b) { return a.line < b.line; });
    return entries;
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.line, a.text, a.kind) < std::tie(b.line, b.text, b.kind);
  });
  // The same of the same place is told once, such as that of a mesh which several nodes show.
  std::vector<Entry> distinct;
  for (Entry& entry : entries) {
    const bool is_known =
        !distinct.empty() && distinct.back().line == entry.line && distinct.back().text == entry.text;
    if (is_known)
      distinct.back().count += entry.count;
    else
      distinct.push_back(std::move(entry));
  }
  return distinct;
}

std::vector<std::string> FileWarnings::messages(std::string_view file) const {
  std::vector<std::string> messages;
  for (const Entry& entry : ordered()) {
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
  return known == files_.end() ? files_.emplace_back(file, FileWarnings(limits_)).second : known->second;
}

std::vector<std::string> SceneWarnings::messages() const {
  std::vector<std::string> all;
  for (const auto& [file, warnings] : files_)
    for (std::string& message : warnings.messages(file)) all.push_back(std::move(message));
  if (all.size() > limits_.per_scene) {
    const std::size_t untold = all.size() - limits_.per_scene;
    all.resize(limits_.per_scene);
    all.push_back(fmt::format("and {} more warnings", untold));
  }
  return all;
}

}  // namespace tessera::core
