#pragma once
#include <gnomon/kit/edges.h>

#include <cstdint>

namespace gnomon {

/// At least as many shadow volumes as overlap at any point of space, from the outline alone: how often it winds around a
/// point of the light's image. Where a first quick bound is over `enough` (what the asker can count), finer ones are tried
/// until one column of the image is over it, too; so a result above `enough` is the quick one. Time grows with the edges, times
/// the columns that they span where the quick bound is over.
std::int64_t bound_depth(const EdgeAdjacency& adjacency, const Silhouette& silhouette, std::int64_t enough);

}  // namespace gnomon
