// Which observation is which object: gate, registration, cost, one-to-one assignment (POCD's structure), then what
// one-to-one cannot say: several parts of one object, and one observation that covers several.
#pragma once

#include <span>
#include <vector>

#include "pipeline/objects/object.hpp"
#include "pipeline/objects/options.hpp"
#include "pipeline/objects/register.hpp"

namespace povslam {

struct Match {
  int object = -1;                // index into the objects given
  std::vector<int> observations;  // indices; the first is the one assigned, others are further parts
  std::vector<int> sides;         // further ones, within its box: sides of it that it does not know yet
  Registration registration;      // of the first
  bool known_surface = false;     // it lies on surface the object knows; else only beside it (another side)
  std::uint16_t owner = kNobody;  // of its pixels, after mark_owners()
};

struct Association {
  std::vector<Match> matches;
  std::vector<int> unclaimed;                    // observations of nothing known
  std::vector<std::uint16_t> unclaimed_owner;    // of their pixels, after mark_owners()
  std::vector<std::pair<int, int>> one_seen_as;  // objects that lay on one observation together, lower index first
};

// Most of its points lie within the object's box, or hardly beside it.
bool lies_within(const Observation& observation, const Box& box_world);

enum class Standing : std::uint8_t {
  whole,
  broken,  // seen through here and there: what lies beside its known surface is not taken for another side of it
  gone     // seen through more than not: whatever is there now is something else
};

// standing: of each object, as this view shows it.
Association associate(std::span<const Observation> observations, std::span<const MapObject* const> objects,
                      std::span<const Standing> standing, const AssociateOptions& options);

// Renames the owners of the view's pixels: each match and each unclaimed observation its own. Where objects share an
// observation, a pixel is of the one whose surface it lies nearest to.
void mark_owners(Association& association, std::span<const Observation> observations,
                 std::span<const MapObject* const> objects, DepthView& view);

}  // namespace povslam
