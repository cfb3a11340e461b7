#include "pipeline/frontend/map_journal.hpp"

#include <gtest/gtest.h>

#include "pipeline/frontend/map_loader.hpp"
#include "pipeline/frontend/track.hpp"
#include "tests/pipeline/frontend/map_invariants.hpp"
#include "tests/pipeline/frontend/simulated_view.hpp"
#include "tests/pipeline/smoothing_beside.hpp"
#include "tests/support/map_content.hpp"

namespace povslam {
namespace {

// A drive whose map is written down as it grows.
class Session {
 public:
  explicit Session(const MapContent* map = nullptr, const FrontendOptions& options = small_frontend(),
                   const Rigid3& start = {})
      : view_(small_drive(3)), tracker_(view_.calibration(), options, start, map), smoothing_(tracker_) {
    if (map != nullptr) content = *map;
  }

  void drive(double from_s, double to_s) {
    for (double t = from_s; t < to_s; t += view_.period_s()) {
      T_world_camera = view_.T_world_camera(t);
      result = tracker_.track(view_.drive(t));
      if (result.state == TrackState::ok && first_found_s < 0.0) first_found_s = t;
      smoothing_.frame_done();
      write(tracker_.take_change());
    }
  }
  void finish() { write(tracker_.collect_change()); }
  double error_m() const { return (result.T_world_camera.translation - T_world_camera.translation).norm(); }
  Rigid3 true_start() const { return view_.T_world_camera(0.0); }
  const Map& map() const { return tracker_.map(); }
  PinholeCamera camera() const { return view_.calibration().camera; }

  MapContent content;
  int changes = 0;
  double first_found_s = -1.0;
  TrackResult result;
  Rigid3 T_world_camera;

 private:
  void write(MapChange* change) {
    if (change == nullptr) return;
    apply_change(content, *change);
    ++changes;
    tracker_.give_back(change);
  }

