#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/maps/light_camera.h>
#include <gnomon/kit/parallel.h>

#include <mutex>

namespace gnomon {

glm::dvec2 LightImage::window_of(const glm::dvec2& texel) const {
  const glm::dvec2 q = (texel - offset) / scale;
  return pivot + q / (1 - lean * q.y);
}

glm::dvec2 LightImage::texel_step(const glm::dvec2& window, const glm::dvec2& step) const {
  const double d = divisor(window);
  return (step - (window - pivot) * (lean * step.y / d)) / d * scale;
}

glm::dvec2 LightImage::texel_width(const glm::dvec3& q) const {
  const glm::dvec2 window = place(q);
  // A column of a warped image runs toward its center: one row on, it has moved aside.
  const double d = divisor(window), row = d * d / scale.y, aside = row * std::abs(lean * (window.x - pivot.x)) / d;
  return (is_perspective ? q.z : 1) * glm::dvec2(d / scale.x + aside, row);
}

glm::dmat4 LightImage::clip_from_world(int resolution, const glm::dvec3& shift) const {
  const glm::dvec2 s = 2.0 * scale / double(resolution), o = 2.0 * offset / double(resolution) - 1.0;
  // Clip space has y up and texel rows go down. `one` is what window coordinates are over, w that times the divisor.
  const glm::dvec4 one = is_perspective ? glm::dvec4(0, 0, 1, 0) : glm::dvec4(0, 0, 0, 1), up(0, 1, 0, 0);
  const glm::dvec4 w = (1 - lean * pivot.y) * one + lean * up;
  const glm::dvec4 x = s.x * (glm::dvec4(1, 0, 0, 0) - pivot.x * one) + o.x * w, y = -s.y * (up - pivot.y * one) - o.y * w;
  const glm::dvec4 z = is_perspective ? glm::dvec4(0, 0, 0, near) : glm::dvec4(0, 0, -1, far) / (far - near);
  glm::dmat4 turned_and_moved(light_from_world);
  turned_and_moved[3] = glm::dvec4(-(light_from_world * (origin - shift)), 1);
  return glm::transpose(glm::dmat4(x, y, z, w)) * turned_and_moved;
}

double LightImage::axis_distance(double depth) const {
  if (depth == 0) return INFINITY;
  return is_perspective ? near / depth : far - depth * (far - near);
}

bool LightCamera::holds(const glm::ivec2& texel) const {
  return glm::all(glm::greaterThanEqual(texel, glm::ivec2(0))) && glm::all(glm::lessThan(texel, glm::ivec2(resolution)));
}

std::span<const float> LightCamera::texels_of(const LightImage& image, std::span<const float> all) const {
  const std::size_t texels = static_cast<std::size_t>(resolution) * resolution;
  return image.layer < 0 ? std::span<const float>() : all.subspan(image.layer * texels, texels);
}

Tap LightImage::tap(const glm::dvec2& place, double z, double weight) const {
  const glm::dvec2 window = window_of(place);
  if (!is_perspective) return {to_world({window, near}), axis(2), weight, z - near};
  const glm::dvec3 through(window, 1);
  return {origin, glm::normalize(through * light_from_world), weight, z * glm::length(through)};
}

Tap LightCamera::tap(const LightImage& image, std::span<const float> depths, const glm::ivec2& texel, double weight) const {
  const glm::dvec2 place = glm::dvec2(texel) + 0.5;
  const std::size_t rows = static_cast<std::size_t>(image.layer) * resolution + texel.y;
  const double divisor = image.divisor(image.window_of(place));
  const double z = holds(texel) ? image.axis_distance(depths[rows * resolution + texel.x] * divisor) : INFINITY;
  return image.tap(place, z, weight);
}

namespace {

/// How images are fitted.
struct Fit {
  double tangent;
  int resolution, margin;
  FitWindow window = FitWindow::shared;
  double inner() const { return resolution - 2.0 * margin; }
  double wide() const { return tangent * resolution / inner(); }  ///< the pyramid with its margin
};

/// Scale, offset and depths of an image that holds what casters and receivers share. Whether they share anything.
bool fit_window(LightImage& image, const LightExtent& casters, const LightExtent& receivers, const Fit& fit) {
  const bool is_shared = fit.window == FitWindow::shared;
  const glm::dvec2 low = is_shared ? glm::max(casters.low, receivers.low) : receivers.low;
  const glm::dvec2 high = is_shared ? glm::min(casters.high, receivers.high) : receivers.high;
  if (casters.empty() || receivers.empty() || low.x > high.x || low.y > high.y || casters.near >= receivers.far) return false;
  // Texels below the float32 resolution of window coordinates would be noise; a window of one point has one all the same.
  const glm::dvec2 least = 0x1p-20 * glm::max(glm::max(glm::abs(low), glm::abs(high)), glm::dvec2(glm::length(high - low)));
  const double point = 0x1p-40 * (image.is_perspective ? 1 : std::max(std::abs(casters.near), std::abs(receivers.far)));
  const glm::dvec2 texel = glm::max(glm::max((high - low) / fit.inner(), least), glm::dvec2(point));
  image.scale = 1.0 / texel;
  image.offset = fit.resolution / 2.0 - (low + high) / 2.0 * image.scale;
  // Casters nearer than 1/1024 of the reach are clamped to it, for the precision of depth: they still cast, but on nothing that
  // is as near.
  image.far = receivers.far;
  image.near = image.is_perspective ? std::max(casters.near, image.far * 0x1p-10) : casters.near;
  return true;
}

/// Fits the image to its casters and to these receivers.
void fit_image(LightImage& image, const MeshBoxes& boxes, const LightExtent& receivers, const Fit& fit) {
  LightExtent casters;
  for (std::uint32_t i = 0; i < boxes.meshes.size(); ++i) {
    if (!boxes.meshes[i].casts) continue;
    const LightExtent extent = seen_of(image, boxes.meshes[i].bounds, fit.wide());
    if (extent.empty()) continue;
    casters.add(extent);
    image.casters.push_back(i);
  }
  if (!fit_window(image, casters, receivers, fit)) image.casters.clear();
}

/// Leaves out the casters that the window does not see, or only behind all receivers, and fits the depths to the others.
void leave_out_unseen(LightImage& image, const MeshBoxes& boxes, const LightExtent& receivers, const Fit& fit) {
  if (image.casters.empty()) return;
  const glm::dvec2 low = -image.offset / image.scale, high = (double(fit.resolution) - image.offset) / image.scale;
  LightExtent casters;
  std::erase_if(image.casters, [&](std::uint32_t i) {
    const LightExtent extent = seen_of(image, boxes.meshes[i].bounds, fit.wide());
    const bool is_seen = glm::all(glm::lessThanEqual(extent.low, high)) && glm::all(glm::greaterThanEqual(extent.high, low)) &&
                         extent.near < receivers.far;
    if (is_seen) casters.add(extent);
    return !is_seen;
  });
  if (image.casters.empty()) return;
  // Receivers nearer than that, which are known here, bring the near end with them.
  const double nearest = std::clamp(receivers.near, image.far * 0x1p-20, image.far * 0x1p-10);
  image.near = image.is_perspective ? std::max(casters.near, nearest) : casters.near;
}

/// Right, down, axis.
glm::dmat3 frame_along(const glm::dvec3& axis) {
  const glm::dvec3 a = glm::abs(axis);
  glm::dvec3 helper(0);  // the axis after the longest
  helper[a.x >= a.y && a.x >= a.z ? 1 : a.y >= a.z ? 2 : 0] = 1;
  const auto [u, v] = Across(axis, helper);
  return frame_of(v, -u, axis);
}

const SpotLight* narrow_spot(const Light& light) {
  const auto* spot = std::get_if<SpotLight>(&light.kind);
  return spot && spot->outer_degrees <= widest_spot_degrees ? spot : nullptr;
}

/// Half the opening of a light's images.
double tangent_of(const Light& light) {
  const SpotLight* const spot = narrow_spot(light);
  return spot ? std::tan(glm::radians(double(spot->outer_degrees))) : 1;
}

/// Without images that are fitted yet.
LightCamera camera_of(const Light& light, const LightSpace& space, const MeshBoxes& boxes, int resolution) {
  LightCamera camera{.space = space, .resolution = resolution};
  // Sixteen half units in the last place of the largest coordinate: the three of the rounded point and vertices (sqrt 3 each),
  // and four products and three sums of the transforms in float32, twice.
  const glm::dvec4 l = homogeneous(light);
  camera.rounding = 16 * 0x1p-24 * std::max(boxes.extent, extent(glm::dvec3(l) * l.w));
  for (int i = 0; i < camera.space.face_count(); ++i) camera.images.push_back({camera.space[i]});
  return camera;
}

void number_layers(LightCamera& camera) {
  for (LightImage& image : camera.images)
    if (!image.casters.empty()) image.layer = camera.layer_count++;
}

/// Finds the points of a picture that face the light, so that the light's images are read for them.
struct PointsFacing {
  const Light& light;
  const MeshBoxes& boxes;
  const GBuffer& gbuffer;
  double radius = 0;  // of a ball around the light
  glm::dvec4 l = homogeneous(light);
  bool has_cone = std::holds_alternative<SpotLight>(light.kind);

