#include "slices.h"

#include <gnomon/kit/parallel.h>

#include <cmath>
#include <mutex>

namespace gnomon::cascaded_map {

std::vector<double> practical_splits(const DepthRange& range, int count, double logarithmic) {
  std::vector<double> splits;
  for (int i = 1; i < count; ++i) {
    const double share = double(i) / count;
    splits.push_back(
        std::lerp(std::lerp(range.near, range.far, share), range.near * std::pow(range.far / range.near, share), logarithmic));
  }
  return splits;
}

DepthRange quantized(const DepthRange& range) {
  return {std::exp2(std::floor(2 * std::log2(range.near)) / 2), std::exp2(std::ceil(2 * std::log2(range.far)) / 2)};
}

// From a center at depth c the far corners are sqrt((b - c)^2 + (b t)^2) away and the near ones sqrt((c - a)^2 + (a t)^2): they
// are equal at c = (a + b)(1 + t^2) / 2, and from c = b on the far ones decide.
SliceSphere sphere_around(const glm::dvec3& eye, const glm::dvec3& axis, double tangent, const DepthRange& slice) {
  const auto& [a, b] = slice;
  const double c = std::min(b, (a + b) / 2 * (1 + tangent * tangent));
  return {eye + c * axis, std::hypot(b - c, b * tangent)};
}

LightExtent stable_window(const LightSpaceFace& face, const SliceSphere& sphere, int inner) {
  const double texel = 2 * sphere.radius / (inner - 1);
  const glm::dvec3 center = face.seen(sphere.center);
  const glm::dvec2 low = texel * glm::floor((glm::dvec2(center) - sphere.radius) / texel);
  return {low, low + inner * texel, center.z - sphere.radius, center.z + sphere.radius};
}

namespace {

/// Calls `add(found, point)` for every point that faces the light, with a `found` for each thread, and joins them.
template <class Found, class Add, class Join>
void for_points_facing(const Scene& scene, const Light& light, const GBuffer& gbuffer, const Found& none, Add add, Join join) {
  std::mutex mutex;
  for_blocks(gbuffer.size(), 8192, [&](std::size_t begin, std::size_t end) {
    Found found = none;
    for (std::size_t i = begin; i < end; ++i)
      if (faces_light(scene, gbuffer, light, i)) add(found, glm::dvec3(gbuffer.position(i)));
    const std::scoped_lock lock(mutex);
    join(found);
  });
}

}  // namespace

DepthRange depths_seen(const Scene& scene, const Light& light, const ViewSlices& slices, const GBuffer& gbuffer) {
  const DepthRange none{INFINITY, -INFINITY};
  DepthRange all = none;
  const auto add = [](DepthRange& range, const DepthRange& other) {
    range = {std::min(range.near, other.near), std::max(range.far, other.far)};
  };
  for_points_facing(
      scene, light, gbuffer, none,
      [&](DepthRange& found, const glm::dvec3& point) {
        const double depth = slices.depth_of(point);
        add(found, {depth, depth});
      },
      [&](const DepthRange& found) { add(all, found); });
  return all;
}

std::vector<LightExtent> seen_in_slices(const Scene& scene, const Light& light, const LightSpaceFace& face,
                                        const ViewSlices& slices, const GBuffer& gbuffer) {
  std::vector<LightExtent> all(slices.ends.size() + 1);
  const std::vector<LightExtent> none = all;
  for_points_facing(
      scene, light, gbuffer, none,
      [&](std::vector<LightExtent>& found, const glm::dvec3& point) {
        const glm::dvec3 q = face.seen(point);
        const int slice = slices.slice_of(point);
        found[slice].add(face.place(q), q.z);
        // What rounding may put into a neighbor is seen by both: shaders compute depths in float32.
        const double depth = slices.depth_of(point), slack = 0x1p-18 * std::abs(depth) + 0x1p-20 * glm::length(point);
        if (slice > 0 && depth - slices.ends[slice - 1] < slack) found[slice - 1].add(face.place(q), q.z);
        if (slice < std::ssize(slices.ends) && slices.ends[slice] - depth < slack) found[slice + 1].add(face.place(q), q.z);
      },
      [&](const std::vector<LightExtent>& found) {
        for (std::size_t k = 0; k < all.size(); ++k) all[k].add(found[k]);
      });
  return all;
}

}  // namespace gnomon::cascaded_map
