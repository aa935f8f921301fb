#include "measure/scene/toml_motion.h"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <set>
#include <utility>

#include "measure/scene/motion.h"
#include "measure/scene/pose.h"

namespace gnomon {
namespace {

namespace fs = std::filesystem;

/// What a path moves. It is read before the other keys, for it decides which of them are allowed.
std::string moves_of(const toml::table& toml, const fs::path& file) {
  const Table table(toml, file, "path");
  const std::string moves = table.text("moves");
  if (moves != "camera" && moves != "light" && moves != "mesh")
    table.refuse("moves", '\'' + moves + '\'', "camera, light or mesh");
  return moves;
}

/// A [[path]] that moves meshes, as it is read. `offsets` and `turns` have one item for each of the times, or none at all.
struct MeshPath {
  std::string name, where;  ///< `where` is "FILE:LINE"
  std::vector<std::uint32_t> meshes;
  Track::Interpolation interpolation = Track::Interpolation::linear;
  std::vector<double> times;
  std::vector<glm::dvec3> offsets;
  std::vector<glm::dvec4> turns;  ///< unit quaternions x, y, z, w
  glm::dvec3 about{0};
};

std::string read_name(const Table& table, const Scene& scene) {
  const std::string name = table.name("name", std::vector<Path>{}, "mesh");
  if (find_named(scene.paths, name)) table.refuse("name", '\'' + name + '\'', "unique: a path of camera or light has it");
  if (scene.motion && find_named(scene.motion->animations, name))
    table.refuse("name", '\'' + name + '\'', "unique: an animation of a mesh file or of the scene to start from has it");
  return name;
}

const std::vector<std::uint32_t>* meshes_of_name(const Table& table, const MeshNames& names, const std::string& name) {
  try {
    return names.find(name);
  } catch (const Error& error) {
    throw Error("{} ({})", error.what(), table.where("mesh"));
  }
}

std::vector<std::uint32_t> named_meshes(const Table& table, const MeshNames& names) {
  std::vector<std::uint32_t> meshes;
  std::set<std::string> seen;
  for (const std::string& name : table.texts("mesh")) {
    if (!seen.insert(name).second) table.refuse("mesh", '\'' + name + "' twice", "a list of different names");
    const std::vector<std::uint32_t>* const found = meshes_of_name(table, names, name);
    const std::vector<std::string> all = found ? std::vector<std::string>() : names.all();
    if (!found && all.empty())
      table.refuse("mesh", '\'' + name + '\'', "the name of a mesh: no [[mesh]] and no [[shape]] of this file has a name");
    if (!found)
      table.refuse(
          "mesh", '\'' + name + '\'',
          fmt::format("the name of a mesh; did you mean {}? There are: {}", nearest_word(name, all), joined(all, ", ")));
    meshes.insert(meshes.end(), found->begin(), found->end());
  }
  return meshes;
}

Track::Interpolation read_interpolation(const Table& table) {
  if (!table.has("interpolation")) return Track::Interpolation::linear;
  const std::string word = table.text("interpolation");
  if (word == "step") return Track::Interpolation::step;
  if (word == "linear") return Track::Interpolation::linear;
  if (word == "cubic") return Track::Interpolation::cubic;
  table.refuse("interpolation", '\'' + word + '\'', "step, linear or cubic");
}

std::vector<double> key_times(const Table& table, std::size_t count) {
  const char* const key = table.has("times") ? "times" : "duration";
  std::vector<double> times;
  if (table.has("times")) {
    if (table.has("duration")) table.refuse("duration", table.number("duration"), "allowed beside times");
    times = table.numbers("times");
    if (times.size() != count)
      table.refuse(key, fmt::format("a list of {}", times.size()), fmt::format("{} numbers, one for each key", count));
  } else {
    const double duration = table.number("duration", 1), least = 2e-6 * static_cast<double>(count - 1);
    if (!(duration >= least)) table.refuse("duration", duration, fmt::format("{:g} s or more, for {} keys", least, count));
    for (std::size_t k = 0; k < count; ++k) times.push_back(duration * static_cast<double>(k) / static_cast<double>(count - 1));
  }
  constexpr double least_step = 1e-6;  // seconds; the tangents of cubic keys are quotients by it
  for (std::size_t k = 0; k < count; ++k)
    if (times[k] < 0 || (k > 0 && !(times[k] - times[k - 1] >= least_step)))
      table.refuse(key, fmt::format("{} s at key {}", times[k], k), "0 s or more and 1e-6 s or more after the key before");
  return times;
}

/// The unit quaternion of turns about x, then y, then z, as those of a Placement. Half turns are exact.
glm::dvec4 quaternion(const glm::dvec3& degrees) {
  glm::dquat all(1, 0, 0, 0);
  for (int axis = 0; axis < 3; ++axis) {
    const double half = glm::radians(std::remainder(degrees[axis], 720.0)) / 2;
    const bool is_exact = std::remainder(degrees[axis], 180.0) == 0;
    const double c = is_exact ? std::round(std::cos(half)) : std::cos(half);
    const double s = is_exact ? std::round(std::sin(half)) : std::sin(half);
    glm::dvec3 direction(0);
    direction[axis] = s;
    all = glm::dquat(c, direction.x, direction.y, direction.z) * all;
  }
  all = glm::normalize(all);
  return {all.x, all.y, all.z, all.w};
}

/// Each quaternion is on the side of the one before, so that cubic curves through their numbers do not pass 0.
std::vector<glm::dvec4> quaternions(const std::vector<glm::dvec3>& degrees) {
  std::vector<glm::dvec4> turns;
  for (const glm::dvec3& each : degrees) {
    const glm::dvec4 turn = quaternion(each);
    turns.push_back(!turns.empty() && glm::dot(turns.back(), turn) < 0 ? -turn : turn);
  }
  return turns;
}

/// Rotations take the shorter way between two keys, so that half a turn has no side and a whole one is none at all.
void check_turns(const Table& table, const std::vector<glm::dvec3>& degrees) {
  for (std::size_t k = 1; k < degrees.size(); ++k)
    for (int axis = 0; axis < 3; ++axis)
      if (const double step = degrees[k][axis] - degrees[k - 1][axis]; !(std::abs(step) < 180))
        table.refuse("rotate_degrees",
                     fmt::format("{} after {} about {} at key {}", degrees[k][axis], degrees[k - 1][axis], "xyz"[axis], k),
                     "less than 180 degrees from the key before: more keys turn farther");
}

MeshPath read_mesh_path(const toml::table& toml, const fs::path& file, const MeshNames& names, const Scene& scene) {
  const Table table(toml, file, "path",
                    {"name", "moves", "mesh", "times", "duration", "positions", "rotate_degrees", "about", "interpolation"});
  MeshPath path;
  path.name = read_name(table, scene);
  path.where = table.where();
  path.meshes = named_meshes(table, names);
  path.interpolation = read_interpolation(table);
  if (table.has("positions")) path.offsets = table.vectors("positions", 0, 2);
  for (const glm::dvec3& offset : path.offsets)
    if (!is_sound(offset)) table.refuse("positions", extent(offset), fmt::format("within {}", coordinate_range));
  std::size_t count = path.offsets.size();
  if (table.has("rotate_degrees")) {
    const std::vector<glm::dvec3> degrees = table.vectors("rotate_degrees", count, 2);
    if (path.interpolation != Track::Interpolation::step) check_turns(table, degrees);
    path.turns = quaternions(degrees);
    path.about = table.vector("about", glm::dvec3(0));
    if (!is_sound(path.about)) table.refuse("about", extent(path.about), fmt::format("within {}", coordinate_range));
    count = degrees.size();
  } else if (table.has("about")) {
    table.refuse("about", "a point", "allowed without rotate_degrees");
  }
  if (count == 0)
    throw Error("path '{}' has neither positions nor rotate_degrees: it moves nothing ({})", path.name, path.where);
  path.times = key_times(table, count);
  return path;
}

/// The values of a track through these keys. Cubic keys have the tangents of Catmull and Rom: the slope between the two keys
/// beside a key, and 0 at both ends.
template <class Vector>
std::vector<double> track_values(const MeshPath& path, const std::vector<Vector>& keys) {
  std::vector<double> values;
  const auto add = [&](const Vector& v) {
    for (int c = 0; c < Vector::length(); ++c) values.push_back(v[c]);
  };
  const bool is_cubic = path.interpolation == Track::Interpolation::cubic;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const bool is_inside = k > 0 && k + 1 < keys.size();
    const Vector slope = is_inside ? (keys[k + 1] - keys[k - 1]) / (path.times[k + 1] - path.times[k - 1]) : Vector(0);
    if (is_cubic) add(slope);
    add(keys[k]);
    if (is_cubic) add(slope);
  }
  return values;
}

/// Adds animations, nodes and rigs of a description's paths to the motion of its scene.
class PathsToMotion {
 public:
  explicit PathsToMotion(const Scene& scene)
      : scene_(scene), motion_(scene.motion ? *scene.motion : Motion{}), foreign_rig_count_(motion_.rigs.size()) {
    for (std::uint32_t r = 0; r < motion_.rigs.size(); ++r) rig_of_.emplace(motion_.rigs[r].mesh, r);
  }

