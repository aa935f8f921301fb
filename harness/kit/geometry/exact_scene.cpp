#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/geometry/holes.h>
#include <gnomon/kit/geometry/refit.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>

namespace gnomon {

namespace {

/// Closest approach of two segments a + s u, 0 <= s <= s_end (perhaps infinite), and b + t v, 0 <= t <= 1. It lies inside both
/// or at an end of one, so the least of the candidates is right however parallel they are: each is a true distance.
struct Approach {
  double squared = INFINITY, s = 0;
};
Approach approach(const glm::dvec3& a, const glm::dvec3& u, double s_end, const glm::dvec3& b, const glm::dvec3& v) {
  Approach best;
  const glm::dvec3 r = b - a;
  const double uu = glm::dot(u, u), uv = glm::dot(u, v), vv = glm::dot(v, v), ru = glm::dot(r, u), rv = glm::dot(r, v);
  const auto try_at = [&](double s, double t) {
    const glm::dvec3 gap = r + t * v - s * u;
    if (const double squared = glm::dot(gap, gap); squared < best.squared) best = {squared, s};
  };
  const auto clamp_s = [&](double s) { return std::clamp(s, 0.0, s_end); };
  const auto clamp_t = [](double t) { return std::clamp(t, 0.0, 1.0); };
  if (const double det = uu * vv - uv * uv; det > 0) {
    const double s = (ru * vv - rv * uv) / det, t = (ru * uv - rv * uu) / det;
    if (s >= 0 && s <= s_end && t >= 0 && t <= 1) try_at(s, t);
  }
  try_at(clamp_s(ru / uu), 0);
  try_at(clamp_s((ru + uv) / uu), 1);
  try_at(0, clamp_t(-rv / vv));
  if (s_end < INFINITY) try_at(s_end, clamp_t((s_end * uv - rv) / vv));
  return best;
}

bool has_area(const Triangle& triangle) { return !is_degenerate(triangle.points[0], triangle.points[1], triangle.points[2]); }

}  // namespace

ExactScene::ExactScene(const Scene& scene) : scene_(&scene), has_transmission_(scene.has_transmission()) {
  std::vector<Caster> casters;
  casters.reserve(scene.triangle_count());
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (!mesh.casts) continue;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      if (const Triangle corners = mesh.corners(t); has_area(corners))
        casters.push_back({corners, m, t});
      else
        left_out_.push_back({m, t});
  }
  std::vector<Bounds> bounds(casters.size());
  for (std::size_t i = 0; i < casters.size(); ++i) bounds[i].add(casters[i].corners.points);
  tree_ = BoxTree(bounds);
  casters_.reserve(casters.size());
  for (const std::uint32_t i : tree_.order()) casters_.push_back(casters[i]);
}

void ExactScene::update(const Changes& changes) {
  if (has_moved_caster(*scene_, changes) && !refit(changes)) *this = ExactScene(*scene_);
}

bool ExactScene::refit(const Changes& changes) {
  for (const Named& left : left_out_)
    if (has_moved(changes, left.mesh) && has_area(scene_->meshes[left.mesh].corners(left.triangle))) return false;
  for (Caster& caster : casters_) {
    if (!has_moved(changes, caster.mesh)) continue;
    caster.corners = scene_->meshes[caster.mesh].corners(caster.triangle);
    if (!has_area(caster.corners)) return false;
  }
  if (!is_refitted_) built_cost_ = tree_.cost();
  is_refitted_ = true;
  tree_.refit([&](std::uint32_t place) {
    Bounds box;
    box.add(casters_[place].corners.points);
    return box;
  });
  return !is_decayed(tree_.cost(), built_cost_);
}

