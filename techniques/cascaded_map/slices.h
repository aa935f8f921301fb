#pragma once
#include <gnomon/kit/maps/light_camera.h>
#include <gnomon/kit/parallel.h>

#include <mutex>

namespace gnomon::cascaded_map {

struct DepthRange {
  double near, far;  ///< meters
};

/// Where a range is divided into `count` slices: between each and the next. `logarithmic` mixes equal ratios (1) and equal
/// lengths (0) of slices. Source: Zhang, Sun, Xu and Lun 2006.
inline std::vector<double> practical_splits(const DepthRange& range, int count, double logarithmic) {
  std::vector<double> splits;
  for (int i = 1; i < count; ++i) {
    const double share = double(i) / count, equal_ratio = range.near * std::pow(range.far / range.near, share);
    splits.push_back(std::lerp(std::lerp(range.near, range.far, share), equal_ratio, logarithmic));
  }
  return splits;
}

/// The range widened to powers of sqrt 2, which stay the same while an eye moves a little.
inline DepthRange quantized(const DepthRange& range) {
  return {std::exp2(std::floor(2 * std::log2(range.near)) / 2), std::exp2(std::ceil(2 * std::log2(range.far)) / 2)};
}

struct SliceSphere {
  glm::dvec3 center;
  double radius;
};
/// The smallest sphere with its center on the view's axis that contains the part of its pyramid between two depths. `tangent`
/// is that of the angle between axis and the pyramid's edges.
///
/// From a center at depth c the far corners are sqrt((b - c)^2 + (b t)^2) away and the near ones sqrt((c - a)^2 + (a t)^2):
/// they are equal at c = (a + b)(1 + t^2) / 2, and from c = b on the far ones decide.
inline SliceSphere sphere_around(const glm::dvec3& eye, const glm::dvec3& axis, double tangent, const DepthRange& slice) {
  const auto& [a, b] = slice;
  const double c = std::min(b, (a + b) / 2 * (1 + tangent * tangent));
  return {eye + c * axis, std::hypot(b - c, b * tangent)};
}

/// The square of a sphere on a face of parallel rays, moved to whole texels: its size depends on the sphere's radius alone, and
/// its place goes in steps of a texel. `inner` is how many texels of an image it may take, one of them for the step.
inline LightExtent stable_window(const LightSpaceFace& face, const SliceSphere& sphere, int inner) {
  const double texel = 2 * sphere.radius / (inner - 1);
  const glm::dvec3 center = face.seen(sphere.center);
  const glm::dvec2 low = texel * glm::floor((glm::dvec2(center) - sphere.radius) / texel);
  return {low, low + inner * texel, center.z - sphere.radius, center.z + sphere.radius};
}

/// A face of parallel rays as seen from the eye, and an extent of the face seen from there. Where coordinates are thousands of
/// times the nearest depth, float32 has no bits left for texels of near slices, unless shaders measure from the eye. Windows of
/// stable images are placed in double, by an origin that does not move with the eye, and moved to the eye afterwards.
inline LightSpace around_eye(const LightSpace& space, const glm::dvec3& eye) {
  LightSpaceFace face = space.main();
  face.origin = eye;
  return LightSpace(face);
}
inline LightExtent less(const LightExtent& extent, const glm::dvec3& origin) {
  const glm::dvec2 place(origin);
  return {extent.low - place, extent.high - place, extent.near - origin.z, extent.far - origin.z};
}
inline bool needs_eye(const LightSpace& space, double extent, const DepthRange& range) {
  return space.is_parallel() && extent > 512 * range.near;
}

/// LightCamera::rounding of a camera around the eye: what an axis distance may be off by, beside 1/128 of a texel, which biases
/// have anyway. Points and vertices are rounded where they are, at most `reach` from the eye (three times, sqrt 3 each); the
/// transforms round what is measured from the eye (four products and three sums, twice).
inline double rounding_around_eye(const LightCamera& camera, const MeshBoxes& boxes, const ViewSlices& slices, double far,
                                  double tangent) {
  double more = 0;
  for (std::size_t i = 0; i < camera.images.size(); ++i) {
    const LightImage& image = camera.images[i];
    if (image.layer < 0) continue;
    double reach = (i < slices.ends.size() ? slices.ends[i] : far) * std::hypot(1, tangent);
    for (const std::uint32_t m : image.casters) {
      const MeshBox& mesh = boxes.meshes[m];
      const glm::dvec3 low = glm::abs(glm::dvec3(mesh.bounds.min) - slices.eye),
                       high = glm::abs(glm::dvec3(mesh.bounds.max) - slices.eye);
      if (mesh.receives) reach = std::max(reach, glm::length(glm::max(low, high)));
    }
    more = std::max(more, 17 * 0x1p-24 * reach - 1 / std::min(image.scale.x, image.scale.y) / 128);
  }
  return 6 * 0x1p-24 * extent(slices.eye) + more;
}

/// Depths of the points; near > far where there is none.
inline DepthRange depths_of(std::span<const glm::dvec3> points, const ViewSlices& slices) {
  DepthRange all{INFINITY, -INFINITY};
  for (const glm::dvec3& point : points) {
    const double depth = slices.depth_of(point);
    all = {std::min(all.near, depth), std::max(all.far, depth)};
  }
  return all;
}

/// The length of each slice of `range` but the last.
inline std::vector<double> lengths_of(const DepthRange& range, std::span<const double> ends) {
  std::vector<double> lengths;
  for (std::size_t i = 0; i < ends.size(); ++i) lengths.push_back(ends[i] - (i == 0 ? range.near : ends[i - 1]));
  return lengths;
}

/// What of each slice the points take, as seen through the light's only face. Points within `rounding` meters of depth of two
/// slices are in both, and so are those where two are blended.
inline std::vector<LightExtent> seen_in_slices(std::span<const glm::dvec3> points, const LightSpaceFace& face,
                                               const ViewSlices& slices, double rounding) {
  std::vector<LightExtent> all(slices.ends.size() + 1);
  std::mutex mutex;
  for_blocks(points.size(), 8192, [&](std::size_t begin, std::size_t end) {
    std::vector<LightExtent> found(all.size());
    for (const glm::dvec3& point : points.subspan(begin, end - begin)) {
      const glm::dvec3 q = face.seen(point);
      const glm::dvec2 place = face.place(q);
      const int slice = slices.slice_of(point);
      found[slice].add(place, q.z);
      // What rounding may put into a neighbor is seen by both: shaders compute depths in float32.
      const double depth = slices.depth_of(point);
      if (slice > 0 && depth - slices.ends[slice - 1] < rounding) found[slice - 1].add(place, q.z);
      if (slice < std::ssize(slices.ends) && slices.ends[slice] - depth < rounding + slices.overlap(slice))
        found[slice + 1].add(place, q.z);
    }
    const std::scoped_lock lock(mutex);
    for (std::size_t k = 0; k < all.size(); ++k) all[k].add(found[k]);
  });
  return all;
}

}  // namespace gnomon::cascaded_map
