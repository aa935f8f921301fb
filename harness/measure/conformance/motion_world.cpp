#include "measure/conformance/motion_world.h"

#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/rays/gbuffer_maker.h>

#include <cmath>
#include <memory>

#include "measure/conformance/trial.h"
#include "measure/conformance/world.h"

namespace gnomon::conformance {

void add_track(Motion& motion, std::uint32_t node, Track::Property property, const std::vector<Key>& keys) {
  Track track{node, property, Track::Interpolation::linear, {}, {}};
  for (const Key& key : keys) {
    track.times.push_back(key.seconds);
    track.values.insert(track.values.end(), key.values.begin(), key.values.end());
  }
  motion.animations[0].tracks.push_back(std::move(track));
}

std::uint32_t add_placed(Scene& scene, Motion& motion, Mesh mesh, const glm::vec3& at) {
  const auto node = static_cast<std::uint32_t>(motion.nodes.size());
  motion.nodes.emplace_back();
  motion.nodes.back().translation = at;
  Rig rig;
  rig.mesh = static_cast<std::uint32_t>(scene.meshes.size());
  rig.node = node;
  rig.base.assign(mesh.positions.begin(), mesh.positions.end());
  motion.rigs.push_back(std::move(rig));
  for (glm::vec3& p : mesh.positions) p += at;
  mesh.shape.reset();
  scene.meshes.push_back(std::move(mesh));
  return node;
}

namespace {

using Property = Track::Property;

Mesh box(const std::string& name, const glm::vec3& half) {
  return tessellate(Box{.min = -half, .max = half}, default_segments, name);
}

// All numbers are multiples of powers of two: at keys the vertices are exactly where they are said to be. The point light is at
// (0.75, 8, 1), see over_ground().
constexpr glm::vec3 light_place(0.75f, 8, 1);

void add_boxes(Scene& scene, Motion& motion) {
  const std::uint32_t walker = add_placed(scene, motion, box("walker", {0.5f, 0.625f, 0.375f}), {-2, 0.75f, 1});
  add_track(motion, walker, Property::translation,
            {{0, {-2, 0.75, 1}}, {1.5, {2, 0.75, 1.5}}, {3, {2.5, 1.25, -2}}, {4, {-2, 0.75, 1}}});
  const double half_turn = std::sqrt(0.5);
  add_track(motion, walker, Property::rotation, {{0, {0, 0, 0, 1}}, {2, {0, half_turn, 0, half_turn}}, {4, {0, 0, 0, 1}}});
  const std::uint32_t comer = add_placed(scene, motion, box("comer", {0.375f, 0.5f, 0.375f}), {-1, 0.75f, 2.5f});
  add_track(motion, comer, Property::scale,
            {{0, {1, 1, 1}}, {2.5, {1, 1, 1}}, {2.875, {0, 0, 0}}, {3.125, {0, 0, 0}}, {3.5, {1, 1, 1}}});
  const std::uint32_t crosser = add_placed(scene, motion, box("crosser", {0.25f, 0.25f, 0.25f}), {-3, 7.5f, 1});
  add_track(motion, crosser, Property::translation,
            {{0, {-3, 7.5, 1}}, {1, {0.75, 8, 1}}, {1.5, {1, 8, 1}}, {2, {3, 7, -1}}, {4, {-3, 7.5, 1}}});
}

/// A strip that stands on the ground, of eight pieces one above the other.
Mesh standing_strip() {
  Mesh strip;
  strip.name = "strip";
  constexpr std::uint32_t pieces = 8;
  for (std::uint32_t k = 0; k <= pieces; ++k)
    for (const float side : {-0.5f, 0.5f}) strip.positions.emplace_back(0, 0.25f * static_cast<float>(k), side);
  for (std::uint32_t k = 0; k < pieces; ++k) {
    strip.triangles.emplace_back(2 * k, 2 * k + 1, 2 * k + 2);
    strip.triangles.emplace_back(2 * k + 2, 2 * k + 1, 2 * k + 3);
  }
  finish(strip);
  return strip;
}

/// The upper of two joints turns by a right angle. Weights are multiples of 1/8.
void add_strip(Scene& scene, Motion& motion) {
  const glm::vec3 foot(-0.5f, 0.125f, -2.5f);
  const std::uint32_t lower = add_placed(scene, motion, standing_strip(), foot);
  const auto upper = static_cast<std::uint32_t>(motion.nodes.size());
  motion.nodes.emplace_back();
  motion.nodes.back().parent = lower;
  motion.nodes.back().translation = {0, 1, 0};
  glm::dmat4 upper_from_mesh(1);
  upper_from_mesh[3].y = -1;
  motion.skins.push_back({{lower, upper}, {glm::dmat4(1), upper_from_mesh}});
  Rig& rig = motion.rigs.back();
  rig.skin = 0;
  rig.joints_per_vertex = 2;
  for (const glm::dvec3& p : rig.base) {
    for (const std::uint32_t joint : {0u, 1u}) rig.joints.push_back(joint);
    for (const double weight : {1 - p.y / 2, p.y / 2}) rig.weights.push_back(weight);
  }
  const double half_turn = std::sqrt(0.5);
  add_track(motion, upper, Property::rotation, {{0, {0, 0, 0, 1}}, {2, {0, 0, half_turn, half_turn}}, {4, {0, 0, 0, 1}}});
}

/// Two triangles at one edge. Their target puts one tip on the edge, and the other on one of its ends.
void add_pair(Scene& scene, Motion& motion) {
  Mesh pair;
  pair.name = "pair";
  pair.positions = {{-0.75f, 0, 0}, {0.75f, 0, 0}, {0, 0.5f, 1}, {0, -0.5f, -1}};
  pair.triangles = {{0, 1, 2}, {1, 0, 3}};
  finish(pair);
  const std::uint32_t node = add_placed(scene, motion, std::move(pair), {2, 2, -2});
  motion.nodes[node].weights = {0.0};
  motion.rigs.back().targets = {{0, 0, 0}, {0, 0, 0}, {0, -0.5, -1}, {0.75, 0.5, 1}};
  add_track(motion, node, Property::weights, {{0, {0}}, {1.75, {1}}, {2.25, {1}}, {3.5, {-0.5}}, {4, {0}}});
}

Scene over_ground(const std::string& name, Mesh ground) {
  Scene scene;
  scene.name = name;
  scene.meshes.push_back(std::move(ground));
  scene.lights = {{.name = "point", .kind = PointLight{light_place}},
                  {.name = "sun", .kind = DirectionalLight{{-0.25f, -1, -0.125f}}}};
  scene.views = {{.name = "view", .eye = {1, 6, 8}, .target = {0, 0, 0}}};
  return scene;
}

std::shared_ptr<Motion> one_animation() {
  auto motion = std::make_shared<Motion>();
  motion->animations = {{"move", {}}};
  return motion;
}

}  // namespace

Scene moving_things(bool has_sheets) {
  Scene scene = over_ground(has_sheets ? "moving_things" : "moving_boxes", tessellate(ground_plane(6), 3, "ground"));
  scene.meshes.push_back(tessellate(Box{.min = {1, 0.125f, 0.5f}, .max = {2.25f, 1.5f, 1.25f}}, default_segments, "block"));
  const std::shared_ptr<Motion> motion = one_animation();
  add_boxes(scene, *motion);
  if (has_sheets) {
    add_strip(scene, *motion);
    add_pair(scene, *motion);
  }
  scene.motion = motion;
  return scene;
}

Scene moving_ground() {
  Mesh ground = tessellate(ground_plane(6), 3, "ground");
  ground.casts = false;
  const std::shared_ptr<Motion> motion = one_animation();
  Scene scene = over_ground("moving_ground", tessellate(Sphere{{0.25f, 2, 0}, 1}, 16, "ball"));
  const std::uint32_t node = add_placed(scene, *motion, std::move(ground), {0, 0, 0});
  add_track(*motion, node, Property::translation, {{0, {0, 0, 0}}, {2, {0.5, -1, 0}}, {3, {0, 0.5, 0.25}}, {4, {0, 0, 0}}});
  scene.motion = motion;
  return scene;
}

MovingWorld::MovingWorld(Scene the_scene, Truth the_truth, int part)
    : scene_(std::move(the_scene)), truth_(the_truth), part_(part), posed_(scene_) {
  go_to(0);
}

RowPose MovingWorld::row_pose() const {
  return {.animation = scene_.motion->animations[0].name,
          .seconds = frame_ / frame_rate,
          .start = 0,
          .frame_rate = frame_rate,
          .frames = frame_count};
}

void MovingWorld::go_to(int frame) {
  frame_ = frame;
  posed_.go_to(row_pose());
}

const GBuffer& MovingWorld::gbuffer() {
  const auto known = gbuffers_.find(frame_);
  if (known != gbuffers_.end()) return known->second;
  return gbuffers_.emplace(frame_, gbuffer(scene_.views[0])).first->second;
}

GBuffer MovingWorld::gbuffer(const View& view) const {
  const RayScene seen(scene_, truth_, RayScene::Which::seen);
  return make_gbuffer(scene_, seen, view, 48 / part_, 27 / part_, truth_);
}

World::Truthful MovingWorld::reference(const Light& light, LightShareKind estimates) {
  if (!frames_) {
    posed_.go_to(std::nullopt);
    frames_.emplace(frames_of(scene_));
    posed_.go_to(row_pose());
  }
  const GBuffer& seen = gbuffer();
  return truthful(
      frames_->reference({seen.view, seen.width, seen.height, truth_, WantedPose{row_pose(), posed_.hash()}}, light), light,
      estimates);
}

std::vector<bool> MovingWorld::tested(const Light& light) {
  std::vector<bool> result;
  for (const PixelClass c : reference(light).classes) result.push_back(c == PixelClass::T);
  return result;
}

void Equality::expect(const std::vector<float>& a, const std::vector<float>& b, const std::string& when) const {
  const double allowed = trial_.entry().about.update_error;
  const GBuffer& gbuffer = world_.gbuffer();
  if (allowed == 0 || a.size() != b.size()) return trial_.expect_same(a, b, when, &gbuffer);
  const std::vector<bool> tested = world_.tested(light_);
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!tested[i]) continue;
    sum += std::abs(double(a[i]) - b[i]);
    ++count;
  }
  trial_.expect(sum <= allowed * static_cast<double>(count),
                fmt::format("{}: the masks differ by {} in the mean over {} tested pixels, more than {}", when,
                            sum / static_cast<double>(count), count, allowed));
}

SupportedWorld supported_world(const Trial& trial) {
  SupportedWorld found;
  for (Scene& scene : std::vector{moving_things(true), moving_things(false), moving_ground()}) {
    found.world = std::make_unique<MovingWorld>(std::move(scene), trial.entry().about.sees, is_sanitized ? 2 : 1);
    found.lights = trial.supported_lights(found.world->scene());
    if (!found.lights.empty()) break;
  }
  return found;
}

Changes no_changes(const Scene& scene) {
  Changes changes;
  for (const Mesh& mesh : scene.meshes) {
    MeshChange& change = changes.meshes.emplace_back();
    change.before.add(mesh.positions);
    change.after = change.before;
  }
  return changes;
}

}  // namespace gnomon::conformance