ExactAnswer ExactScene::occluded(const Receiver& receiver, const glm::dvec4& light, ExactTally& tally) const {
  const Segment segment{receiver.point, light};
  bool touched = false;
  const bool crossed = tree_.any(SegmentSlabs(segment), 0, [&](std::uint32_t place) {
    const Caster& caster = casters_[place];
    ++tally.triangles;
    const Crossing crossing = crosses(segment, caster.corners, &tally.signs);
    if (crossing == Crossing::none || leaves_out(receiver, caster)) return false;
    const Mesh& mesh = scene_->meshes[caster.mesh];
    if (mesh.transmission || !is_solid_at(mesh, caster.triangle, segment)) return false;
    touched |= crossing == Crossing::degenerate;
    return crossing == Crossing::crosses;
  });
  // A proper crossing settles the answer whatever else was touched, so the answer does not depend on the order of casters.
  const ExactAnswer answer{crossed || touched, touched && !crossed};
  ++tally.rays;
  tally.degenerate += answer.degenerate;
  return answer;
}

ExactShare ExactScene::transmitted(const Receiver& receiver, const glm::dvec4& light, ExactTally& tally) const {
  const Segment segment{receiver.point, light};
  bool touches_opaque = false, touches_glass = false;
  Crossings glass;
  const bool crossed = tree_.any(SegmentSlabs(segment), 0, [&](std::uint32_t place) {
    const Caster& caster = casters_[place];
    ++tally.triangles;
    const Crossing crossing = crosses(segment, caster.corners, &tally.signs);
    if (crossing == Crossing::none || leaves_out(receiver, caster)) return false;
    const Mesh& mesh = scene_->meshes[caster.mesh];
    if (!is_solid_at(mesh, caster.triangle, segment)) return false;
    if (mesh.transmission) {
      glass.add(caster.mesh, caster.triangle);
      touches_glass |= crossing == Crossing::degenerate;
      return false;
    }
    touches_opaque |= crossing == Crossing::degenerate;
    return crossing == Crossing::crosses;
  });
  ++tally.rays;
  ExactShare answer;
  if (crossed || touches_opaque)
    answer.light.share = glm::dvec3(0);
  else
    answer.light = glass.product(*scene_, segment);
  answer.degenerate = !crossed && (touches_opaque || touches_glass);
  tally.degenerate += answer.degenerate;
  return answer;
}

ExactTally ExactScene::decide(const GBuffer& gbuffer, const Light& light, std::span<float> visibility) const {
  const glm::dvec4 l = homogeneous(light);
  constexpr std::size_t block = 256;
  std::vector<ExactTally> tallies(gbuffer.size() / block + 1);
  for_blocks(gbuffer.size(), block, [&](std::size_t begin, std::size_t end) {
    ExactTally tally;
    for (std::size_t i = begin; i < end; ++i) {
      visibility[i] = 1;
      if (!faces_light(*scene_, gbuffer, light, i)) continue;
      const Receiver receiver = receiver_at(*scene_, gbuffer, i);
      if (has_transmission_)
        visibility[i] = static_cast<float>(transmitted(receiver, l, tally).light.share.x);
      else if (occluded(receiver, l, tally).blocked)
        visibility[i] = 0;
    }
    tallies[begin / block] = tally;
  });
  ExactTally sum;
  for (const ExactTally& tally : tallies) sum += tally;
  return sum;
}

EdgeMargin ExactScene::edge_margin(const Receiver& receiver, const glm::dvec4& light, double limit) const {
  const Segment segment{receiver.point, light};
  const SegmentSlabs slabs(segment);
  const glm::dvec3 way = to_light(light, slabs.origin);
  EdgeMargin margin;
  // An edge farther than the least carried margin so far cannot improve on it: carrying never shrinks a clearance.
  double reach = limit;
  tree_.any(slabs, reach, [&](std::uint32_t place) {
    const Caster& caster = casters_[place];
    if (leaves_out(receiver, caster)) return false;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 a(caster.corners.points[k]), b(caster.corners.points[(k + 1) % 3]);
      const Approach nearest = approach(slabs.origin, way, slabs.end, a, b - a);
      const double clearance = std::sqrt(nearest.squared);
      if (clearance > limit) continue;
      const double share_left = light.w != 0 ? 1 - nearest.s : 1;  // |Le| / |PL|
      margin.clearance = std::min(margin.clearance, clearance);
      margin.carried = std::min(margin.carried, clearance / share_left);
    }
    reach = std::min(limit, margin.carried);
    return false;
  });
  return margin;
}

}  // namespace gnomon
