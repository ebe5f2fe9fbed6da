// SPDX-License-Identifier: Apache-2.0
// The threads that calls are answered by, and what each kind is for. Thread-safe.
#pragma once

#include "server/coordinator/fair_pool.hpp"
#include "server/coordinator/thread_pool.hpp"

namespace tessera::rpc {

struct Pools {
  // For what takes milliseconds: calls of workers, above all heartbeats, and steps of streams.
  coordinator::ThreadPool& quick;
  // For calls of users that take milliseconds. A disk that is busy with them holds up no heartbeat.
  coordinator::FairPool& users;
  // For what takes seconds: encoding pictures, reading films back.
  coordinator::FairPool& slow;
  // For validating scenes, which can take minutes: no picture is to wait for that.
  coordinator::FairPool& validating;
  // For removing files from a full store: whoever uploads waits for that, and nobody else.
  coordinator::FairPool& clearing;
};

}  // namespace tessera::rpc
