// SPDX-License-Identifier: Apache-2.0
// The thread pools that answer calls, by the kind of work. Thread-safe.
#pragma once

#include "server/base/fair_pool.hpp"
#include "server/base/thread_pool.hpp"

namespace tessera::rpc {

// Each kind waits for itself alone: a disk that hangs stops those that use it.
struct Pools {
  // Heartbeats, which use no disk. Nothing else, since workers whose heartbeats wait are taken for lost.
  base::ThreadPool& heartbeats;
  // Results of workers, which take milliseconds to decompress and use no disk.
  base::ThreadPool& results;
  // Chunks of uploaded files, until these are synced to disk.
  base::ThreadPool& receiving;
  // Chunks of files that are read from disk and sent: scenes to workers, images to users.
  base::ThreadPool& sending;
  // Calls of users that take milliseconds, with the disk that lists and finished jobs are read from.
  base::FairPool& users;
  // What watchers are sent: messages, and tiles, which take a millisecond each to encode.
  base::FairPool& watching;
  // Work that takes seconds: encoding images, reading films back.
  base::FairPool& slow;
  // Removal of files from a full store. It is separate, so that only uploads wait for it.
  base::FairPool& clearing;
};

}  // namespace tessera::rpc
