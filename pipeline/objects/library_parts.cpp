// What becomes of an object of which a part is seen through while the rest is seen standing.
#include "pipeline/objects/library.hpp"
#include "pipeline/objects/part_change.hpp"
#include "pipeline/objects/state.hpp"

namespace povslam {
namespace {

// A thing that was shifted or turned shows where it is now, beside what should be left of it.
bool lies_in_the_rest(const Match& match, const Extraction& extraction, const MapObject& object,
                      const MissingPart& part) {
  constexpr double kGrow_m = 0.08, kEnough = 0.9;
  const Box rest = MapObject::moved(part.rest_box, object.T_world_volume);
  std::size_t points = 0, inside = 0;
  for (const int i : match.observations) {
    for (const Eigen::Vector3f& p : extraction.observations[static_cast<std::size_t>(i)].points_world) {
      ++points;
      inside += rest.contains(p.cast<double>(), kGrow_m) ? 1 : 0;
    }
  }
  return static_cast<double>(inside) >= kEnough * static_cast<double>(points);
}

}  // namespace

// The part is doubted as a thing of its own would be: it went when nothing but change explains what was seen.
void ObjectLibrary::doubt_part(const Match& match, MapObject& object, const Extraction& extraction,
                               const DepthView& view) {
  if (options_.life.part_min_m <= 0.0 || object.phase != ObjectPhase::confirmed) return;
  const auto looks = look_at_each(object.surface, view, object.T_world_volume, options_.life.margin_m);
  count_missed(object, looks);
  const auto part = find_missing_part(object, looks, options_.life.part_min_m, deepest_m(object));
  if (!part || !lies_in_the_rest(match, extraction, object, *part)) return;
  if (!object.part_belief) {
    object.part_belief = object.belief;
    object.part_first_absent = view.stamp;
  }
  Belief& belief = *object.part_belief;
  belief = observe_change(belief, options_.belief.max_change_m, class_of(object), options_.belief).belief;
  if (belief.expected_consistency() >= options_.belief.remove_below) return;

  MapObject gone(next_id_++, object.volume.options());
  gone.class_votes = object.class_votes;
  gone.belief = belief;
  gone.T_world_volume = object.T_world_volume;
  gone.volume = cut_out(object, *part);
  gone.box = part->box;
  gone.first_seen = object.first_seen;
  gone.last_seen = object.last_seen;
  gone.keyframe = object.keyframe;
  PlaceChange change = change_of(gone, view.stamp);
  change.probability = 1.0 - belief.expected_consistency();
  change.evidence.first_absent = object.part_first_absent;
  change.evidence.last_absent = view.stamp;
  desk_.gone(std::move(change));
  remember_place(gone);
  object.part_belief.reset();
  reshape(object);
}

}  // namespace povslam
