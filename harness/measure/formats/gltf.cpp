// glTF 2.0: the nodes of the default scene with their meshes, cameras and lights, as they are in the file.
// Source: Khronos, glTF 2.0 specification (ISO/IEC 12113:2022); KHR_lights_punctual, KHR_mesh_quantization,
// EXT_mesh_gpu_instancing.
#include <gnomon/light.h>

#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <numbers>
#include <optional>
#include <set>

#include "measure/formats/gltf_mesh.h"
#include "measure/formats/readers.h"

namespace gnomon::importing {
namespace {

glm::dmat4 moved(const glm::dvec3& translation, const glm::dvec4& rotation, const glm::dvec3& scale) {
  const glm::dmat3 turned = glm::mat3_cast(glm::dquat(rotation.w, rotation.x, rotation.y, rotation.z));
  glm::dmat4 matrix(1);
  for (int c = 0; c < 3; ++c) matrix[c] = glm::dvec4(turned[c] * scale[c], 0);
  matrix[3] = glm::dvec4(translation, 1);
  return matrix;
}

class SceneReader {
 public:
  explicit SceneReader(GltfFile& file) : file_(file), nodes_(file.count("nodes")), hidden_(nodes_.size()) {}

  MeshFile read(const ReadFile& read, bool with_uv) {
    read_tree();
    GltfMeshes meshes(file_, read, nodes_, with_uv, answer_);
    for (const std::size_t n : order_) {
      const Json& node = file_.item("nodes", n);
      const std::string where = fmt::format("node {}", n);
      if (hidden_[n])
        hidden_count_ += node.contains("mesh") || file_.extension_of(node, "KHR_lights_punctual");
      else if (const auto mesh = file_.index(node, where, "mesh"))
        meshes.add(n, *mesh, instances(node, n));
      if (const auto camera = file_.index(node, where, "camera")) add_camera(node, n, *camera);
      if (const Json* light = file_.extension_of(node, "KHR_lights_punctual"); light && !hidden_[n])
        if (const auto index = file_.index(*light, where, "light")) add_light(node, n, *index);
    }
    meshes.note();
    note();
    return std::move(answer_);
  }

 private:
  glm::dmat4 matrix_of(std::size_t n) const {
    const Json& node = file_.item("nodes", n);
    const std::string where = fmt::format("node {}", n);
    if (const std::vector<double> m = file_.numbers(node, where, "matrix", 16); !m.empty()) return glm::make_mat4(m.data());
    const std::vector<double> t = file_.numbers(node, where, "translation", 3), r = file_.numbers(node, where, "rotation", 4),
                              s = file_.numbers(node, where, "scale", 3);
    return moved(t.empty() ? glm::dvec3(0) : glm::dvec3(t[0], t[1], t[2]),
                 r.empty() ? glm::dvec4(0, 0, 0, 1) : turn_of(where, glm::dvec4(r[0], r[1], r[2], r[3])),
                 s.empty() ? glm::dvec3(1) : glm::dvec3(s[0], s[1], s[2]));
  }

  glm::dvec4 turn_of(const std::string& where, const glm::dvec4& rotation) const {
    if (!(glm::length(rotation) > 0)) throw Error("{}: {}: rotation = (0, 0, 0, 0) is none", file_.name(), where);
    return glm::normalize(rotation);
  }

  bool is_hidden(const Json& node) const {
    const Json* visibility = file_.extension_of(node, "KHR_node_visibility");
    return visibility && !flag_in(*visibility, "visible", true);
  }

  std::vector<std::size_t> children_of(const Json& owner, const std::string& where, const char* key) const {
    std::vector<std::size_t> children;
    for (const double child : file_.numbers(owner, where, key, 0)) {
      if (!(child >= 0 && child < static_cast<double>(nodes_.size()) && child == std::floor(child)))
        throw Error("{}: {}: {} names node {} of {}", file_.name(), where, key, child, nodes_.size());
      children.push_back(static_cast<std::size_t>(child));
    }
    return children;
  }

