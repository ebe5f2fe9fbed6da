#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# thread_safety.sh ROOT: shows that Clang rejects a member that is accessed without its mutex (core/base/mutex.hpp), as it
# does in the farm's sources wherever Clang compiles them: -Werror=thread-safety in cmake/TesseraOptions.cmake.
# Exit status 77 without Clang.
set -euo pipefail

root=${1:?usage: thread_safety.sh ROOT}
clang=$(command -v clang++-14 || command -v clang++) || {
  echo "skipped: there is no clang++ to check thread safety (scripts/setup.sh test installs it)"
  exit 77
}

# compiles NAME BODY: whether Clang accepts a class with this member function.
compiles() {
  "$clang" -std=c++20 -I "$root" -fsyntax-only -Wthread-safety -Werror=thread-safety -x c++ - 2>/dev/null <<EOF
#include <condition_variable>

#include "core/base/mutex.hpp"

using tessera::core::MutexLock;

class Example {
 public:
  void call() { $1 }

 private:
  void increment() TESSERA_REQUIRES(mutex_) { ++count_; }
  tessera::core::Mutex mutex_;
  std::condition_variable changed_;
  int count_ TESSERA_GUARDED_BY(mutex_) = 0;
};

int main() { Example().call(); }
EOF
}

failures=0
accepts() { compiles "$1" || { echo "Clang rejects '$1', which is right"; failures=1; }; }
rejects() { ! compiles "$1" || { echo "Clang accepts '$1', which is wrong"; failures=1; }; }

accepts 'const MutexLock lock(mutex_); increment(); ++count_;'
accepts 'MutexLock lock(mutex_); lock.unlock(); lock.lock(); ++count_;'
accepts 'MutexLock lock(mutex_); changed_.wait(lock.native(), [this]() TESSERA_REQUIRES(mutex_) { return count_ > 0; });'
rejects '++count_;'
rejects 'increment();'
rejects '{ const MutexLock lock(mutex_); } ++count_;'
rejects 'MutexLock lock(mutex_); lock.unlock(); ++count_;'
rejects 'MutexLock lock(mutex_); const MutexLock again(mutex_);'
exit "$failures"