  SimulatedView view_;
  Tracker tracker_;
  SmoothingBeside<Tracker> smoothing_;
};

MapContent mapped_place() {
  static const MapContent content = [] {
    Session session(nullptr, small_frontend(), Session().true_start());
    session.drive(0.0, 12.0);
    session.finish();
    return session.content;
  }();
  return content;
}

Map loaded(const MapContent& content, const PinholeCamera& camera) {
  const FrontendOptions options = small_frontend();
  const FrameBuilder builder(camera, options);
  Map map(options.orb.num_features, options.map, builder.level_scales());
  MapLoader::load(content, camera, map);
  return map;
}

}  // namespace

TEST(MapJournal, WritesAMapThatComesBackAsItWas) {
  Session session(nullptr, small_frontend(), Session().true_start());
  session.drive(0.0, 12.0);
  session.finish();
  EXPECT_GT(session.changes, 3);
  const Map& map = session.map();
  const Map back = loaded(session.content, session.camera());
  ASSERT_EQ(broken_sightings(back), "");
  EXPECT_EQ(back.num_keyframes(), map.num_keyframes());
  EXPECT_EQ(back.num_landmarks(), map.num_landmarks());
  EXPECT_EQ(back.next_keyframe_id(), map.next_keyframe_id());
  EXPECT_EQ(back.next_landmark_id(), map.next_landmark_id());
  ASSERT_GT(map.num_keyframes(), 5);
  for (std::int32_t s = 0; s < map.keyframe_slots(); ++s) {
    const Keyframe& kf = map.keyframe(s);
    if (!kf.alive) continue;
    const std::int32_t slot = back.find_keyframe(kf.id);
    ASSERT_NE(slot, kNone);
    const Keyframe& other = back.keyframe(slot);
    EXPECT_LT((kf.T_world_camera.translation - other.T_world_camera.translation).norm(), 0.001);
    EXPECT_TRUE(std::ranges::equal(kf.descriptor, other.descriptor));
    for (std::size_t f = 0; f < kf.x.size(); ++f) {
      EXPECT_NEAR(kf.x[f], other.x[f], 1e-3F);
      EXPECT_EQ(kf.level[f], other.level[f]);
      EXPECT_EQ(kf.landmark[f] == kNone, other.landmark[f] == kNone);
      if (kf.landmark[f] == kNone || other.landmark[f] == kNone) continue;
      const Landmark &a = map.landmark(kf.landmark[f]), &b = back.landmark(other.landmark[f]);
      EXPECT_EQ(a.id, b.id);
      EXPECT_EQ(a.has_patch, b.has_patch);
      EXPECT_LT((a.p_world - b.p_world).norm(), 0.03);
    }
  }
}

TEST(MapJournal, SaysNothingWhereNothingChanged) {
  const MapContent content = mapped_place();
  const Map map = loaded(content, Session().camera());
  MapJournal journal(Session().camera(), small_frontend().map);
  journal.assume_written(map, content);
  EXPECT_EQ(journal.collect(map, {}), nullptr);
}

TEST(MapJournal, LeavesOutWhatWasRemoved) {
  const MapContent content = mapped_place();
  Map map = loaded(content, Session().camera());
  MapJournal journal(Session().camera(), small_frontend().map);
  journal.assume_written(map, content);
  const std::int64_t id = map.keyframe(2).id;
  const int landmarks = map.num_landmarks();
  map.remove_keyframe(2);
  MapChange* change = journal.collect(map, {});
  ASSERT_NE(change, nullptr);
  EXPECT_EQ(change->removed_keyframes, std::vector<std::int64_t>{id});
  EXPECT_EQ(static_cast<int>(change->removed_landmarks.size()), landmarks - map.num_landmarks());
  MapContent after = content;
  apply_change(after, *change);
  EXPECT_EQ(loaded(after, Session().camera()).num_landmarks(), map.num_landmarks());
}

TEST(MapJournal, RemovesWhatASessionCutShortLeftBehind) {
  MapContent content = mapped_place();
  LandmarkRow orphan = content.landmarks.front();
  orphan.landmark = content.meta.next_landmark++;
  content.landmarks.push_back(orphan);  // written, and no keyframe said yet that it sees it
  const Map map = loaded(content, Session().camera());
  MapJournal journal(Session().camera(), small_frontend().map);
  journal.assume_written(map, content);
  MapChange* change = journal.collect(map, {});
  ASSERT_NE(change, nullptr);
  EXPECT_EQ(change->removed_landmarks, std::vector<std::int64_t>{orphan.landmark});
  EXPECT_TRUE(change->landmarks.empty() && change->keyframes.empty());
}

TEST(MapLoader, BringsBackWhatFitsIntoASmallerMap) {
  const MapContent content = mapped_place();
  FrontendOptions options = small_frontend();
  options.map.max_keyframes = 5;
  options.map.max_landmarks = 300;
  options.orb.num_features = 300;
  Map map(options.orb.num_features, options.map, {1.0F, 1.2F});
  MapLoader::load(content, Session().camera(), map);
  EXPECT_EQ(map.num_keyframes(), 5);
  EXPECT_LE(map.num_landmarks(), 300);
  EXPECT_GT(map.num_landmarks(), 100);
  EXPECT_EQ(broken_sightings(map), "");
}

TEST(MapLoader, CarriesFeaturesOverToACameraOfOtherIntrinsics) {
  const MapContent content = mapped_place();
  const PinholeCamera camera = Session().camera();
  PinholeCamera other = camera;
  other.fx *= 2.0, other.cx += 7.0;
  const Map map = loaded(content, other);
  const Map same = loaded(content, camera);
  const Keyframe &a = same.keyframe(1), &b = map.keyframe(1);
  for (std::size_t f = 0; f < a.x.size(); ++f) {
    EXPECT_NEAR((a.x[f] - camera.cx) / camera.fx, (b.x[f] - other.cx) / other.fx, 1e-5);
    EXPECT_FLOAT_EQ(a.y[f], b.y[f]);
  }
}

TEST(Tracker, FindsItselfOnTheMapOfAnEarlierSession) {
  const MapContent content = mapped_place();
  Session second(&content);
  second.drive(4.0, 7.0);
  EXPECT_EQ(second.result.state, TrackState::ok);
  EXPECT_LT(second.error_m(), 0.03);
  EXPECT_GE(second.first_found_s, 4.0);
  EXPECT_LT(second.first_found_s, 5.5);
  EXPECT_GT(second.result.map_version, content.meta.map_version);
}

TEST(Tracker, BeginsAtADockItKnows) {
  const MapContent content = mapped_place();
  FrontendOptions options = small_frontend();
  options.map.start = "known";
  Session second(&content, options, Session().true_start());
  second.drive(0.0, 0.15);
  EXPECT_EQ(second.result.state, TrackState::degraded);  // trust is earned
  EXPECT_LT(second.error_m(), 0.03);
}

// The first columns of the image show what stood at the dock, the rest a place elsewhere on the map.
void begin_with_carried_columns(int columns, TrackState expected_at_last) {
  const MapContent content = mapped_place();
  FrontendOptions options = small_frontend();
  options.map.start = "known";
  SimulatedView view(small_drive(3));
  const Rigid3 dock = view.T_world_camera(0.0), elsewhere = view.T_world_camera(8.0);
  const RgbdFrame carried = view.look(dock);
  Tracker tracker(view.calibration(), options, dock, &content);
  TrackResult result;
  for (int i = 0; i < 30; ++i) {
    RgbdFrame image = view.look(elsewhere, i * view.period_s());
    for (int y = 0; y < image.color.height(); ++y) {
      std::copy_n(carried.color.row(y), std::ptrdiff_t{3} * columns, image.color.row(y));
      std::copy_n(carried.depth.row(y), columns, image.depth.row(y));
    }
    result = tracker.track(image);
    if (result.state == TrackState::lost) continue;
    EXPECT_LT((result.T_world_camera.translation - elsewhere.translation).norm(), 0.05) << i;
  }
  EXPECT_EQ(result.state, expected_at_last);
}

TEST(Tracker, BelievesNoDockWhenFarMoreSpeaksForAnotherPlace) {
  begin_with_carried_columns(60, TrackState::ok);
}

// Five frames speak for elsewhere by far, the sixth not quite.
TEST(Tracker, ReturnsToNoDockThatWasRefuted) {
  begin_with_carried_columns(110, TrackState::lost);
}

TEST(Tracker, LeavesTheMapAsItIsWhenItMayOnlyLocalise) {
  const MapContent content = mapped_place();
  FrontendOptions options = small_frontend();
  options.map.mode = "localise";
  Session second(&content, options);
  second.drive(4.0, 16.0);
  second.finish();
  EXPECT_EQ(second.changes, 0);
  EXPECT_EQ(second.map().next_keyframe_id(), content.meta.next_keyframe);
  EXPECT_GE(second.first_found_s, 4.0);
}

}  // namespace povslam
