// Where one view tells things of one class apart that stand side by side.
#pragma once

#include <span>

#include "pipeline/objects/components.hpp"
#include "pipeline/objects/observation.hpp"

namespace povslam {

struct CellParts {        // of a view, in cells of 2 x 2 pixels
  const ImageU16& value;  // class, or instance of no class known; 0: none
  const ImageF& depth;    // m
  const ComponentFinder& finder;
  std::span<const Component> components;
  std::span<const std::uint16_t> owner;  // by component; kNobody: of no observation
  bool instances = false;                // what value is

  bool alike(std::uint16_t a, std::uint16_t b) const { return a == b || (instances && a != 0 && b != 0); }
};

// Neighbours of one class in a row of cells, hardly apart, neither behind the other, with no nearer thing before what
// is between them (it may hide that they are one), and along much of their height, get a fence each. separable: pixels
// of classes whose things stand side by side, by class. observations: with their points, owners kFirstInstance + index.
void find_fences(const CellParts& parts, const ImageU16& separable, const DepthView& view,
                 std::span<Observation> observations);

}  // namespace povslam
