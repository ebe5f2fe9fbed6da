// SPDX-License-Identifier: Apache-2.0
// What stands in for libFuzzer where the compiler has none: gives the fuzzer that the command line names
// first the files named there, and those in the folders named there; with --mutants N also N mutants of each,
// which are the same at every run. The last line printed names the input that crashed.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "tests/fuzz/fuzzer.hpp"

namespace {

using tessera::fuzz::Fuzzer;

using Bytes = std::vector<std::uint8_t>;

std::vector<std::string> files_of(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return {path};
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(path)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

// Changes a bit, replaces, inserts, removes, repeats or cuts; once to four times.
Bytes mutate(Bytes bytes, std::mt19937& random) {
  for (auto changes = 1 + random() % 4; changes > 0; --changes) {
    const std::size_t at = bytes.empty() ? 0 : random() % bytes.size();
    const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const auto to = from + std::min<std::ptrdiff_t>(random() % 16, bytes.end() - from);
    const Bytes piece(from, to);
    switch (random() % 6) {
      case 0:
        if (!bytes.empty()) bytes[at] ^= static_cast<std::uint8_t>(1u << random() % 8);
        break;
      case 1:
        if (!bytes.empty()) bytes[at] = static_cast<std::uint8_t>(random());
        break;
      case 2:
        bytes.insert(from, static_cast<std::uint8_t>(random()));
        break;
      case 3:
        bytes.erase(from, to);
        break;
      case 4:
        bytes.insert(from, piece.begin(), piece.end());
        break;
      default:
        if (random() % 8 == 0) bytes.resize(at);
    }
  }
  return bytes;
}

void give(Fuzzer fuzzer, const Bytes& bytes, const std::string& name) {
  std::printf("%s\n", name.c_str());
  std::fflush(stdout);
  fuzzer(tessera::fuzz::as_text(bytes.data(), bytes.size()));
}

// How many inputs were given; 0 where the file cannot be read.
int replay(Fuzzer fuzzer, const std::string& path, int mutants) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return 0;
  const Bytes bytes{std::istreambuf_iterator<char>(file), {}};
  give(fuzzer, bytes, path);
  std::mt19937 random(static_cast<std::uint32_t>(bytes.size()));
  for (int i = 0; i < mutants; ++i)
    give(fuzzer, mutate(bytes, random), path + ", mutant " + std::to_string(i));
  return 1 + mutants;
}

}  // namespace

int main(int count, char** arguments) {
  const auto& known = tessera::fuzz::fuzzers();
  const auto fuzzer = known.find(count > 1 ? arguments[1] : "");
  if (fuzzer == known.end()) {
    std::fprintf(stderr, "name one of these fuzzers first:");
    for (const auto& [name, function] : known) std::fprintf(stderr, " %s", std::string(name).c_str());
    std::fprintf(stderr, "\n");
    return EXIT_FAILURE;
  }
  int replayed = 0, mutants = 0;
  for (int i = 2; i < count; ++i) {
    const std::string_view argument = arguments[i];
    if (argument == "--mutants" && i + 1 < count) {
      mutants = std::atoi(arguments[++i]);
      continue;
    }
    for (const std::string& path : files_of(argument)) {
      const int given = replay(fuzzer->second, path, mutants);
      if (given == 0) {
        std::fprintf(stderr, "cannot read %s\n", path.c_str());
        return EXIT_FAILURE;
      }
      replayed += given;
    }
  }
  std::printf("%d inputs given\n", replayed);
  return replayed > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
