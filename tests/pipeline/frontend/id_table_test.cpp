#include "pipeline/frontend/id_table.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>

namespace povslam {
namespace {

RC_GTEST_PROP(IdTable, SaysWhatAMapSaysWhateverComesAndGoes, ()) {
  IdTable table(24);
  std::map<std::int64_t, std::int32_t> truth;
  std::int64_t next = 0;
  for (int step = 0; step < 400; ++step) {
    next += *rc::gen::inRange(1, 4);
    if (truth.size() < 24 && *rc::gen::inRange(0, 3) > 0) {
      truth[next] = step;
      table.insert(next, step);
    } else if (!truth.empty()) {
      const auto gone = std::next(truth.begin(), *rc::gen::inRange(0, static_cast<int>(truth.size())));
      table.erase(gone->first);
      truth.erase(gone);
    }
    for (const auto& [id, slot] : truth) RC_ASSERT(table.find(id) == slot);
    RC_ASSERT(table.find(next + 1) == -1);
    RC_ASSERT(table.find(-1) == -1);
  }
}

TEST(IdTable, FindsAnOldIdAmongManyNewOnes) {
  IdTable table(8);
  table.insert(3, 7);
  for (std::int64_t id = 4; id < 300000; ++id) {
    table.insert(id, 1);
    table.erase(id);
  }
  EXPECT_EQ(table.find(3), 7);
}

}  // namespace
}  // namespace povslam
