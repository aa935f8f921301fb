#include <gnomon/kit/area/area_scene.h>
#include <gnomon/kit/area/light_pyramid.h>

namespace gnomon {

AreaScene::AreaScene(const Scene& scene) : scene_(scene) {
  std::vector<Bounds> boxes;
  std::vector<std::array<std::uint32_t, 2>> ids;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    if (!scene.meshes[m].casts) continue;
    for (std::uint32_t t = 0; t < scene.meshes[m].triangles.size(); ++t) {
      const Triangle corners = scene.meshes[m].corners(t);
      if (is_degenerate(corners.points[0], corners.points[1], corners.points[2])) continue;
      boxes.emplace_back().add(corners.points);
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

LightShares AreaScene::seen(const Receiver& receiver, const LightFigure& figure, LightPieces& pieces, AreaTally& tally) const {
  pieces.start(figure);
  ++tally.points;
  const glm::dvec3 point(receiver.point);
  const LightPyramid pyramid(point, figure, true);
  const auto meets = [&](const float* lower, const float* upper) { return pyramid.meets(lower, upper); };
  tree_.each(meets, [&](std::uint32_t place) {
    const glm::vec3* const c = corners_[place].data();
    const glm::vec3 lower = glm::min(glm::min(c[0], c[1]), c[2]), upper = glm::max(glm::max(c[0], c[1]), c[2]);
    if (!meets(&lower.x, &upper.x)) return false;
    if (receiver.is_own(meshes_[place], triangles_[place]) || receiver.is_coplanar(scene_, c)) return false;
    ++tally.triangles;
    pieces.subtract(glm::dvec3(c[0]) - point, glm::dvec3(c[1]) - point, glm::dvec3(c[2]) - point);
    return pieces.is_gone();
  });
  tally.pieces += pieces.piece_count();
  return pieces.shares();
}

}  // namespace gnomon
