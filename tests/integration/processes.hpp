// SPDX-License-Identifier: Apache-2.0
// Child processes and folders of a test. All of them are ended or removed with the test. Not thread-safe.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tessera::test {

using Timeout = std::chrono::milliseconds;

// Polls until `condition` holds. False after the timeout.
bool poll_until(Timeout timeout, const std::function<bool()>& condition);

std::string read_file(const std::filesystem::path& path);
void write_file(const std::filesystem::path& path, const std::string& text);

class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

struct ProcessOptions {
  std::vector<std::string> arguments;                // the first is the program
  std::filesystem::path out{}, err{};                // files for its stdout and stderr
  std::filesystem::path folder = ".";                // its working directory
  std::map<std::string, std::string> environment{};  // in addition to this process's
  pid_t network_of = 0;                // the process whose network namespace it enters; 0: this one
  std::filesystem::path hosts_file{};  // what it sees as /etc/hosts; empty: this machine's
};

// The exit status of a process, or 128 + the signal that killed it.
using ExitCode = int;

class Process {
 public:
  // Aborts the test program if the process cannot be started.
  explicit Process(ProcessOptions options);
  // The reason if processes cannot have a hosts file of their own here.
  static std::optional<std::string> cannot_replace_hosts(const std::filesystem::path& hosts_file);
  // Kills the process if it is running, and waits for it.
  ~Process();
  Process(Process&& other) noexcept;
  Process(const Process&) = delete;
  Process& operator=(Process&&) = delete;

  pid_t pid() const { return pid_; }
  void signal(int number) const;
  // Empty if it has not ended within the timeout.
  std::optional<ExitCode> wait(Timeout timeout);
  // Blocks until the program handles this signal. False after the timeout.
  bool wait_until_catches(int number, Timeout timeout) const;

  std::string out() const { return read_file(options_.out); }
  std::string err() const { return read_file(options_.err); }
  const std::string& program() const { return options_.arguments.front(); }

 private:
  ProcessOptions options_;
  pid_t pid_ = -1;
  std::optional<ExitCode> ended_;
};

}  // namespace tessera::test
