// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/client/process.hpp"

#include <fcntl.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>

namespace tessera::client {
namespace {

[[noreturn]] void become_tessera(const std::vector<std::string>& arguments) {
  std::vector<char*> argv{const_cast<char*>(TESSERA_BINARY)};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  std::signal(SIGINT, SIG_DFL);  // which a test in the background of a shell ignores
  ::execv(TESSERA_BINARY, argv.data());
  ::_exit(127);
}

int exit_status_of(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string contents(std::FILE* file) {
  std::string text;
  std::rewind(file);
  for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) text.push_back(static_cast<char>(c));
  std::fclose(file);
  return text;
}

}  // namespace

ProcessResult run_tessera(const std::vector<std::string>& arguments) {
  return run_tessera_after([] {}, arguments);
}

ProcessResult run_tessera_after(const std::function<void()>& prepare,
                                const std::vector<std::string>& arguments) {
  std::FILE *out = std::tmpfile(), *err = std::tmpfile();
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(::fileno(out), STDOUT_FILENO);
    ::dup2(::fileno(err), STDERR_FILENO);
    prepare();
    become_tessera(arguments);
  }
  const int status = exit_status_of(child);
  return {status, contents(out), contents(err)};
}

ProcessResult run_on_terminal_and_signal(const std::vector<std::string>& arguments, const std::string& text,
                                         int signal) {
  int terminal = -1;
  const pid_t child = ::forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) become_tessera(arguments);
  ProcessResult result;
  bool sent = false;
  char buffer[4096];
  // Reading fails when the child has ended and with it the terminal.
  for (ssize_t count = 0; (count = ::read(terminal, buffer, sizeof buffer)) > 0;) {
    result.err.append(buffer, static_cast<std::size_t>(count));
    if (!sent && result.err.find(text) != std::string::npos) sent = ::kill(child, signal) == 0;
  }
  ::close(terminal);
  result.exit_status = exit_status_of(child);
  return result;
}

ProcessResult run_tessera_and_use(const std::vector<std::string>& arguments, const std::string& text,
                                  const std::function<void(const std::string& err)>& use, int signal) {
  std::FILE* out = std::tmpfile();
  int err[2] = {-1, -1};
  if (::pipe2(err, O_CLOEXEC) != 0) return {};
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(::fileno(out), STDOUT_FILENO);
    ::dup2(err[1], STDERR_FILENO);
    ::unsetenv("DISPLAY");
    ::unsetenv("WAYLAND_DISPLAY");
    become_tessera(arguments);
  }
  ::close(err[1]);
  ProcessResult result;
  bool sent = false;
  char buffer[4096];
  for (ssize_t count = 0; (count = ::read(err[0], buffer, sizeof buffer)) > 0;) {
    result.err.append(buffer, static_cast<std::size_t>(count));
    if (sent || result.err.find(text) == std::string::npos) continue;
    use(result.err);
    sent = ::kill(child, signal) == 0;
  }
  ::close(err[0]);
  result.exit_status = exit_status_of(child);
  result.out = contents(out);
  return result;
}

ProcessResult run_tessera_and_signal(const std::vector<std::string>& arguments,
                                     const std::function<bool()>& condition, int signal) {
  std::FILE *out = std::tmpfile(), *err = std::tmpfile();
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(::fileno(out), STDOUT_FILENO);
    ::dup2(::fileno(err), STDERR_FILENO);
    become_tessera(arguments);
  }
  const auto has_ended = [child] {
    siginfo_t info{};
    return ::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
           info.si_pid != 0;
  };
  while (!condition() && !has_ended()) ::usleep(1000);
  if (!has_ended()) ::kill(child, signal);
  const int status = exit_status_of(child);
  return {status, contents(out), contents(err)};
}

}  // namespace tessera::client
