#include <gnomon/kit/area/light_points.h>
#include <gnomon/kit/maps/glass_setting.h>

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

constexpr int point_count = 16;           ///< of a light with area
constexpr float most_off = 1.0f / 20;     ///< as much as a right pixel may be off behind glass
constexpr std::uint64_t points_seed = 0;  ///< any

/// Whether a texel lets everything through: the triangle is not there then, but is drawn.
bool has_clear_texels(const Mesh& mesh) {
  if (!mesh.casts || !mesh.transmission) return false;
  const Transmission& glass = *mesh.transmission;
  for (int row = 0; row < glass.height(); ++row)
    for (int column = 0; column < glass.width(); ++column)
      if (glass.at(column, row) == glm::vec3(1)) return true;
  return false;
}

Scene without_transmission(const Scene& scene) {
  Scene opaque;
  opaque.meshes = scene.meshes;
  for (Mesh& mesh : opaque.meshes) mesh.transmission = nullptr;
  return opaque;
}

std::string_view cause_of(float error) { return std::abs(error) > most_off ? glass_causes[0].id : ""; }

}  // namespace

struct GlassDifference::Exact {
  ExactScene truth;
  std::optional<Scene> opaque_scene;  ///< where the truth does not tell which triangles were taken for opaque
  std::optional<ExactScene> as_opaque;

  Exact(const Scene& scene, GlassAs as) : truth(scene) {
    if (as != GlassAs::opaque || std::ranges::none_of(scene.meshes, has_clear_texels)) return;
    opaque_scene = without_transmission(scene);
    as_opaque.emplace(*opaque_scene);
  }
  Exact(const Exact&) = delete;
};

float GlassDifference::error(const Receiver& receiver, const glm::dvec4& light) const {
  if (!exact_) exact_ = std::make_shared<const Exact>(*scene_, as_);
  ExactTally tally;
  const Crossings::Product found = exact_->truth.transmitted(receiver, light, tally).light;
  const auto share = static_cast<float>(found.share.x);  // as references have it
  if (found.surfaces > 0) return (as_ == GlassAs::none ? 1.0f : 0.0f) - share;
  const bool is_lit = share > 0;
  return is_lit && exact_->as_opaque && exact_->as_opaque->occluded(receiver, light, tally).blocked ? -share : 0;
}

std::string_view GlassDifference::cause(const Receiver& receiver, const glm::dvec4& light) const {
  return scene_ ? cause_of(error(receiver, light)) : "";
}

std::string_view GlassDifference::cause(const GBuffer& gbuffer, const Light& light, std::size_t pixel) const {
  if (!scene_) return "";
  const Receiver receiver = receiver_at(*scene_, gbuffer, pixel);
  if (!has_area(light)) return cause(receiver, homogeneous(light));
  const PointWeights weights(light, gbuffer.position(pixel), gbuffer.normal(pixel));
  float sum = 0, whole = 0;
  for (const glm::vec3& point : light_points(light, "stratified", point_count, points_seed)) {
    const float weight = weights.at(point);
    if (!(weight > 0)) continue;
    whole += weight;
    sum += weight * error(receiver, glm::dvec4(point, 1));
  }
  return whole > 0 ? cause_of(sum / whole) : "";
}

void GlassDifference::explain(Explanation& why, const GBuffer& gbuffer, const Light& light, std::size_t pixel) const {
  const std::string_view found = cause(gbuffer, light, pixel);
  if (found.empty()) return;
  why.cause = found;
  if (as_ == GlassAs::none) why.covered = true;
}

}  // namespace gnomon
