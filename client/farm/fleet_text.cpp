// SPDX-License-Identifier: Apache-2.0
#include "client/farm/fleet_text.hpp"

#include <fmt/format.h>
#include <google/protobuf/util/time_util.h>

#include <vector>

#include "client/farm/job_text.hpp"
#include "client/farm/table.hpp"
#include "core/base/printable.hpp"

namespace tessera::client {

using google::protobuf::util::TimeUtil;

std::string quarantine_table(const v1::ListQuarantineResponse& quarantine, double now_seconds,
                             const TextStyle& style) {
  std::vector<std::vector<std::string>> rows;
  for (const v1::QuarantineEntry& entry : quarantine.entries())
    rows.push_back({short_id(entry.id()), entry.worker_name(),
                    entry.principal().empty() ? "-" : entry.principal(), ago(entry.since(), now_seconds)});
  std::string table = format_table({{.title = "ENTRY"},
                                    {.title = "WORKER", .is_flexible = true},
                                    {.title = "PRINCIPAL", .is_flexible = true, .rank = 1},
                                    {.title = "SINCE", .align = Align::kRight}},
                                   rows, style);
  for (const v1::QuarantineEntry& entry : quarantine.entries())
    table += core::printable(
                 fmt::format("{} ({}): {}", entry.worker_name(), short_id(entry.id()), entry.reason())) +
             "\n";
  return table;
}

std::string server_description(const v1::GetServerInfoResponse& info, const std::string& address,
                               const TextStyle& style) {
  const auto& limits = info.limits();
  const auto or_none = [](const std::string& text) { return text.empty() ? std::string("-") : text; };
  return format_description(
      {{"coordinator", address},
       {"release", info.version()},
       {"started", TimeUtil::ToString(info.started_at())},
       {"fingerprints", fmt::format("{}", fmt::join(info.determinism_fingerprints(), " "))},
       {"principal", or_none(info.principal())},
       {"role", or_none(info.role())},
       {"features", fmt::format("{}", fmt::join(info.features(), " "))},
       {"max message", fmt::format("{} bytes", limits.message_bytes())},
       {"max file", fmt::format("{} bytes", limits.blob_bytes())},
       {"max scene", fmt::format("{} bytes in {} files", limits.bundle_bytes(), limits.bundle_files())},
       {"max image", fmt::format("{} pixels", limits.image_pixels())},
       {"max spp", std::to_string(limits.spp())},
       {"max images", std::to_string(limits.images())}},
      style);
}

}  // namespace tessera::client
