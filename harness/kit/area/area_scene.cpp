#include <gnomon/kit/area/area_scene.h>
#include <gnomon/kit/area/light_pyramid.h>
#include <gnomon/kit/geometry/refit.h>

#include <algorithm>

namespace gnomon {

namespace {

bool has_area(const glm::vec3* corners) { return !is_degenerate(corners[0], corners[1], corners[2]); }

}  // namespace

AreaScene::AreaScene(const Scene& scene) : scene_(&scene), is_in_order_(follows_animation(scene)) {
  std::vector<Bounds> boxes;
  std::vector<std::array<std::uint32_t, 2>> ids;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    if (!scene.meshes[m].casts) continue;
    for (std::uint32_t t = 0; t < scene.meshes[m].triangles.size(); ++t) {
      const Triangle corners = scene.meshes[m].corners(t);
      if (!has_area(corners.points)) {
        left_out_.push_back({m, t});
        continue;
      }
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

void AreaScene::update(const Changes& changes) {
  const bool is_of_row = is_in_order_;
  if (is_of_row == follows_animation(*scene_) && (!has_moved_caster(*scene_, changes) || refit(changes))) return;
  *this = AreaScene(*scene_);
}

bool AreaScene::refit(const Changes& changes) {
  for (const auto& [mesh, triangle] : left_out_)
    if (has_moved(changes, mesh) && has_area(scene_->meshes[mesh].corners(triangle).points)) return false;
  for (std::size_t place = 0; place < corners_.size(); ++place) {
    if (!has_moved(changes, meshes_[place])) continue;
    std::ranges::copy(scene_->meshes[meshes_[place]].corners(triangles_[place]).points, corners_[place].begin());
    if (!has_area(corners_[place].data())) return false;
  }
  if (!is_refitted_) built_cost_ = tree_.cost();
  is_refitted_ = true;
  tree_.refit([&](std::uint32_t place) {
    Bounds box;
    box.add(corners_[place]);
    return box;
  });
  return !is_decayed(tree_.cost(), built_cost_);
}

bool AreaScene::subtract(std::uint32_t place, const Receiver& receiver, LightPieces& pieces, AreaTally& tally) const {
  const glm::vec3* const c = corners_[place].data();
  if (receiver.is_own(meshes_[place], triangles_[place]) || receiver.is_coplanar(*scene_, c)) return false;
  ++tally.triangles;
  const glm::dvec3 point(receiver.point);
  pieces.subtract(glm::dvec3(c[0]) - point, glm::dvec3(c[1]) - point, glm::dvec3(c[2]) - point);
  return pieces.is_gone();
}

LightShares AreaScene::seen(const Receiver& receiver, const LightFigure& figure, LightPieces& pieces, AreaTally& tally) const {
  pieces.start(figure);
  ++tally.points;
  const LightPyramid pyramid(glm::dvec3(receiver.point), figure, true);
  const auto meets = [&](const float* lower, const float* upper) { return pyramid.meets(lower, upper); };
  const auto is_met = [&](std::uint32_t place) {
    const glm::vec3* const c = corners_[place].data();
    const glm::vec3 lower = glm::min(glm::min(c[0], c[1]), c[2]), upper = glm::max(glm::max(c[0], c[1]), c[2]);
    return meets(&lower.x, &upper.x);
  };
  if (is_in_order_) {
    std::vector<std::uint32_t> places;
    tree_.each(meets, [&](std::uint32_t place) {
      if (is_met(place)) places.push_back(place);
      return false;
    });
    std::ranges::sort(places, {}, [&](std::uint32_t place) { return std::pair(meshes_[place], triangles_[place]); });
    for (const std::uint32_t place : places)
      if (subtract(place, receiver, pieces, tally)) break;
  } else {
    tree_.each(meets, [&](std::uint32_t place) { return is_met(place) && subtract(place, receiver, pieces, tally); });
  }
  tally.pieces += pieces.piece_count();
  return pieces.shares();
}

}  // namespace gnomon
