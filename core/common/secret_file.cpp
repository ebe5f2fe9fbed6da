// SPDX-License-Identifier: Apache-2.0
#include "core/common/secret_file.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

namespace tessera::common {

std::optional<std::string> exposure_of(const std::string& path) {
  struct stat status {};
  if (path.empty() || ::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  if ((status.st_mode & (S_IROTH | S_IWOTH)) == 0) return std::nullopt;
  return fmt::format("every user of this machine can {} the secret in '{}': chmod 600 '{}'",
                     (status.st_mode & S_IWOTH) != 0 ? "change" : "read", path, path);
}

}  // namespace tessera::common
