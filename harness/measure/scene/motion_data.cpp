#include "measure/scene/motion_data.h"

#include <gnomon/error.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <iterator>
#include <map>
#include <set>
#include <span>

#include "measure/counted.h"
#include "measure/printable.h"
#include "measure/scene/base_scene.h"
#include "measure/scene/import_masks.h"
#include "measure/scene/load.h"
#include "measure/scene/motion.h"
#include "measure/scene/names.h"
#include "measure/scene/pose.h"

namespace gnomon {
namespace {

bool are_finite(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); });
}
bool are_finite(const glm::dvec3& v) { return are_finite(std::span(&v.x, 3)); }
bool are_finite(const glm::dmat4& m) { return are_finite(std::span(glm::value_ptr(m), 16)); }

/// Whether it is a unit quaternion; readers and scenes normalize in double, far closer than this.
bool is_turn(std::span<const double> q) {
  constexpr double rounding = 1e-6;
  double square = 0;
  for (const double x : q) square += x * x;
  return std::abs(std::sqrt(square) - 1) <= rounding;
}

std::string words_of(std::span<const double> q) { return fmt::format("({}, {}, {}, {})", q[0], q[1], q[2], q[3]); }

void check_node(const Motion& motion, std::size_t n, const std::string& where) {
  const MotionNode& node = motion.nodes[n];
  if (node.parent != MotionNode::none && node.parent >= n)
    throw Error("{}: node {}: parent = {} is not a smaller number", where, n, node.parent);
  if (!are_finite(node.weights)) throw Error("{}: node {}: its weights are not finite", where, n);
  if (node.matrix && !are_finite(*node.matrix)) throw Error("{}: node {}: its matrix is not finite", where, n);
  if (node.matrix) return;
  if (!are_finite(node.translation) || !are_finite(node.scale))
    throw Error("{}: node {}: its translation or its scale is not finite", where, n);
  if (const std::span<const double> turn(&node.rotation.x, 4); !is_turn(turn))
    throw Error("{}: node {}: rotation = {} is not a quaternion of length 1", where, n, words_of(turn));
}

void check_skin(const Motion& motion, const Skin& skin, const std::string& where) {
  if (skin.joints.empty()) throw Error("{} has no joints", where);
  if (skin.inverse_bind.size() != skin.joints.size())
    throw Error("{} has {} joints and {} inverse bind matrices", where, skin.joints.size(), skin.inverse_bind.size());
  for (std::size_t j = 0; j < skin.joints.size(); ++j) {
    if (skin.joints[j] >= motion.nodes.size())
      throw Error("{}: joint {} is node {} of {}", where, j, skin.joints[j], motion.nodes.size());
    if (!are_finite(skin.inverse_bind[j])) throw Error("{}: the inverse bind matrix of joint {} is not finite", where, j);
  }
}

/// Numbers of one value of a track, as its property and its node need them. Throws Error where its node has no such property.
std::size_t needed_width(const Motion& motion, const Track& track, const std::string& where) {
  if (track.node >= motion.nodes.size()) throw Error("{} moves node {} of {}", where, track.node, motion.nodes.size());
  if (track.property > Track::Property::weights || track.interpolation > Track::Interpolation::cubic)
    throw Error("{} has an unknown property {} or an unknown interpolation {}", where, static_cast<int>(track.property),
                static_cast<int>(track.interpolation));
  const MotionNode& node = motion.nodes[track.node];
  if (track.property == Track::Property::weights) {
    if (node.weights.empty()) throw Error("{} moves weights of node {}, which has none", where, track.node);
    return node.weights.size();
  }
  if (node.matrix) throw Error("{} moves node {}, which has a matrix", where, track.node);
  return track.property == Track::Property::rotation ? 4 : 3;
}

