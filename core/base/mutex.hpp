// SPDX-License-Identifier: Apache-2.0
// A mutex whose use Clang checks at compile time (-Wthread-safety): members that are TESSERA_GUARDED_BY it
// are accessed, and functions that TESSERA_REQUIRES it are called, only where it is held. Other compilers
// ignore the annotations.
//
// Clang does not see that a predicate of a condition variable holds the mutex: the predicate requires it.
//   changed_.wait(lock.native(), [this]() TESSERA_REQUIRES(mutex_) { return stopping_; });
// It does not check constructors and destructors.
#pragma once

#include <mutex>

#ifdef __clang__
#define TESSERA_THREAD_ANNOTATION(annotation) __attribute__((annotation))
#else
#define TESSERA_THREAD_ANNOTATION(annotation)
#endif

// A member that is accessed only while the mutex is held.
#define TESSERA_GUARDED_BY(mutex) TESSERA_THREAD_ANNOTATION(guarded_by(mutex))
// A function whose caller holds the mutex.
#define TESSERA_REQUIRES(...) TESSERA_THREAD_ANNOTATION(requires_capability(__VA_ARGS__))
// A function that locks or unlocks the mutex, or by default its own object.
#define TESSERA_ACQUIRE(...) TESSERA_THREAD_ANNOTATION(acquire_capability(__VA_ARGS__))
#define TESSERA_RELEASE(...) TESSERA_THREAD_ANNOTATION(release_capability(__VA_ARGS__))
// A function that returns this mutex.
#define TESSERA_RETURNS(mutex) TESSERA_THREAD_ANNOTATION(lock_returned(mutex))

namespace tessera::core {

class TESSERA_THREAD_ANNOTATION(capability("mutex")) Mutex {
 public:
  void lock() TESSERA_ACQUIRE() { mutex_.lock(); }
  void unlock() TESSERA_RELEASE() { mutex_.unlock(); }

 private:
  friend class MutexLock;
  std::mutex mutex_;
};

// Holds a mutex until the end of a scope.
class TESSERA_THREAD_ANNOTATION(scoped_lockable) MutexLock {
 public:
  explicit MutexLock(Mutex& mutex) TESSERA_ACQUIRE(mutex) : lock_(mutex.mutex_) {}
  ~MutexLock() TESSERA_RELEASE() {}
  MutexLock(const MutexLock&) = delete;
  MutexLock& operator=(const MutexLock&) = delete;

  // Releases the mutex before the end of the scope, and takes it again.
  void unlock() TESSERA_RELEASE() { lock_.unlock(); }
  void lock() TESSERA_ACQUIRE() { lock_.lock(); }
  // For condition variables.
  std::unique_lock<std::mutex>& native() { return lock_; }

 private:
  std::unique_lock<std::mutex> lock_;
};

}  // namespace tessera::core
