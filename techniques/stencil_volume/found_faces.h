#pragma once
#include <gnomon/kit/volumes/volume_faces.h>

#include "gpu_finder.h"

namespace stencil_volume {

/// What was found of the faces of some casters.
struct Found {
  FaceCommands commands;
  std::int64_t depth_bound = 0;    ///< at least as many volumes as overlap anywhere
  bool is_on_device_only = false;  ///< the silhouette
};

/// Casters whose volumes are counted together.
struct CasterEdges {
  const EdgeAdjacency& adjacency;
  GpuFinder& gpu_finder;
  const EdgeAdjacency::Moved& moved;  ///< by the last update
};

/// Fills the buffers of faces on the processor. `before`: the commands that it gave before the last update with these buffers,
/// silhouette and wants; then what did not move may stay. Null: all is found anew.
inline Found find_faces(const CasterEdges& casters, const glm::dvec4& light, const WantedFaces& wanted,
                        const FaceCommands* before, Silhouette& silhouette, FaceBuffers& faces) {
  Found found;
  if (before) {
    const Refaced refaced = casters.adjacency.find_silhouette(light, casters.moved, silhouette);
    found.commands = rewrite_faces(casters.adjacency, silhouette, wanted, refaced, *before, faces);
  } else {
    casters.adjacency.find_silhouette(light, silhouette);
    found.commands = write_faces(casters.adjacency, silhouette, wanted, faces);
  }
  found.depth_bound = bound_depth(casters.adjacency, silhouette, VolumeCounter::stencil_limit);
  return found;
}

/// The same on the device. The silhouette is filled, too, where it does not stay there: where there are too many sides for the
/// short proof, or it `may_stay` not because every resolve requires it.
inline Found find_on_device(const SceneBuffers& buffers, const CasterEdges& casters, const glm::dvec4& light,
                            const WantedFaces& wanted, bool may_stay, Silhouette& silhouette, FaceBuffers& faces) {
  Found found;
  found.commands = casters.gpu_finder.find(buffers, casters.adjacency, light, wanted, faces);
  found.depth_bound = casters.gpu_finder.depth_bound(casters.adjacency, light).value_or(INT64_MAX);
  found.is_on_device_only = found.depth_bound <= VolumeCounter::stencil_limit && may_stay;
  if (found.is_on_device_only) return found;
  casters.adjacency.find_silhouette(light, silhouette);
  found.depth_bound = bound_depth(casters.adjacency, silhouette, VolumeCounter::stencil_limit);
  return found;
}

}  // namespace stencil_volume
