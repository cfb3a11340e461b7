#include "tests/support/alloc_counter.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdlib>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define POVSLAM_INTERPOSE 0
#else
#define POVSLAM_INTERPOSE 1
#endif

namespace povslam {
namespace {

struct Counter {
  bool on = false;
  CallCounts counts;
};
constinit thread_local Counter counter;

#if POVSLAM_INTERPOSE
void count(std::uint64_t CallCounts::*what) {
  if (!counter.on) return;
  ++(counter.counts.*what);
  if (std::getenv("POVSLAM_TRAP_ALLOCATIONS") != nullptr) std::raise(SIGTRAP);
}
#endif

}  // namespace

void start_counting() {
  counter = {true, {}};
}

CallCounts stop_counting() {
  counter.on = false;
  return counter.counts;
}

bool counting_works() {
  return POVSLAM_INTERPOSE == 1;
}

}  // namespace povslam

#if POVSLAM_INTERPOSE

using povslam::CallCounts;
using povslam::count;

extern "C" {

void* __libc_malloc(std::size_t size);                           // NOLINT: glibc's own names for the real functions
void* __libc_calloc(std::size_t number, std::size_t size);       // NOLINT
void* __libc_realloc(void* memory, std::size_t size);            // NOLINT
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT

void* malloc(std::size_t size) noexcept {
  count(&CallCounts::allocations);
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) noexcept {
  count(&CallCounts::allocations);
  return __libc_calloc(number, size);
}
void* realloc(void* memory, std::size_t size) noexcept {
  count(&CallCounts::allocations);
  return __libc_realloc(memory, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  count(&CallCounts::allocations);
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  count(&CallCounts::allocations);
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  count(&CallCounts::allocations);
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}

void* mmap(void* address, std::size_t length, int protection, int flags, int fd, off_t offset) noexcept {
  count(&CallCounts::maps);
  return reinterpret_cast<void*>(syscall(SYS_mmap, address, length, protection, flags, fd, offset));  // NOLINT
}
void* mremap(void* address, std::size_t old_length, std::size_t new_length, int flags, ...) noexcept {
  count(&CallCounts::maps);
  va_list rest;
  va_start(rest, flags);
  void* wanted = (flags & MREMAP_FIXED) != 0 ? va_arg(rest, void*) : nullptr;
  va_end(rest);
  return reinterpret_cast<void*>(syscall(SYS_mremap, address, old_length, new_length, flags, wanted));  // NOLINT
}

}  // extern "C"

namespace {

// The real function behind `name`, looked up at the first call (mutexes are locked before main).
template <class Function>
Function* next_function(std::atomic<Function*>& known, const char* name) {
  Function* function = known.load(std::memory_order_relaxed);
  if (function == nullptr) {
    function = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
    known.store(function, std::memory_order_relaxed);
  }
  return function;
}

constinit std::atomic<int (*)(pthread_mutex_t*)> real_mutex_lock{nullptr};
constinit std::atomic<int (*)(pthread_rwlock_t*)> real_rdlock{nullptr};
constinit std::atomic<int (*)(pthread_rwlock_t*)> real_wrlock{nullptr};
constinit std::atomic<int (*)(pthread_cond_t*, pthread_mutex_t*)> real_cond_wait{nullptr};

}  // namespace

extern "C" {

int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept {
  count(&CallCounts::locks);
  return next_function(real_mutex_lock, "pthread_mutex_lock")(mutex);
}
int pthread_rwlock_rdlock(pthread_rwlock_t* lock) noexcept {
  count(&CallCounts::locks);
  return next_function(real_rdlock, "pthread_rwlock_rdlock")(lock);
}
int pthread_rwlock_wrlock(pthread_rwlock_t* lock) noexcept {
  count(&CallCounts::locks);
  return next_function(real_wrlock, "pthread_rwlock_wrlock")(lock);
}
int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* mutex) {
  count(&CallCounts::locks);
  return next_function(real_cond_wait, "pthread_cond_wait")(condition, mutex);
}

}  // extern "C"

#endif