  void add(const MeshPath& path) {
    const auto animation = std::ranges::find(motion_.animations, path.name, &Animation::name);
    const auto number = static_cast<std::size_t>(animation - motion_.animations.begin());
    if (animation == motion_.animations.end()) motion_.animations.push_back({path.name, {}});
    // Meshes with the same nodes so far share the nodes of this path, too.
    std::map<std::uint32_t, std::uint32_t> below;
    for (const std::uint32_t mesh : path.meshes) {
      if (!moved_.emplace(number, mesh).second)
        throw Error("path '{}' moves mesh '{}' twice; one path of an animation may ({})", path.name, scene_.meshes[mesh].name,
                    path.where);
      Rig& rig = own_rig(mesh, path);
      const auto found = below.find(rig.node);
      const std::uint32_t node = found != below.end() ? found->second : add_nodes(path, rig.node, motion_.animations[number]);
      below.emplace(rig.node, node);
      rig.node = node;
    }
  }

  std::shared_ptr<const Motion> result() { return std::make_shared<const Motion>(std::move(motion_)); }

 private:
  /// A new one has no node yet.
  Rig& own_rig(std::uint32_t mesh, const MeshPath& path) {
    const auto [found, is_new] = rig_of_.try_emplace(mesh, static_cast<std::uint32_t>(motion_.rigs.size()));
    if (!is_new && found->second < foreign_rig_count_)
      throw Error("path '{}' cannot move mesh '{}': its file, or the scene to start from, moves it already ({})", path.name,
                  scene_.meshes[mesh].name, path.where);
    if (is_new) {
      Rig rig;
      rig.mesh = mesh;
      rig.node = MotionNode::none;
      for (const glm::vec3& p : scene_.meshes[mesh].positions) rig.base.emplace_back(p);
      motion_.rigs.push_back(std::move(rig));
    }
    return motion_.rigs[found->second];
  }

