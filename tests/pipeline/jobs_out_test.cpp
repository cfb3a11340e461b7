#include "pipeline/jobs_out.hpp"

#include <gtest/gtest.h>

namespace povslam {
namespace {

TEST(JobsOut, HoldsAnAnswerUntilItIsDue) {
  SmoothProblem problem;
  const BackendJob job = &problem;
  JobsOut jobs(2);
  jobs.add(job, 13);
  EXPECT_EQ(jobs.take_due(20), std::nullopt) << "it was not answered";
  jobs.answer(job);
  EXPECT_EQ(jobs.take_due(12), std::nullopt);
  EXPECT_EQ(jobs.take_due(13), job);
  EXPECT_EQ(jobs.take_due(13), std::nullopt);
}

TEST(JobsOut, LetsALateAnswerInAtOnce) {
  SmoothProblem problem;
  const BackendJob job = &problem;
  JobsOut jobs(2);
  jobs.add(job, 13);
  jobs.answer(job);
  EXPECT_EQ(jobs.take_due(40), job);
}

TEST(JobsOut, KeepsTheOrderOfAskingWhicheverCameBackFirst) {
  SmoothProblem smooth;
  LoopProblem loop;
  const BackendJob first = &smooth, second = &loop;
  JobsOut jobs(2);
  jobs.add(first, 5);
  jobs.add(second, 5);
  jobs.answer(second);
  jobs.answer(first);
  EXPECT_EQ(jobs.take_due(5), first);
  EXPECT_EQ(jobs.take_due(5), second);
}

TEST(JobsOut, OneThatIsStillOutDoesNotKeepTheOthersWaiting) {
  SmoothProblem smooth;
  LoopProblem loop;
  const BackendJob first = &smooth, second = &loop;
  JobsOut jobs(2);
  jobs.add(first, 5);
  jobs.add(second, 6);
  jobs.answer(second);
  EXPECT_EQ(jobs.take_due(6), second);
  EXPECT_EQ(jobs.take_due(6), std::nullopt);
}

TEST(JobsOutDeathTest, RefusesAnAnswerNobodyAskedFor) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  SmoothProblem problem;
  JobsOut jobs(1);
  EXPECT_DEATH(jobs.answer(&problem), "");
}

}  // namespace
}  // namespace povslam
