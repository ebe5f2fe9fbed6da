// SPDX-License-Identifier: Apache-2.0
// Priorities of log lines for systemd's journal: a prefix of each line on stderr (sd-daemon(3)). Stateless.
#pragma once

#include <spdlog/common.h>

#include <string_view>

namespace tessera::common {

// Whether stderr is the stream to the journal that JOURNAL_STREAM names.
bool stderr_is_journal();

// "<4>" for warnings. The journal removes it and keeps the priority.
std::string_view journal_prefix(spdlog::level::level_enum level);

}  // namespace tessera::common