  /// Adds what a path moves, below `parent`, and its tracks. Returns the node that places meshes. A mesh turns about a point by
  /// two nodes: the outer one is at the point, turns and moves, the inner one goes back by the point. At rest their product is
  /// the identity to the bit.
  std::uint32_t add_nodes(const MeshPath& path, std::uint32_t parent, Animation& animation) {
    const auto outer = static_cast<std::uint32_t>(motion_.nodes.size());
    const auto add_track = [&](Track::Property property, std::vector<double> values) {
      animation.tracks.push_back({outer, property, path.interpolation, path.times, std::move(values)});
    };
    MotionNode node;
    node.parent = parent;
    node.translation = path.about;
    motion_.nodes.push_back(node);
    if (!path.offsets.empty()) {
      std::vector<glm::dvec3> places;
      for (const glm::dvec3& offset : path.offsets) places.push_back(path.about + offset);
      add_track(Track::Property::translation, track_values(path, places));
    }
    if (!path.turns.empty()) add_track(Track::Property::rotation, track_values(path, path.turns));
    if (path.about == glm::dvec3(0)) return outer;
    MotionNode inner;
    inner.parent = outer;
    inner.translation = -path.about;
    motion_.nodes.push_back(inner);
    return outer + 1;
  }

  const Scene& scene_;
  Motion motion_;
  std::size_t foreign_rig_count_;
  std::map<std::uint32_t, std::uint32_t> rig_of_;          ///< by mesh
  std::set<std::pair<std::size_t, std::uint32_t>> moved_;  ///< animations and meshes
};

}  // namespace