void check_track(const Motion& motion, const Track& track, const std::string& where) {
  const std::size_t width = needed_width(motion, track, where);
  const bool is_cubic = track.interpolation == Track::Interpolation::cubic;
  const std::size_t numbers = is_cubic ? 3 * width : width;  // of a key
  if (track.times.empty()) throw Error("{} has no keys", where);
  if (track.values.size() != track.times.size() * numbers)
    throw Error("{} has {} keys of {} numbers, and {} numbers in all", where, track.times.size(), numbers, track.values.size());
  for (std::size_t k = 0; k < track.times.size(); ++k) {
    const double time = track.times[k];
    if (!(time >= 0 && std::isfinite(time))) throw Error("{}, key {}: time = {} s is not finite and 0 or more", where, k, time);
    if (k > 0 && time < track.times[k - 1])
      throw Error("{}, key {}: time = {} s is before {} s, the time of the key before it", where, k, time, track.times[k - 1]);
    const auto key = std::span(track.values).subspan(k * numbers, numbers);
    if (const auto odd = std::ranges::find_if(key, [](double x) { return !std::isfinite(x); }); odd != key.end())
      throw Error("{}, key {}: value {} is not finite", where, k, *odd);
    if (track.property != Track::Property::rotation) continue;
    if (const auto turn = key.subspan(is_cubic ? width : 0, width); !is_turn(turn))
      throw Error("{}, key {}: rotation = {} is not a quaternion of length 1", where, k, words_of(turn));
  }
}

void check_animation(const Motion& motion, const Animation& animation, const std::string& where) {
  if (animation.tracks.empty()) throw Error("{} has no tracks", where);
  std::set<std::pair<std::uint32_t, Track::Property>> moved;
  for (std::size_t t = 0; t < animation.tracks.size(); ++t) {
    const Track& track = animation.tracks[t];
    const std::string track_where = fmt::format("{}, track {}", where, t);
    check_track(motion, track, track_where);
    if (!moved.emplace(track.node, track.property).second)
      throw Error("{} moves what another track of node {} moves", track_where, track.node);
  }
}

/// The animations under names that are plain, unique, and none of `there`.
void name_apart(std::vector<Animation>& animations, const std::vector<Animation>& there) {
  constexpr std::size_t longest = 80;  // with a number behind it, too, it is a plain name
  std::set<std::string> taken(std::begin(built_in_paths), std::end(built_in_paths));
  for (const Animation& one : there) taken.insert(one.name);
  std::map<std::string, int> next;
  for (Animation& animation : animations) {
    const std::string name = plain_name(animation.name.substr(0, longest), "animation");
    int& number = next.try_emplace(name, 2).first->second;
    animation.name = name;
    while (!taken.insert(animation.name).second) animation.name = fmt::format("{}_{}", name, number++);
  }
}

bool repeats_a_vertex(const glm::uvec3& t) { return t.x == t.y || t.y == t.z || t.z == t.x; }

/// See finish_meshes.
void finish_moving(const Rig& rig, Mesh& mesh) {
  std::vector<glm::vec3> base;
  base.reserve(rig.base.size());
  for (const glm::dvec3& p : rig.base) base.emplace_back(p);
  const bool may_spread = rig.skin != Rig::no_skin || !rig.targets.empty();
  const auto is_flat = [](const std::vector<glm::vec3>& positions, const glm::uvec3& t) {
    return is_degenerate(positions[t.x], positions[t.y], positions[t.z]);
  };
  const std::size_t dropped = std::erase_if(mesh.triangles, [&](const glm::uvec3& t) {
    return repeats_a_vertex(t) || (!may_spread && is_flat(base, t) && is_flat(mesh.positions, t));
  });
  // Where two corners have one base position, the other two edges of the triangle are one edge of its neighbors.
  const std::vector<std::uint32_t> first = weld(base);
  std::vector<glm::uvec3> measured;
  measured.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles)
    if (!repeats_a_vertex({first[t.x], first[t.y], first[t.z]})) measured.push_back(t);
  mesh.facts = measure_facts(base, measured);
  mesh.facts.degenerate_count = dropped;
}

/// Of each mesh the rig by which some animation moves it; null: it stands still in all of them.
std::vector<const Rig*> moving_rigs(const Scene& scene) {
  std::vector<const Rig*> rigs(scene.meshes.size());
  if (!scene.motion) return rigs;
  for (const Animation& animation : scene.motion->animations) {
    const std::vector<bool> moved = moved_rigs(*scene.motion, animation);
    for (std::size_t r = 0; r < moved.size(); ++r)
      if (const Rig& rig = scene.motion->rigs[r]; moved[r]) rigs[rig.mesh] = &rig;
  }
  return rigs;
}

}  // namespace

