// SPDX-License-Identifier: Apache-2.0
// For the preset tsan: shows ThreadSanitizer how gRPC, which Debian does not build with it, hands work from
// thread to thread. So what callbacks and other threads share is checked, and no report need be suppressed.
// Preloaded.
//
// gRPC 1.51 does so by Abseil's mutexes and by queues of its own. Each function here stands before the
// library's of the same name and calls it: who unlocks or pushes releases all that it has written, who locks
// or pops acquires it.
#include <dlfcn.h>
#include <sanitizer/tsan_interface.h>

#include <cstdint>

// Not there in processes without the sanitizer, such as ctest.
#pragma weak __tsan_acquire
#pragma weak __tsan_release

namespace {

void acquire(void* object) {
  if (__tsan_acquire != nullptr) __tsan_acquire(object);
}

void release(void* object) {
  if (__tsan_release != nullptr) __tsan_release(object);
}

// The function of this name that comes after this library's.
template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

// absl::Duration and absl::Time, as far as passing them on goes.
struct AbseilTime {
  std::int64_t high;
  std::uint32_t low;
};

// What grpc::internal::ServerCallbackCall begins with. Most of its counting is inlined, and so seen.
struct CallCounts {
  void* virtual_functions;
  int until_cancelled[1], until_done[1];
};

}  // namespace

// The names as they are in the libraries: "debian3" is the namespace of the ABI of Debian 12's Abseil.
#define MUTEX "_ZN4absl7debian35Mutex"
#define CONDITION "_ZN4absl7debian37CondVar"
#define CALL "_ZN4grpc8internal18ServerCallbackCall"
#define QUEUE "_ZN9grpc_core32MultiProducerSingleConsumerQueue"

extern "C" {

void mutex_lock(void* mutex) __asm__(MUTEX "4LockEv");
void mutex_unlock(void* mutex) __asm__(MUTEX "6UnlockEv");
bool mutex_try_lock(void* mutex) __asm__(MUTEX "7TryLockEv");
void mutex_lock_release(void** lock) __asm__("_ZN4absl7debian319ReleasableMutexLock7ReleaseEv");
void condition_wait(void* condition, void* mutex) __asm__(CONDITION "4WaitEPNS0_5MutexE");
bool condition_wait_for(void* condition, void* mutex,
                        AbseilTime time) __asm__(CONDITION "15WaitWithTimeoutEPNS0_5MutexENS0_8DurationE");
bool condition_wait_until(void* condition, void* mutex,
                          AbseilTime time) __asm__(CONDITION "16WaitWithDeadlineEPNS0_5MutexENS0_4TimeE");
bool queue_push(void* queue, void* node) __asm__(QUEUE "4PushEPNS0_4NodeE");
void* queue_pop(void* queue) __asm__(QUEUE "3PopEv");
void* queue_pop_and_check_end(void* queue, bool* is_empty) __asm__(QUEUE "14PopAndCheckEndEPb");
void call_on_cancel(void* call, void* reactor) __asm__(CALL "12CallOnCancelEPNS0_13ServerReactorE");
void call_schedule_on_done(void* call, bool at_once) __asm__(CALL "14ScheduleOnDoneEb");

void mutex_lock(void* mutex) {
  static auto* const lock = next<void(void*)>(MUTEX "4LockEv");
  lock(mutex);
  acquire(mutex);
}

void mutex_unlock(void* mutex) {
  static auto* const unlock = next<void(void*)>(MUTEX "6UnlockEv");
  release(mutex);
  unlock(mutex);
}

bool mutex_try_lock(void* mutex) {
  static auto* const try_lock = next<bool(void*)>(MUTEX "7TryLockEv");
  const bool locked = try_lock(mutex);
  if (locked) acquire(mutex);
  return locked;
}

// The mutex is the lock's first member.
void mutex_lock_release(void** lock) {
  static auto* const unlock = next<void(void**)>("_ZN4absl7debian319ReleasableMutexLock7ReleaseEv");
  release(*lock);
  unlock(lock);
}

void condition_wait(void* condition, void* mutex) {
  static auto* const wait = next<void(void*, void*)>(CONDITION "4WaitEPNS0_5MutexE");
  release(mutex);
  wait(condition, mutex);
  acquire(mutex);
}

bool condition_wait_for(void* condition, void* mutex, AbseilTime time) {
  static auto* const wait =
      next<bool(void*, void*, AbseilTime)>(CONDITION "15WaitWithTimeoutEPNS0_5MutexENS0_8DurationE");
  release(mutex);
  const bool timed_out = wait(condition, mutex, time);
  acquire(mutex);
  return timed_out;
}

bool condition_wait_until(void* condition, void* mutex, AbseilTime time) {
  static auto* const wait =
      next<bool(void*, void*, AbseilTime)>(CONDITION "16WaitWithDeadlineEPNS0_5MutexENS0_4TimeE");
  release(mutex);
  const bool timed_out = wait(condition, mutex, time);
  acquire(mutex);
  return timed_out;
}

bool queue_push(void* queue, void* node) {
  static auto* const push = next<bool(void*, void*)>(QUEUE "4PushEPNS0_4NodeE");
  release(queue);
  return push(queue, node);
}

void* queue_pop(void* queue) {
  static auto* const pop = next<void*(void*)>(QUEUE "3PopEv");
  void* const node = pop(queue);
  acquire(queue);
  return node;
}

void* queue_pop_and_check_end(void* queue, bool* is_empty) {
  static auto* const pop = next<void*(void*, bool*)>(QUEUE "14PopAndCheckEndEPb");
  void* const node = pop(queue, is_empty);
  acquire(queue);
  return node;
}

void call_on_cancel(void* call, void* reactor) {
  static auto* const on_cancel = next<void(void*, void*)>(CALL "12CallOnCancelEPNS0_13ServerReactorE");
  acquire(static_cast<CallCounts*>(call)->until_cancelled);
  on_cancel(call, reactor);
}

void call_schedule_on_done(void* call, bool at_once) {
  static auto* const schedule = next<void(void*, bool)>(CALL "14ScheduleOnDoneEb");
  acquire(static_cast<CallCounts*>(call)->until_done);
  schedule(call, at_once);
}

}  // extern "C"
