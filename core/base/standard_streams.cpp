// SPDX-License-Identifier: Apache-2.0
#include "core/base/standard_streams.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <csignal>

namespace tessera::core {
namespace {

void open_if_closed(int descriptor, int mode) {
  if (::fcntl(descriptor, F_GETFD) != -1) return;
  // This is the lowest free descriptor, because all lower ones are open.
  const int opened = ::open("/dev/null", mode);
  if (opened >= 0 && opened != descriptor) ::close(opened);
}

}  // namespace

void prepare_standard_streams() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  open_if_closed(STDIN_FILENO, O_RDONLY);
  open_if_closed(STDOUT_FILENO, O_RDONLY);
  open_if_closed(STDERR_FILENO, O_WRONLY);
}

bool reader_is_gone(int descriptor) {
  pollfd state{.fd = descriptor, .events = POLLOUT, .revents = 0};
  return ::poll(&state, 1, 0) == 1 && (state.revents & (POLLERR | POLLHUP)) != 0;
}

}  // namespace tessera::core