void check_motion(const Motion& motion, const std::string& where) {
  for (std::size_t n = 0; n < motion.nodes.size(); ++n) check_node(motion, n, where);
  for (std::size_t s = 0; s < motion.skins.size(); ++s)
    check_skin(motion, motion.skins[s], fmt::format("{}: skin {}", where, s));
  for (std::size_t a = 0; a < motion.animations.size(); ++a)
    check_animation(motion, motion.animations[a],
                    fmt::format("{}: animation {} '{}'", where, a, printable(motion.animations[a].name, true)));
}

void check_rig(const Motion& motion, const Rig& rig, std::size_t vertex_count, const std::string& where) {
  const bool has_skin = rig.skin != Rig::no_skin;
  if (rig.node >= motion.nodes.size()) throw Error("{}: is at node {} of {}", where, rig.node, motion.nodes.size());
  if (has_skin && rig.skin >= motion.skins.size()) throw Error("{}: has skin {} of {}", where, rig.skin, motion.skins.size());
  if (rig.base.size() != vertex_count)
    throw Error("{}: has {} vertices and {} positions from which they move", where, vertex_count, rig.base.size());
  const std::size_t weight_count = motion.nodes[rig.node].weights.size();
  if (!rig.targets.empty() && rig.targets.size() != weight_count * vertex_count)
    throw Error("{}: has {} vertices, {} weights of morph targets and {} moves by them", where, vertex_count, weight_count,
                rig.targets.size());
  if (has_skin != (rig.joints_per_vertex > 0) || rig.joints.size() != rig.joints_per_vertex * vertex_count ||
      rig.weights.size() != rig.joints.size())
    throw Error("{}: has {} vertices, {} a skin, {} joints for each, {} joints and {} weights of these in all", where,
                vertex_count, has_skin ? "with" : "without", rig.joints_per_vertex, rig.joints.size(), rig.weights.size());
  for (std::size_t v = 0; v < vertex_count; ++v)
    if (const glm::dvec3& p = rig.base[v]; !is_sound(p))
      throw Error("{}, vertex {}: base position = ({}, {}, {}) is outside {}", where, v, p.x, p.y, p.z, coordinate_range);
  for (std::size_t i = 0; i < rig.targets.size(); ++i)
    if (const glm::dvec3& d = rig.targets[i]; !are_finite(d))
      throw Error("{}, vertex {}: morph target {} moves it by ({}, {}, {}), which is not finite", where, i % vertex_count,
                  i / vertex_count, d.x, d.y, d.z);
  for (std::size_t i = 0; i < rig.joints.size(); ++i) {
    const std::size_t v = i / rig.joints_per_vertex;
    if (!std::isfinite(rig.weights[i]))
      throw Error("{}, vertex {}: the weight {} of a joint is not finite", where, v, rig.weights[i]);
    if (const std::size_t count = motion.skins[rig.skin].joints.size(); rig.weights[i] != 0 && rig.joints[i] >= count)
      throw Error("{}, vertex {}: joint {} is outside 0 .. {}", where, v, rig.joints[i], count - 1);
  }
}

void check_motion(const Scene& scene, const std::string& where) {
  if (!scene.motion) return;
  const Motion& motion = *scene.motion;
  check_motion(motion, where);
  std::set<std::string_view> names;
  for (const Animation& animation : motion.animations) {
    if (!is_plain_name(animation.name))
      throw Error("{}: animation: name '{}' is not of a..z, 0..9 and _, at most 100 of them", where,
                  printable(animation.name, true));
    if (std::ranges::find(built_in_paths, animation.name) != std::end(built_in_paths))
      throw Error("{}: animation: name '{}' is that of a path which every scene has", where, animation.name);
    if (!names.insert(animation.name).second) throw Error("{}: animation: name '{}' is given twice", where, animation.name);
  }
  if (motion.animations.empty()) throw Error("{}: has motion and no animation", where);
  for (const Path& path : scene.paths)
    if (names.contains(path.name))
      throw Error("{0}: path '{1}' and animation '{1}' have one name; names of paths and animations are unique", where,
                  path.name);
  std::vector<bool> has_rig(scene.meshes.size());
  for (const Rig& rig : motion.rigs) {
    if (rig.mesh >= scene.meshes.size()) throw Error("{}: moves mesh {} of {}", where, rig.mesh, scene.meshes.size());
    const Mesh& mesh = scene.meshes[rig.mesh];
    const std::string mesh_where = fmt::format("{}: mesh '{}'", where, mesh.name);
    if (has_rig[rig.mesh]) throw Error("{}: moves in two ways", mesh_where);
    has_rig[rig.mesh] = true;
    check_rig(motion, rig, mesh.positions.size(), mesh_where);
    const auto& [scale, turn, offset] = rig.placement;
    if (!are_finite(scale) || !are_finite(turn) || !are_finite(offset))
      throw Error("{}: its placement is not finite", mesh_where);
  }
}

