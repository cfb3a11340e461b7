#include "tests/support/alloc_counter.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <Eigen/Core>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <thread>
#include <vector>

namespace povslam {
namespace {

struct alignas(128) Wide {
  char bytes[128];
};

class AllocCounter : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!counting_works()) GTEST_SKIP() << "sanitizers interpose the heap themselves";
  }
};

TEST_F(AllocCounter, CountsNothingWhenNothingIsAsked) {
  std::atomic<int> sum{0};
  start_counting();
  for (int i = 0; i < 100; ++i) sum += i;
  const CallCounts counts = stop_counting();
  EXPECT_EQ(counts.allocations, 0u);
  EXPECT_EQ(counts.maps, 0u);
  EXPECT_EQ(counts.locks, 0u);
}

TEST_F(AllocCounter, SeesEveryWayToTheHeap) {
  const auto count_of = [](auto&& work) {
    start_counting();
    work();
    return stop_counting().allocations;
  };
  void* kept = nullptr;
  EXPECT_EQ(count_of([&] { kept = std::malloc(10); }), 1u);
  EXPECT_EQ(count_of([&] { kept = std::realloc(kept, 100000); }), 1u);
  std::free(kept);
  EXPECT_EQ(count_of([&] { kept = std::calloc(3, 7); }), 1u);
  std::free(kept);
  EXPECT_EQ(count_of([&] { EXPECT_EQ(posix_memalign(&kept, 64, 640), 0); }), 1u);
  std::free(kept);
  EXPECT_EQ(count_of([&] { kept = std::aligned_alloc(64, 640); }), 1u);
  std::free(kept);
  std::unique_ptr<Wide> wide;
  EXPECT_EQ(count_of([&] { wide = std::make_unique<Wide>(); }), 1u);
  std::vector<int> numbers;
  EXPECT_EQ(count_of([&] { numbers.resize(1000); }), 1u);
  std::string text;
  EXPECT_EQ(count_of([&] { text = std::string(500, 'x'); }), 1u);  // inside libstdc++
  Eigen::MatrixXd matrix;
  EXPECT_EQ(count_of([&] { matrix.resize(20, 20); }), 1u);
}

TEST_F(AllocCounter, SeesMappingsAndMutexes) {
  std::mutex mutex;
  start_counting();
  void* page = mmap(nullptr, 4096, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  { const std::lock_guard lock(mutex); }
  const CallCounts counts = stop_counting();
  ASSERT_NE(page, MAP_FAILED);
  munmap(page, 4096);
  EXPECT_EQ(counts.maps, 1u);
  EXPECT_EQ(counts.locks, 1u);
}

TEST_F(AllocCounter, LeavesOtherThreadsOut) {
  std::atomic<bool> go{false}, done{false};
  std::thread other([&] {
    go.wait(false);
    std::free(std::malloc(1000));
    done = true;
    done.notify_one();
  });
  start_counting();
  go = true;
  go.notify_one();
  done.wait(false);
  EXPECT_EQ(stop_counting().allocations, 0u);
  other.join();
}

}  // namespace
}  // namespace povslam
