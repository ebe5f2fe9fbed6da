// SPDX-License-Identifier: Apache-2.0
#include "client/farm/service_options.hpp"

#include <fmt/format.h>

#include <charconv>
#include <limits>
#include <string>
#include <system_error>

#include "client/scene_flags.hpp"

namespace tessera::client {
namespace {

std::int32_t parse_priority(const std::string& text) {
  using Limits = std::numeric_limits<std::int32_t>;
  std::int32_t priority = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, priority);
  if (text.empty() || error != std::errc() || stopped != end) {
    throw CLI::ValidationError("--priority", fmt::format("must be a whole number from {} to {}; got '{}'",
                                                         Limits::min(), Limits::max(), text));
  }
  return priority;
}

}  // namespace

void add_service_options(CLI::App& command, const std::string& when_absent, ServiceOptions& options) {
  command
      .add_option_function<std::string>(
          "--priority", [&options](const std::string& text) { options.priority = parse_priority(text); },
          "Jobs of higher priority are rendered first; jobs of equal priority share the farm evenly "
          "[default: " +
              when_absent + "]")
      ->type_name("N");
  command
      .add_option_function<std::string>(
          "--max-workers",
          [&options](const std::string& text) {
            constexpr auto kMax = std::numeric_limits<std::uint32_t>::max();
            options.max_workers =
                static_cast<std::uint32_t>(parse_whole_number("--max-workers", text, 0, kMax));
          },
          "Maximum workers that render the job at once; 0 for no limit [default: " + when_absent + "]")
      ->type_name("N");
}

}  // namespace tessera::client
