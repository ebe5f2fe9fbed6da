// SPDX-License-Identifier: Apache-2.0
// How a confined process, which cannot open files, gets those of its scene: it asks its parent for them by
// number, and the parent sends open descriptors (SCM_RIGHTS). Each end is for one thread at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "core/base/error.hpp"
#include "core/base/open_file.hpp"

namespace tessera::sandbox {

// The descriptor of the confined process's end.
inline constexpr int kFileChannel = 3;

struct FileChannel {
  core::OpenFile parent, child;

  static core::Result<FileChannel> create();
};

// Opens the file with this number, for reading. Numbers come from the confined process: it may ask for files
// that there are not, and for the same file again and again.
using OpenNumbered = std::function<core::Result<core::OpenFile>(std::uint32_t number)>;

// For the parent: opens an ordinary file. Errors do not name it: they are for the confined process.
core::Result<core::OpenFile> open_to_send(const std::string& path);

// For the parent: answers one request. Does not block. False if the other end is closed or does not keep to
// the protocol: no request is answered after that.
bool answer_request(const core::OpenFile& channel, const OpenNumbered& open);

// For the confined process: the file with this number. Blocks until the parent answers. The error has the
// code of the parent's and the name `shown`.
core::Result<core::OpenFile> request_file(int channel, std::uint32_t number, const std::string& shown);

}  // namespace tessera::sandbox
