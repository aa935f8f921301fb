#include "reprojection.h"

#include <gnomon/kit/bytes.h>
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <cmath>

namespace gnomon::denoised_rays {

namespace {

constexpr double most_footprints = 2;  ///< from a point's plane, of a pixel that shows the same surface
constexpr double least_cosine = 0.9;   ///< between its normal and the point's

bool is_same_view(const GBuffer& a, const GBuffer& b) {
  return a.width == b.width && a.height == b.height && a.view.eye == b.view.eye && a.view.target == b.view.target &&
         a.view.up == b.view.up && a.view.fov_y_degrees == b.view.fov_y_degrees;
}

/// Where the camera sees a point, in pixels with centers at whole numbers; nothing behind the eye.
std::optional<glm::dvec2> seen_at(const Camera& camera, const glm::dvec3& point) {
  const glm::dvec3 to = point - camera.eye;
  const double depth = glm::dot(to, camera.forward), aspect = static_cast<double>(camera.width) / camera.height;
  if (!(depth > 0)) return std::nullopt;
  const double right = glm::dot(to, camera.right) / (depth * camera.tan_y * aspect);
  const double up = glm::dot(to, camera.up) / (depth * camera.tan_y);
  return glm::dvec2((1 + right) / 2 * camera.width - 0.5, (1 - up) / 2 * camera.height - 0.5);
}

}  // namespace

SourceTaps::SourceTaps(const Source& source, int width) {
  const float left = std::floor(source.x), top = std::floor(source.y), x = source.x - left, y = source.y - top;
  float sum = 0;
  for (int k = 0; k < 4; ++k) {
    if (!(source.kept >> k & 1)) continue;
    const float w = (k % 2 ? x : 1 - x) * (k / 2 ? y : 1 - y);
    pixel[count] = static_cast<std::size_t>((static_cast<std::ptrdiff_t>(top) + k / 2) * width +
                                            static_cast<std::ptrdiff_t>(left) + k % 2);
    weight[count++] = w;
    sum += w;
  }
  for (int k = 0; k < count; ++k) weight[k] /= sum;
}

std::optional<SurfacePoint> carried_back(const SurfacePoint& point, const std::array<glm::vec3, 3>& now,
                                         const std::array<glm::vec3, 3>& before) {
  const glm::dvec3 a(now[0]), u = glm::dvec3(now[1]) - a, v = glm::dvec3(now[2]) - a, across = glm::cross(u, v);
  const glm::dvec3 a0(before[0]), u0 = glm::dvec3(before[1]) - a0, v0 = glm::dvec3(before[2]) - a0,
                                  across0 = glm::cross(u0, v0);
  const double area = glm::dot(across, across), length0 = glm::length(across0);
  if (!(area > 0) || !(length0 > 0)) return std::nullopt;
  const glm::dvec3 from = point.position - a;
  const double s = glm::dot(glm::cross(from, v), across) / area, t = glm::dot(glm::cross(u, from), across) / area;
  const double side = glm::dot(across, point.normal) < 0 ? -1 : 1;
  return SurfacePoint{a0 + s * u0 + t * v0, side / length0 * across0};
}

/// What all pixels of a frame have in common.
struct Reprojection::Frame {
  const Scene& scene;
  const Pose& pose;
  const GBuffer& gbuffer;
  const FilterGuides& guides;
  Camera last_camera;
  bool has_same_view;
};

void Reprojection::follow(const Scene& scene, const std::shared_ptr<const Pose>& pose, const GBuffer& gbuffer,
                          const FilterGuides& guides, std::span<const std::uint8_t> faces, std::span<const float> lengths,
                          bool drops) {
  source_width_ = gbuffer_.width;
  sources_.resize(gbuffer.size());
  states_.resize(gbuffer.size());
  if (!has_last() || drops) {
    for_blocks(gbuffer.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        sources_[i] = {};
        states_[i] = faces[i] ? State::from_start : State::none;
      }
    });
    return;
  }
  const Frame frame{
      scene, *pose, gbuffer, guides, Camera(gbuffer_.view, gbuffer_.width, gbuffer_.height), is_same_view(gbuffer, gbuffer_)};
  for_blocks(gbuffer.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      sources_[i] = {};
      states_[i] = State::none;
      if (!faces[i]) continue;
      sources_[i] = find(frame, i);
      states_[i] = sources_[i].kept ? State::from_start : State::after_refusal;
      const SourceTaps taps(sources_[i], source_width_);
      for (int k = 0; k < taps.count; ++k)
        if (const std::size_t q = taps.pixel[k]; last_states_[q] == State::after_refusal && lengths[q] < short_history)
          states_[i] = State::after_refusal;
    }
  });
}

