// SPDX-License-Identifier: Apache-2.0
// The thread pools that answer calls, by the kind of work. Thread-safe.
#pragma once

#include "server/base/fair_pool.hpp"
#include "server/base/thread_pool.hpp"

namespace tessera::rpc {

struct Pools {
  // Calls of workers that take milliseconds, above all heartbeats, and steps of streams.
  base::ThreadPool& quick;
  // Calls of users that take milliseconds. They are separate, so that a busy disk does not delay heartbeats.
  base::FairPool& users;
  // What watchers are sent: messages, and tiles, which take a millisecond each to encode.
  base::FairPool& watching;
  // Work that takes seconds: encoding images, reading films back.
  base::FairPool& slow;
  // Removal of files from a full store. It is separate, so that only uploads wait for it.
  base::FairPool& clearing;
};

}  // namespace tessera::rpc