  /// Calls visit(point) for those of pixels begin .. end - 1.
  template <class Visit>
  void each(std::size_t begin, std::size_t end, const Visit& visit) const {
    for (std::size_t i = begin; i < end; ++i) {
      if (gbuffer.is_background(i) || !boxes.meshes[gbuffer.mesh[i]].receives) continue;
      const glm::dvec3 point = gbuffer.position(i);
      if (glm::dot(glm::dvec3(gbuffer.normal(i)), to_light(l, point)) > -radius && (!has_cone || in_spot_cone(light, point)))
        visit(point);
    }
  }
};

constexpr std::size_t point_block = 8192;

/// What of each face the points of a picture take that face the light.
std::array<LightExtent, 6> seen_in_picture(const Light& light, const MeshBoxes& boxes, const LightSpace& space,
                                           const GBuffer& gbuffer, double radius) {
  const PointsFacing facing{light, boxes, gbuffer, radius};
  std::array<LightExtent, 6> all;
  std::mutex mutex;
  for_blocks(gbuffer.size(), point_block, [&](std::size_t begin, std::size_t end) {
    std::array<LightExtent, 6> found;
    facing.each(begin, end, [&](const glm::dvec3& point) {
      const auto [face, q] = space.seen(point);
      found[face].add(space.is_parallel() ? glm::dvec2(q) : glm::dvec2(q) / q.z, q.z);
    });
    const std::scoped_lock lock(mutex);
    for (std::size_t face = 0; face < found.size(); ++face) all[face].add(found[face]);
  });
  return all;
}

}  // namespace

bool looks_through_cube(const Light& light) {
  return std::holds_alternative<PointLight>(light.kind) ||
         (std::holds_alternative<SpotLight>(light.kind) && !narrow_spot(light));
}

MeshBoxes mesh_boxes(const Scene& scene, GlassAs glass) {
  MeshBoxes boxes;
  Bounds all;
  for (const Mesh& mesh : scene.meshes) {
    const bool is_left_out = mesh.transmission && glass == GlassAs::none;
    boxes.meshes.push_back(
        {.bounds = mesh.reached(), .casts = mesh.casts && !is_left_out, .receives = mesh.receives && mesh.seen});
    all.add(boxes.meshes.back().bounds);
  }
  boxes.extent = all.extent();
  const glm::vec3 slack(static_cast<float>(boxes.extent * 0x1p-20));
  for (MeshBox& box : boxes.meshes) {
    box.bounds.min -= slack;
    box.bounds.max += slack;
  }
  return boxes;
}

double diagonal_of(const Scene& scene) {
  Bounds box;
  for (const Mesh& mesh : scene.meshes) box.add(mesh.reached());
  return box.empty() ? 0 : glm::distance(glm::dvec3(box.min), glm::dvec3(box.max));
}

LightSpace light_space_of(const Light& light, const MeshBoxes& boxes) {
  const glm::dvec4 l = homogeneous(light);
  if (l.w == 0) {
    Bounds all;
    for (const MeshBox& mesh : boxes.meshes) all.add(mesh.bounds);
    const glm::dvec3 middle = (glm::dvec3(all.min) + glm::dvec3(all.max)) / 2.0;
    return LightSpace(LightSpaceFace{middle, frame_along(-glm::normalize(glm::dvec3(l))), false});
  }
  if (const SpotLight* const spot = narrow_spot(light))
    return LightSpace(LightSpaceFace{glm::dvec3(l), frame_along(glm::normalize(glm::dvec3(spot->direction))), true});
  return {glm::dvec3(l), glm::dmat3(1), OppositeFaces::mirrored, 0};
}

LightCamera fit_to_scene(const Light& light, const MeshBoxes& boxes, int resolution, int margin) {
  const Fit fit{tangent_of(light), resolution, margin};
  LightCamera camera = camera_of(light, light_space_of(light, boxes), boxes, resolution);
  for (LightImage& image : camera.images) {
    LightExtent receivers;
    for (const MeshBox& mesh : boxes.meshes)
      if (mesh.receives) receivers.add(seen_of(image, mesh.bounds, fit.tangent));
    fit_image(image, boxes, receivers, fit);
  }
  number_layers(camera);
  return camera;
}

std::vector<glm::dvec3> points_facing(const Light& light, const MeshBoxes& boxes, const GBuffer& gbuffer) {
  const PointsFacing facing{light, boxes, gbuffer};
  std::vector<std::vector<glm::dvec3>> found((gbuffer.size() + point_block - 1) / point_block);
  for_blocks(gbuffer.size(), point_block, [&](std::size_t begin, std::size_t end) {
    facing.each(begin, end, [&](const glm::dvec3& point) { found[begin / point_block].push_back(point); });
  });
  std::vector<glm::dvec3> all;
  for (const std::vector<glm::dvec3>& points : found) all.insert(all.end(), points.begin(), points.end());
  return all;
}

std::vector<std::uint32_t> parts_of(const LightCamera& camera, const Scene& scene, const GBuffer& gbuffer, const Light& light) {
  if (camera.images.size() < 2) return {};
  std::vector<std::uint32_t> parts(gbuffer.size());
  for_blocks(gbuffer.size(), point_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (faces_light(scene, gbuffer, light, i))
        parts[i] = 1u + static_cast<std::uint32_t>(camera.image_of(gbuffer.position(i)));
  });
  return parts;
}

LightCamera fit_to_view(const Light& light, const MeshBoxes& boxes, const GBuffer& gbuffer, int resolution, int margin,
                        double radius) {
  const LightSpace space = light_space_of(light, boxes);
  const std::array<LightExtent, 6> receivers = seen_in_picture(light, boxes, space, gbuffer, radius);
  return fit_to_extents(light, space, boxes, std::span(receivers).first(space.face_count()), resolution, margin);
}

LightCamera fit_to_extents(const Light& light, const LightSpace& space, const MeshBoxes& boxes,
                           std::span<const LightExtent> receivers, int resolution, int margin, FitWindow window) {
  const Fit fit{tangent_of(light), resolution, margin, window};
  LightCamera camera = camera_of(light, space, boxes, resolution);
  camera.images.resize(receivers.size(), camera.images[0]);
  for (std::size_t i = 0; i < camera.images.size(); ++i) {
    fit_image(camera.images[i], boxes, receivers[i], fit);
    leave_out_unseen(camera.images[i], boxes, receivers[i], fit);
  }
  number_layers(camera);
  return camera;
}

}  // namespace gnomon