  /// Finds the place of every node, and the nodes of the default scene from its roots down, children in their order.
  void read_tree() {
    const std::size_t none = nodes_.size();
    std::vector<std::size_t> parents(nodes_.size(), none);
    std::vector<std::vector<std::size_t>> children(nodes_.size());
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      children[n] = children_of(file_.item("nodes", n), fmt::format("node {}", n), "children");
      for (const std::size_t child : children[n]) {
        if (parents[child] != none || child == n)
          throw Error("{}: node {} is below more than one node, or below itself", file_.name(), child);
        parents[child] = n;
      }
    }
    std::vector<std::size_t> roots;
    for (std::size_t n = 0; n < nodes_.size(); ++n)
      if (parents[n] == none) roots.push_back(n);
    std::size_t placed = 0;
    walk(roots, children, [&](std::size_t n) {
      const glm::dmat4 matrix = matrix_of(n);
      nodes_[n] = parents[n] == none ? matrix : nodes_[parents[n]] * matrix;
      hidden_[n] = (parents[n] != none && hidden_[parents[n]]) || is_hidden(file_.item("nodes", n));
      ++placed;
    });
    if (placed < nodes_.size()) throw Error("{}: {} nodes are below themselves", file_.name(), nodes_.size() - placed);

    if (file_.count("scenes") > 0) {
      const std::size_t scene = file_.index(file_.root(), "file", "scene").value_or(0);
      roots = children_of(file_.item("scenes", scene), fmt::format("scene {}", scene), "nodes");
    }
    std::vector<bool> seen(nodes_.size());
    walk(roots, children, [&](std::size_t n) {
      if (seen[n]) throw Error("{}: node {} stands twice in the scene", file_.name(), n);
      seen[n] = true;
      order_.push_back(n);
    });
    for (std::size_t n = 0; n < nodes_.size(); ++n)
      if (!seen[n] && file_.item("nodes", n).contains("mesh")) ++meshes_elsewhere_;
  }

  /// Parents before children, without recursion: a chain may be as long as the file allows.
  template <class Visit>
  static void walk(const std::vector<std::size_t>& roots, const std::vector<std::vector<std::size_t>>& children, Visit visit) {
    std::vector<std::size_t> open(roots.rbegin(), roots.rend());
    while (!open.empty()) {
      const std::size_t n = open.back();
      open.pop_back();
      visit(n);
      open.insert(open.end(), children[n].rbegin(), children[n].rend());
    }
  }

  /// The places of a node's mesh: more than one by EXT_mesh_gpu_instancing.
  std::vector<glm::dmat4> instances(const Json& node, std::size_t n) const {
    const Json* extension = file_.extension_of(node, "EXT_mesh_gpu_instancing");
    const Json* attributes = extension ? object_in(*extension, "attributes") : nullptr;
    if (!attributes) return {nodes_[n]};
    const std::string where = fmt::format("node {}, instances", n);
    const auto read = [&](const char* key, std::size_t width) {
      const auto accessor = file_.index(*attributes, where, key);
      return accessor ? file_.read(*accessor, width) : Numbers{};
    };
    const Numbers t = read("TRANSLATION", 3), r = read("ROTATION", 4), s = read("SCALE", 3);
    std::optional<std::size_t> given;  // the same in the accessors of all attributes
    for (const auto& [name, accessor] : attributes->items())
      if (const auto index = file_.index(*attributes, where, name.c_str()); index && !given)
        given = file_.index(file_.item("accessors", *index), where, "count");
    if (!given) return {nodes_[n]};
    const std::size_t count = *given;
    constexpr std::size_t most = 10'000'000;
    if (count > most) throw Error("{}: {}: {} of them; at most {} are read", file_.name(), where, count, most);
    for (const Numbers* numbers : {&t, &r, &s})
      if (!numbers->values.empty() && numbers->count != count)
        throw Error("{}: {} have accessors of {} and {} elements", file_.name(), where, count, numbers->count);
    std::vector<glm::dmat4> places;
    for (std::size_t i = 0; i < count; ++i)
      places.push_back(nodes_[n] * moved(t.count ? t.vector(i) : glm::dvec3(0),
                                         r.count ? turn_of(where, glm::dvec4(r.vector(i), r.at(i, 3))) : glm::dvec4(0, 0, 0, 1),
                                         s.count ? s.vector(i) : glm::dvec3(1)));
    return places;
  }

