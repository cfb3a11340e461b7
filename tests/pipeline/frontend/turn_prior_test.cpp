#include "pipeline/frontend/turn_prior.hpp"

#include <gtest/gtest.h>

#include "pipeline/geometry/rigid.hpp"
#include "tests/pipeline/frontend/simulated_view.hpp"

namespace povslam {
namespace {

struct Looker {
  explicit Looker(const SensorCalibration& calibration)
      : prior(calibration.camera),
        extractor(calibration.camera.width, calibration.camera.height, {.num_features = 10}),
        features(10),
        grey(calibration.camera.width, calibration.camera.height) {}
  void look(const RgbdFrame& frame) {
    rgb_to_grey(frame.color.data(), grey.data(), static_cast<std::int64_t>(grey.size()));
    extractor.extract(grey.data(), static_cast<std::int64_t>(grey.stride()), features);
    prior.look(extractor);
  }
  TurnPrior prior;
  OrbExtractor extractor;
  OrbFeatures features;
  ImageU8 grey;
};

double angle_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return so3_log(a.conjugate() * b).norm();
}

}  // namespace

TEST(TurnPrior, RecoversATurnOfFiveDegreesAboutAnyAxis) {
  constexpr double kFiveDegrees = 5.0 * 3.14159265 / 180.0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SimulatedView view(small_drive(seed));
    Looker looker(view.calibration());
    for (const Eigen::Vector3d& axis :
         {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0, 1)}) {
      const Rigid3 before = view.T_world_camera(5.0);
      const Rigid3 T_before_now{so3_exp(kFiveDegrees * axis), Eigen::Vector3d::Zero()};
      looker.look(view.look(before));
      looker.look(view.look(before * T_before_now));
      const TurnPrior::Turn turn = looker.prior.estimate(Eigen::Quaterniond::Identity());
      EXPECT_GT(turn.agreement, 0.9) << seed << ": " << axis.transpose();
      EXPECT_LT(angle_between(turn.R_now_before, T_before_now.rotation.conjugate()), 0.1 * kFiveDegrees)
          << seed << ": " << axis.transpose();
    }
  }
}

TEST(TurnPrior, StaysWhereNothingTurned) {
  SimulatedView view(small_drive(1));
  Looker looker(view.calibration());
  looker.look(view.drive(3.0));
  looker.look(view.drive(3.0));
  const TurnPrior::Turn turn = looker.prior.estimate(so3_exp({0.0, 0.03, 0.0}));  // from a wrong start
  EXPECT_GT(turn.agreement, 0.99);
  EXPECT_LT(so3_log(turn.R_now_before).norm(), 1e-3);
}

TEST(TurnPrior, DoesNotAgreeOnImagesOfDifferentPlaces) {
  int believed = 0, compared = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SimulatedView here(small_drive(seed)), there(small_drive(seed + 10));
    Looker looker(here.calibration());
    for (double time_s = 2.0; time_s < 50.0; time_s += 6.0) {
      looker.look(here.drive(time_s));
      looker.look(there.drive(time_s + 8.0));
      ++compared;
      if (looker.prior.estimate(Eigen::Quaterniond::Identity()).agreement > 0.5) ++believed;
    }
  }
  EXPECT_LE(believed, compared / 4) << "of " << compared;
}

TEST(TurnPrior, ClaimsNothingOfBlackImages) {
  SimulatedView view(small_drive(1));
  Looker looker(view.calibration());
  looker.look(view.drive(3.0));
  looker.look(view.black(3.1));
  TurnPrior::Turn turn = looker.prior.estimate(Eigen::Quaterniond::Identity());
  EXPECT_LT(turn.agreement, 0.5);
  looker.look(view.black(3.2));
  turn = looker.prior.estimate(Eigen::Quaterniond::Identity());
  EXPECT_LT(turn.agreement, 0.5);
  EXPECT_TRUE(turn.R_now_before.coeffs().allFinite());
}

}  // namespace povslam
