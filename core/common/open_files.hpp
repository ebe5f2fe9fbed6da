// SPDX-License-Identifier: Apache-2.0
// The limit on the files that a process may open. Every connection takes one. Stateless.
#pragma once

namespace tessera::common {

// Raises the soft limit, often 1,024, to the hard limit. Does nothing if that fails.
void raise_file_limit();

}  // namespace tessera::common
