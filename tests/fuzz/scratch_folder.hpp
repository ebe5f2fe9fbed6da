// SPDX-License-Identifier: Apache-2.0
// Where fuzzers put what must be a file: in memory, where the machine has such.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "tests/fuzz/expect.hpp"

namespace tessera::fuzz {

// Of this process alone; removed with all that is in it when the process ends.
inline const std::filesystem::path& scratch_folder() {
  struct Folder {
    std::filesystem::path path;

    Folder() {
      const std::filesystem::path memory = "/dev/shm";
      const auto parent =
          std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
      std::string name = (parent / "tessera-fuzz-XXXXXX").string();
      expect(mkdtemp(name.data()) != nullptr, "a folder for scratch files can be made");
      path = name;
    }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
  };
  static const Folder folder;
  return folder.path;
}

// The path of a file there that holds these bytes until the next call with this name.
inline std::string scratch_file(const std::string& name, std::string_view bytes) {
  const std::filesystem::path path = scratch_folder() / name;
  std::ofstream(path, std::ios::binary) << bytes;
  return path.string();
}

}  // namespace tessera::fuzz
