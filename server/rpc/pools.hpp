// SPDX-License-Identifier: Apache-2.0
// The thread pools that answer calls, by the kind of work. Thread-safe.
#pragma once

#include "server/coordinator/fair_pool.hpp"
#include "server/coordinator/thread_pool.hpp"

namespace tessera::rpc {

struct Pools {
  // Calls of workers that take milliseconds, above all heartbeats, and steps of streams.
  coordinator::ThreadPool& quick;
  // Calls of users that take milliseconds. They are separate, so that a busy disk does not delay heartbeats.
  coordinator::FairPool& users;
  // Work that takes seconds: encoding images, reading films back.
  coordinator::FairPool& slow;
  // Validation of scenes, which can take minutes. It is separate, so that images do not wait for it.
  coordinator::FairPool& validating;
  // Removal of files from a full store. It is separate, so that only uploads wait for it.
  coordinator::FairPool& clearing;
};

}  // namespace tessera::rpc
