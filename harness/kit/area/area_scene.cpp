#include <gnomon/kit/area/area_scene.h>

#include <algorithm>

namespace gnomon {

namespace {

/// The pyramid from a point over the box of a light, without what is below the horizon: planes dot(plane, x - point) > 0.
struct Pyramid {
  glm::dvec3 point;
  std::array<glm::dvec3, 6> planes;
  std::array<double, 6> offsets{};  ///< plus this
  glm::dvec3 low, high;             ///< box around it

  Pyramid(const glm::dvec3& from, const LightFigure& face) : point(from) {
    const LightFigure::Box& box = face.box();
    const std::array<glm::dvec3, 4> corners = {face.at(box.low), face.at({box.high.x, box.low.y}), face.at(box.high),
                                               face.at({box.low.x, box.high.y})};
    const double turn = glm::dot(glm::cross(corners[0], corners[1]), corners[2]) > 0 ? 1 : -1;
    for (int k = 0; k < 4; ++k) planes[k] = turn * glm::cross(corners[k], corners[(k + 1) % 4]);
    planes[4] = face.normal();
    const glm::dvec3 axis = glm::cross(face.half_u(), face.half_v());
    const double plane = glm::dot(axis, face.center());
    planes[5] = plane > 0 ? -axis : axis;
    offsets[5] = std::abs(plane);
    low = glm::dvec3(0);
    high = glm::dvec3(0);
    for (const glm::dvec3& corner : corners) {
      low = glm::min(low, corner);
      high = glm::max(high, corner);
    }
  }

  /// Whether a box may have a part inside.
  bool meets(const float* lower, const float* upper) const {
    glm::dvec3 side[2];
    for (int k = 0; k < 3; ++k) {
      side[0][k] = lower[k] - point[k];
      side[1][k] = upper[k] - point[k];
      if (side[1][k] < low[k] || side[0][k] > high[k]) return false;
    }
    for (int k = 0; k < 6; ++k) {
      const glm::dvec3& plane = planes[k];
      const glm::dvec3 best(side[plane.x > 0].x, side[plane.y > 0].y, side[plane.z > 0].z);
      if (glm::dot(plane, best) + offsets[k] < 0) return false;
    }
    return true;
  }
};

}  // namespace

AreaScene::AreaScene(const Scene& scene) : scene_(scene) {
  std::vector<Bounds> boxes;
  std::vector<std::array<std::uint32_t, 2>> ids;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    if (!scene.meshes[m].casts) continue;
    for (std::uint32_t t = 0; t < scene.meshes[m].triangles.size(); ++t) {
      boxes.emplace_back().add(scene.meshes[m].corners(t).points);
      ids.push_back({m, t});
    }
  }
  tree_ = BoxTree(boxes);
  for (const std::uint32_t item : tree_.order()) {
    const auto [m, t] = ids[item];
    const Triangle corners = scene.meshes[m].corners(t);
    corners_.push_back({corners.points[0], corners.points[1], corners.points[2]});
    meshes_.push_back(m);
    triangles_.push_back(t);
  }
}

LightShares AreaScene::seen(const Receiver& receiver, const LightFigure& face, LightPieces& pieces, AreaTally& tally) const {
  pieces.start(face);
  ++tally.points;
  const glm::dvec3 point(receiver.point);
  const Pyramid pyramid(point, face);
  const auto meets = [&](const float* lower, const float* upper) { return pyramid.meets(lower, upper); };
  tree_.each(meets, [&](std::uint32_t place) {
    const glm::vec3* const c = corners_[place].data();
    const glm::vec3 lower = glm::min(glm::min(c[0], c[1]), c[2]), upper = glm::max(glm::max(c[0], c[1]), c[2]);
    if (!pyramid.meets(&lower.x, &upper.x)) return false;
    if (receiver.is_own(meshes_[place], triangles_[place]) || receiver.is_coplanar(scene_, c)) return false;
    ++tally.triangles;
    pieces.subtract(glm::dvec3(c[0]) - point, glm::dvec3(c[1]) - point, glm::dvec3(c[2]) - point);
    return pieces.is_gone();
  });
  tally.pieces += pieces.piece_count();
  return pieces.shares();
}

}  // namespace gnomon
