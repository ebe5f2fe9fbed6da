// SPDX-License-Identifier: Apache-2.0
// Confines itself as programs do that read scenes, and then tries what one would try that was taken over. Its
// input is the path of a file that it should not reach. It prints a line for each attempt: what, and the
// error; then the content of file 0, which it asks its parent for.
#include <fcntl.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <iostream>
#include <string>

#include "core/sandbox/bundle_files.hpp"
#include "core/sandbox/options.hpp"

namespace {

using namespace tessera;

void attempt(const char* what, long result) {
  std::cout << what << ": " << (result < 0 ? std::strerror(errno) : "succeeds") << '\n';
}

std::string input() {
  std::string text(4096, '\0');
  const ssize_t size = read(STDIN_FILENO, text.data(), text.size());
  text.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  sandbox::Options options;
  CLI::App app("Try the sandbox");
  sandbox::add_flags(app, options, {.memory_mib = "--mib", .cpu_seconds = "--seconds"});
  app.allow_extras();
  CLI11_PARSE(app, argc, argv);
  if (const auto ended = sandbox::confine_or_end(options, "sandbox_probe")) return *ended;
  const std::string secret = input();
  attempt("read the secret", open(secret.c_str(), O_RDONLY));
  attempt("remove the secret", unlink(secret.c_str()));
  attempt("connect", socket(AF_INET, SOCK_STREAM, 0));
  attempt("talk to local services", socket(AF_UNIX, SOCK_STREAM, 0));
  attempt("signal the parent", kill(getppid(), 0));
  attempt("read the parent's memory",
          open(("/proc/" + std::to_string(getppid()) + "/mem").c_str(), O_RDONLY));
  attempt("start a program", execl("/bin/true", "true", nullptr));
  const auto file = sandbox::bundle_files({"file"}).read("file");
  std::cout << "file: " << (file ? *file : file.error().message) << '\n';
  return std::cout.flush() ? 0 : 1;
}
