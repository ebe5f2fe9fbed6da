// SPDX-License-Identifier: Apache-2.0
#include "core/sandbox/bundle_files.hpp"

#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "core/sandbox/file_channel.hpp"

namespace tessera::sandbox {

core::BundleAssets bundle_files(const std::vector<std::string>& names) {
  std::map<std::string, std::uint32_t> numbers;
  for (std::uint32_t i = 0; i < names.size(); ++i) numbers[names[i]] = i;
  return {std::set<std::string>(names.begin(), names.end()),
          [numbers = std::move(numbers)](const std::string& name,
                                         const std::string& shown) -> core::Result<std::string> {
            const auto file = request_file(kFileChannel, numbers.at(name), shown);
            if (!file) return core::fail(file.error());
            return core::read_asset(*file, shown);
          }};
}

}  // namespace tessera::sandbox
