// SPDX-License-Identifier: Apache-2.0
#include "client/interrupt.hpp"

#include <atomic>
#include <csignal>

namespace tessera::client {
namespace {

// A signal handler can reach nothing but a global.
std::atomic<bool> interrupt_seen{false};
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void note_interrupt(int) {
  interrupt_seen = true;
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

// A shell makes its background jobs ignore Ctrl-C, which is meant for the one in front; they go on ignoring
// it.
void watch(int signal) {
  if (std::signal(signal, note_interrupt) == SIG_IGN) std::signal(signal, SIG_IGN);
}

}  // namespace

void watch_for_interrupt() {
  watch(SIGINT);
  watch(SIGTERM);
}

void interrupt() {
  interrupt_seen = true;
}

bool interrupted() {
  return interrupt_seen;
}

}  // namespace tessera::client
