// Counts what a thread asks of the heap, the kernel's mappings and mutexes while counting is on: the proof that a hot
// path neither allocates nor locks. Linked into every test program, it stands in front of malloc and its kin,
// mmap and pthread_mutex_lock, so calls made inside libraries count too.
//   start_counting();  …hot path…  EXPECT_EQ(stop_counting().allocations, 0);
// To find a culprit: run with POVSLAM_TRAP_ALLOCATIONS=1 under gdb; the first counted call raises SIGTRAP.
#pragma once

#include <cstdint>

namespace povslam {

struct CallCounts {
  std::uint64_t allocations = 0;  // malloc, calloc, realloc, aligned_alloc, posix_memalign, memalign
  std::uint64_t maps = 0;         // mmap, mremap called by name (malloc's own are counted as allocations)
  std::uint64_t locks = 0;        // pthread_mutex_lock, pthread_rwlock_{rd,wr}lock, pthread_cond_wait
};

void start_counting();       // the calling thread, from zero
CallCounts stop_counting();  // the calling thread's calls since start_counting()

// False under sanitizers, whose own interposition must stay in place: skip the test then.
bool counting_works();

}  // namespace povslam