  /// Of the node, else of what it carries.
  std::string name_of(const Json& node, const Json& carried) const {
    const std::string name = file_.text(node, "name");
    return name.empty() ? file_.text(carried, "name") : name;
  }

  void add_camera(const Json& node, std::size_t n, std::size_t index) {
    const Json& camera = file_.item("cameras", index);
    const Json* perspective = object_in(camera, "perspective");
    const std::string where = fmt::format("camera {}", index);
    answer_.cameras.push_back({.name = name_of(node, camera),
                               .eye = glm::dvec3(nodes_[n][3]),
                               .forward = glm::dmat3(nodes_[n]) * glm::dvec3(0, 0, -1),
                               .up = glm::dmat3(nodes_[n]) * glm::dvec3(0, 1, 0),
                               .fov_y = perspective ? file_.number(*perspective, where, "yfov", 0) : 0});
    used_cameras_.insert(index);
  }

  const Json* light_list() const {
    const Json* extension = file_.extension_of(file_.root(), "KHR_lights_punctual");
    return extension ? list_in(*extension, "lights") : nullptr;
  }

  void add_light(const Json& node, std::size_t n, std::size_t index) {
    const Json* lights = light_list();
    if (!lights || index >= lights->size())
      throw Error("{}: node {} names light {}; there are {}", file_.name(), n, index, lights ? lights->size() : 0);
    const Json& light = lights->at(index);
    const std::string where = fmt::format("light {}", index), type = file_.text(light, "type");
    ImportedLight& raw = answer_.lights.emplace_back();
    raw.name = name_of(node, light);
    raw.kind = type == "point"         ? ImportedLightKind::point
               : type == "spot"        ? ImportedLightKind::spot
               : type == "directional" ? ImportedLightKind::directional
                                       : ImportedLightKind::other;
    raw.position = glm::dvec3(nodes_[n][3]);
    raw.direction = glm::dmat3(nodes_[n]) * glm::dvec3(0, 0, -1);
    const Json none = Json::object();
    const Json* spot = object_in(light, "spot");
    const Json& cone = spot ? *spot : none;
    raw.inner = file_.number(cone, where, "innerConeAngle", 0);
    raw.outer = file_.number(cone, where, "outerConeAngle", std::numbers::pi / 4);
    raw.intensity = file_.number(light, where, "intensity", 1) / lumens_per_watt;
    used_lights_.insert(index);
    colored_lights_ += light.contains("color") || light.contains("range");
  }

  void note() {
    answer_.note(meshes_elsewhere_, "nodes with meshes stand outside of the default scene and are left out");
    answer_.note(file_.count("cameras") - used_cameras_.size(), "cameras stand at no node of the scene and are left out");
    const Json* lights = light_list();
    answer_.note((lights ? lights->size() : 0) - used_lights_.size(), "lights stand at no node of the scene and are left out");
    answer_.note(hidden_count_, "nodes with meshes or lights are hidden by KHR_node_visibility and left out");
    answer_.note(colored_lights_, "lights have a color or a range, which are not used");
    answer_.note(file_.count("animations"), "animations are not applied: nodes stand as they do in the file");
    for (const std::string& note : file_.notes()) answer_.notes.push_back(note);
  }

  GltfFile& file_;
  std::vector<glm::dmat4> nodes_;   ///< world from node
  std::vector<std::size_t> order_;  ///< nodes of the default scene
  std::vector<bool> hidden_;        ///< by KHR_node_visibility, with all below them
  std::set<std::size_t> used_cameras_, used_lights_;
  std::size_t hidden_count_ = 0, colored_lights_ = 0, meshes_elsewhere_ = 0;
  MeshFile answer_;
};

}  // namespace

MeshFile read_gltf(const std::filesystem::path& file, const ReadFile& read, bool with_uv) {
  try {
    GltfFile gltf(file, read);
    return gltf.is_version_1() ? read_by_assimp(file, read) : SceneReader(gltf).read(read, with_uv);
  } catch (const Json::exception& problem) {
    throw Error("{}: is not sound glTF: {}", file.string(), complaint(problem));
  }
}

}  // namespace gnomon::importing