MeshNames::MeshNames(const std::vector<Mesh>& base) {
  for (std::uint32_t m = 0; m < base.size(); ++m) named_[base[m].name].meshes.push_back(m);
}

void MeshNames::add(const std::string& name, std::size_t first, std::size_t end) {
  const auto [found, is_new] = named_.try_emplace(name);
  if (!is_new) ++found->second.giver_count;
  for (std::size_t m = first; m < end; ++m) found->second.meshes.push_back(static_cast<std::uint32_t>(m));
}

const std::vector<std::uint32_t>* MeshNames::find(const std::string& name) const {
  const auto found = named_.find(name);
  if (found == named_.end()) return nullptr;
  if (const int givers = found->second.giver_count; givers > 1)
    throw Error("mesh name '{}' is given {} times: a path moves what has a name of its own", name, givers);
  return &found->second.meshes;
}

std::vector<std::string> MeshNames::all() const {
  std::vector<std::string> names;
  for (const auto& [name, named] : named_) names.push_back(name);
  return names;
}

void read_path(const toml::table& toml, const fs::path& file, Scene& scene) {
  const std::string moves = moves_of(toml, file);
  if (moves == "mesh") return;
  const Table table(toml, file, "path", {"name", "moves", "positions", "frames", "steps"});
  const Path::Moves what = moves == "camera" ? Path::Moves::camera : Path::Moves::light;
  Path path{table.name("name", scene.paths, moves), what, {}};
  if (std::ranges::find(built_in_paths, path.name) != std::end(built_in_paths))
    table.refuse("name", "'" + path.name + "'", "another name: every scene has a path of this one");
  for (const glm::dvec3& position : table.vectors("positions", 0, 2)) path.positions.emplace_back(position);
  if (!table.has("frames")) table.refuse("frames", "(nothing)", "a whole number of 2 .. 100000");
  path.frame_count = table.integer("frames", 0, 2, 100'000);
  if (table.flag("steps", false)) {
    if (std::size(path.positions) > static_cast<std::size_t>(path.frame_count))
      table.refuse("positions", fmt::format("{} vectors", std::size(path.positions)),
                   fmt::format("2 .. {} vectors: with steps a position is that of a frame, and there are {} frames",
                               path.frame_count, path.frame_count));
    path.positions = stepped(std::move(path.positions), path.frame_count);
  }
  scene.paths.push_back(std::move(path));
}

void read_mesh_paths(const std::vector<const toml::table*>& tables, const fs::path& file, const MeshNames& names,
                     Scene& scene) {
  std::vector<MeshPath> paths;
  for (const toml::table* table : tables)
    if (moves_of(*table, file) == "mesh") paths.push_back(read_mesh_path(*table, file, names, scene));
  if (!paths.empty()) {
    PathsToMotion motion(scene);
    for (const MeshPath& path : paths) motion.add(path);
    scene.motion = motion.result();
  }
  if (!scene.motion) return;
  for (const Path& path : scene.paths)
    if (find_named(scene.motion->animations, path.name))
      throw Error("path '{}' has the name of an animation: names of paths and animations are unique ({})", path.name,
                  file.string());
}

void read_time(const Table& top, bool is_base, Scene& scene) {
  const std::string animation = top.has("animation") ? top.text("animation") : "";
  if (top.has("animation") && animation.empty()) top.refuse("animation", "''", "the name of an animation");
  if (!top.has("time")) {
    if (top.has("animation")) top.refuse("animation", '\'' + animation + '\'', "allowed without time");
    return;
  }
  const double seconds = top.number("time");
  if (seconds < 0) top.refuse("time", seconds, "0 s or more");
  if (!is_base) add_framing_at_rest(scene);
  try {
    freeze(scene, {animation, seconds});
  } catch (const Error& error) {
    throw Error("{} ({})", error.what(), top.where(top.has("animation") ? "animation" : "time"));
  }
}

}  // namespace gnomon
