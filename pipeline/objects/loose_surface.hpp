// Surfaces that are there though no object's volume takes them: things too far off or too little seen to be objects,
// things in doubt, borders of things. They belong to the map, and to nobody; what an object comes to know is forgotten
// here. Not stored: after a start they are seen again.
#pragma once

#include "pipeline/mapping/integrate.hpp"
#include "pipeline/mapping/mesh.hpp"
#include "pipeline/objects/library.hpp"

namespace povslam {

class LooseSurface {
 public:
  LooseSurface(const VolumeOptions& volume, const IntegrateOptions& integrate)
      : volume_(volume), integrate_options_(integrate) {}

  // The view that the library observed last, after everything else: its owners are written over.
  void observe(DepthView& view, const ObjectLibrary& library);
  void append_to(Mesh& mesh, const MeshOptions& options);

 private:
  void forget_known(const MapObject& object);

  Volume volume_;
  IntegrateOptions integrate_options_;
};

}  // namespace povslam
