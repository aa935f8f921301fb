#pragma once
#include <gnomon/kit/maps/light_camera.h>

#include <span>
#include <vector>

namespace gnomon::cascaded_map {

struct DepthRange {
  double near, far;  ///< meters
};

/// Where a range is divided into `count` slices: between each and the next. `logarithmic` mixes equal ratios (1) and equal
/// lengths (0) of slices. Source: Zhang, Sun, Xu and Lun 2006.
std::vector<double> practical_splits(const DepthRange& range, int count, double logarithmic);

/// The range widened to powers of sqrt 2, which stay the same while an eye moves a little.
DepthRange quantized(const DepthRange& range);

struct SliceSphere {
  glm::dvec3 center;
  double radius;
};
/// The smallest sphere with its center on the view's axis that holds the part of its pyramid between two depths. `tangent` is
/// that of the angle between axis and the pyramid's edges.
SliceSphere sphere_around(const glm::dvec3& eye, const glm::dvec3& axis, double tangent, const DepthRange& slice);

/// The square of a sphere on a face of parallel rays, moved to whole texels: its size depends on the sphere's radius alone, and
/// its place goes in steps of a texel. `inner` is how many texels of an image it may take, one of them for the step.
LightExtent stable_window(const LightSpaceFace& face, const SliceSphere& sphere, int inner);

/// What of each slice the points take, as seen through the light's only face. Points within `rounding` meters of depth of two
/// slices are in both.
std::vector<LightExtent> seen_in_slices(std::span<const glm::dvec3> points, const LightSpaceFace& face,
                                        const ViewSlices& slices, double rounding);
/// Depths of the points; near > far where there is none.
DepthRange depths_of(std::span<const glm::dvec3> points, const ViewSlices& slices);

}  // namespace gnomon::cascaded_map