Source Reprojection::find(const Frame& frame, std::size_t pixel) const {
  const GBuffer& gbuffer = frame.gbuffer;
  const std::uint32_t mesh = gbuffer.mesh[pixel], triangle = gbuffer.triangle[pixel];
  const int x = static_cast<int>(pixel % gbuffer.width), y = static_cast<int>(pixel / gbuffer.width);
  const bool is_still = frame.pose.has_still(*pose_, mesh);
  // The very same point: without the rounding of a projection.
  if (frame.has_same_view && is_still && gbuffer_.mesh[pixel] == mesh && gbuffer_.triangle[pixel] == triangle &&
      last_states_[pixel] != State::none)
    return {static_cast<float>(x), static_cast<float>(y), 1};

  SurfacePoint point{gbuffer.position(pixel), gbuffer.normal(pixel)};
  const Mesh& of = frame.scene.meshes[mesh];
  if (!is_still && !(gbuffer.truth == Truth::shape && of.has_curved_shape())) {
    const glm::uvec3 corners = of.triangles[triangle];
    const auto at = [&](const Pose& pose) {
      const std::vector<glm::vec3>& positions = pose.positions(mesh);
      return std::array{positions[corners.x], positions[corners.y], positions[corners.z]};
    };
    const std::optional<SurfacePoint> before = carried_back(point, at(frame.pose), at(*pose_));
    if (!before) return {};
    point = *before;
  }
  const std::optional<glm::dvec2> seen = seen_at(frame.last_camera, point.position);
  // Before the conversion to whole numbers: a point beside the eye may be seen anywhere.
  if (!seen || !(seen->x > -1 && seen->y > -1 && seen->x < gbuffer_.width && seen->y < gbuffer_.height)) return {};
  Source source{static_cast<float>(seen->x), static_cast<float>(seen->y), 0};
  const double most = most_footprints * frame.guides.footprint(x, y);
  const float left = std::floor(source.x), top = std::floor(source.y);
  for (int k = 0; k < 4; ++k) {
    const int column = static_cast<int>(left) + k % 2, row = static_cast<int>(top) + k / 2;
    if (column < 0 || row < 0 || column >= gbuffer_.width || row >= gbuffer_.height) continue;
    const float weight = (k % 2 ? source.x - left : 1 - (source.x - left)) * (k / 2 ? source.y - top : 1 - (source.y - top));
    const std::size_t q = static_cast<std::size_t>(row) * gbuffer_.width + column;
    if (!(weight > 0) || gbuffer_.mesh[q] != mesh || last_states_[q] == State::none) continue;
    const double apart = std::abs(glm::dot(point.normal, glm::dvec3(gbuffer_.position(q)) - point.position));
    if (apart < most && glm::dot(point.normal, glm::dvec3(gbuffer_.normal(q))) > least_cosine) source.kept |= 1u << k;
  }
  return source;
}

void Reprojection::keep(const GBuffer& gbuffer, std::shared_ptr<const Pose> pose) {
  gbuffer_ = gbuffer;
  pose_ = std::move(pose);
  states_.swap(last_states_);
  // `began_refused` is asked until the next frame; the other array is written anew then.
  states_.resize(last_states_.size());
  std::copy(last_states_.begin(), last_states_.end(), states_.begin());
}

std::size_t Reprojection::bytes() const {
  const std::size_t of_gbuffer = has_last() ? gbuffer_.size() * (6 * sizeof(float) + 2 * sizeof(std::uint32_t)) : 0;
  return of_gbuffer + bytes_of(sources_, states_, last_states_);
}

}  // namespace gnomon::denoised_rays
