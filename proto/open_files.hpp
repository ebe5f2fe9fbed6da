// SPDX-License-Identifier: Apache-2.0
// How many files a process may open. Every connection takes one. Stateless.
#pragma once

namespace tessera::proto {

// As many as the system lets it have: many allow 1,024 unless asked. Where that is not to be had, as many as
// before.
void raise_file_limit();

}  // namespace tessera::proto
