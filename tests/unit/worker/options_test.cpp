// SPDX-License-Identifier: Apache-2.0
// The cache folder of a worker that runs without HOME, as system services do.
#include "worker/options.hpp"

#include <gtest/gtest.h>
#include <pwd.h>
#include <unistd.h>

#include <cstdlib>
#include <optional>
#include <string>

namespace tessera::worker {
namespace {

// An environment without this variable.
class Without {
 public:
  explicit Without(const char* name) : name_(name) {
    if (const char* const value = std::getenv(name)) before_ = value;
    ::unsetenv(name);
  }
  Without(const Without&) = delete;
  Without& operator=(const Without&) = delete;
  ~Without() {
    if (before_) ::setenv(name_, before_->c_str(), 1);
  }

 private:
  const char* const name_;
  std::optional<std::string> before_;
};

// Others could make a folder in /tmp first, and change what is in it.
TEST(WorkerOptions, KeepTheCacheInTheHomeOfTheUserOrNowhere) {
  const Without home("HOME"), cache("XDG_CACHE_HOME");
  const passwd* const user = ::getpwuid(::geteuid());
  const std::string own = user == nullptr ? "" : std::string(user->pw_dir) + "/.cache/tessera";
  const std::string chosen = Options().cache;
  EXPECT_TRUE(chosen.empty() || chosen == own) << chosen;
}

}  // namespace
}  // namespace tessera::worker