void append_motion(Motion more, Scene& scene) {
  const auto all = scene.motion ? std::make_shared<Motion>(*scene.motion) : std::make_shared<Motion>();
  const auto node_count = static_cast<std::uint32_t>(all->nodes.size());
  const auto skin_count = static_cast<std::uint32_t>(all->skins.size());
  for (MotionNode& node : more.nodes)
    if (node.parent != MotionNode::none) node.parent += node_count;
  for (Animation& animation : more.animations)
    for (Track& track : animation.tracks) track.node += node_count;
  for (Skin& skin : more.skins)
    for (std::uint32_t& joint : skin.joints) joint += node_count;
  for (Rig& rig : more.rigs) {
    rig.node += node_count;
    if (rig.skin != Rig::no_skin) rig.skin += skin_count;
  }
  name_apart(more.animations, all->animations);
  const auto append = [](auto& to, auto& from) { std::ranges::move(from, std::back_inserter(to)); };
  append(all->nodes, more.nodes);
  append(all->animations, more.animations);
  append(all->skins, more.skins);
  append(all->rigs, more.rigs);
  scene.motion = all;
}

void merge_duplicates(Scene& scene) {
  std::size_t merged = 0;
  for (std::size_t r = 0; scene.motion && r < scene.motion->rigs.size(); ++r) {
    Mesh& mesh = scene.meshes[scene.motion->rigs[r].mesh];
    if (!mesh.alpha_mask && !mesh.transmission) continue;
    std::vector<std::uint32_t> welded = weld(mesh.positions);
    const std::vector<std::uint8_t> all(mesh.positions.size(), 1);
    if (mesh.needs_uv() && mesh.uv.size() == mesh.positions.size()) welded = importing::weld_places(welded, mesh.uv, all);
    std::vector<glm::uvec3> corners;
    for (const glm::uvec3& t : mesh.triangles) corners.emplace_back(welded[t.x], welded[t.y], welded[t.z]);
    const std::vector<bool> is_again = importing::find_duplicates(corners);
    std::size_t kept = 0;
    for (std::size_t t = 0; t < corners.size(); ++t)
      if (!is_again[t]) mesh.triangles[kept++] = mesh.triangles[t];
    merged += corners.size() - kept;
    mesh.triangles.resize(kept);
  }
  if (merged > 0)
    scene.notes.push_back(
        counted(merged, "triangle{s} of meshes that move {lies on another and is|lie on others and are} merged"));
}

void finish_meshes(Scene& scene) {
  const std::vector<const Rig*> rigs = moving_rigs(scene);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    rigs[m] ? finish_moving(*rigs[m], scene.meshes[m]) : finish(scene.meshes[m]);
}

bool has_geometry_at_rest(const Scene& scene) {
  return std::ranges::any_of(scene.meshes, [](const Mesh& mesh) {
    return std::ranges::any_of(mesh.triangles, [&](const glm::uvec3& t) {
      return !is_degenerate(mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]);
    });
  });
}

void drop_empty_meshes(Scene& scene) {
  const auto is_empty = [](const Mesh& mesh) { return mesh.triangles.empty(); };
  const bool has_empty = std::ranges::any_of(scene.meshes, is_empty);
  if (scene.motion && has_empty) {
    std::vector<std::uint32_t> numbers;  // of each mesh, afterwards
    std::uint32_t kept = 0;
    for (const Mesh& mesh : scene.meshes) numbers.push_back(is_empty(mesh) ? kept : kept++);
    const auto motion = std::make_shared<Motion>(*scene.motion);
    std::erase_if(motion->rigs, [&](const Rig& rig) { return is_empty(scene.meshes[rig.mesh]); });
    for (Rig& rig : motion->rigs) rig.mesh = numbers[rig.mesh];
    scene.motion = motion;
  }
  std::erase_if(scene.meshes, is_empty);
}

}  // namespace gnomon
