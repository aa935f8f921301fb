// glTF 2.0: the nodes of the default scene with their meshes, cameras and lights, as they are in the file.
// Source: Khronos, glTF 2.0 specification (ISO/IEC 12113:2022); KHR_lights_punctual, KHR_mesh_quantization.
#include <gnomon/light.h>

#include <numbers>
#include <set>

#include "measure/formats/gltf_mesh.h"
#include "measure/formats/readers.h"

namespace gnomon::importing {
namespace {

class SceneReader {
 public:
  explicit SceneReader(GltfFile& file) : file_(file), tree_(file), motion_(file, tree_) {}

  MeshFile read(const ReadFile& read, bool with_uv) {
    GltfMeshes meshes(file_, read, tree_, motion_, with_uv, answer_);
    for (const std::size_t n : tree_.scene()) {
      const Json& node = file_.item("nodes", n);
      const std::string where = fmt::format("node {}", n);
      const bool is_hidden = tree_.is_hidden(n);
      if (is_hidden)
        hidden_count_ += node.contains("mesh") || file_.extension_of(node, "KHR_lights_punctual");
      else if (const auto mesh = file_.index(node, where, "mesh"))
        meshes.add(n, *mesh);
      if (const auto camera = file_.index(node, where, "camera")) add_camera(node, n, *camera);
      if (const Json* light = file_.extension_of(node, "KHR_lights_punctual"); light && !is_hidden)
        if (const auto index = file_.index(*light, where, "light")) add_light(node, n, *index);
    }
    meshes.finish();
    note();
    return std::move(answer_);
  }

 private:
  /// Of the node, else of what it carries.
  std::string name_of(const Json& node, const Json& carried) const {
    const std::string name = file_.text(node, "name");
    return name.empty() ? file_.text(carried, "name") : name;
  }

  void add_camera(const Json& node, std::size_t n, std::size_t index) {
    const Json& camera = file_.item("cameras", index);
    const Json* perspective = object_in(camera, "perspective");
    const std::string where = fmt::format("camera {}", index);
    const glm::dmat4& world = tree_.world()[n];
    answer_.cameras.push_back({.name = name_of(node, camera),
                               .eye = glm::dvec3(world[3]),
                               .forward = glm::dmat3(world) * glm::dvec3(0, 0, -1),
                               .up = glm::dmat3(world) * glm::dvec3(0, 1, 0),
                               .fov_y = perspective ? file_.number(*perspective, where, "yfov", 0) : 0});
    used_cameras_.insert(index);
    moved_count_ += motion_.moves_place(n);
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
    raw.position = glm::dvec3(tree_.world()[n][3]);
    raw.direction = glm::dmat3(tree_.world()[n]) * glm::dvec3(0, 0, -1);
    const Json none = Json::object();
    const Json* spot = object_in(light, "spot");
    const Json& cone = spot ? *spot : none;
    raw.inner = file_.number(cone, where, "innerConeAngle", 0);
    raw.outer = file_.number(cone, where, "outerConeAngle", std::numbers::pi / 4);
    raw.intensity = file_.number(light, where, "intensity", 1) / lumens_per_watt;
    used_lights_.insert(index);
    moved_count_ += motion_.moves_place(n);
    colored_lights_ += light.contains("color") || light.contains("range");
  }

  void note() {
    std::size_t elsewhere = 0;
    for (std::size_t n = 0; n < tree_.size(); ++n) elsewhere += file_.item("nodes", n).contains("mesh");
    for (const std::size_t n : tree_.scene()) elsewhere -= file_.item("nodes", n).contains("mesh");
    answer_.note(elsewhere, "node{s} with meshes {stands|stand} outside of the default scene and {is|are} left out");
    answer_.note(file_.count("cameras") - used_cameras_.size(),
                 "camera{s} {stands|stand} at no node of the scene and {is|are} left out");
    const Json* lights = light_list();
    answer_.note((lights ? lights->size() : 0) - used_lights_.size(),
                 "light{s} {stands|stand} at no node of the scene and {is|are} left out");
    answer_.note(hidden_count_, "node{s} with meshes or lights {is|are} hidden by KHR_node_visibility and left out");
    answer_.note(colored_lights_, "light{s} {has|have} a color or a range, which are not used");
    motion_.finish(answer_);
    answer_.note(moved_count_,
                 "{camera or light is at a node|cameras and lights are at nodes} that animations move, and "
                 "{stays where the file has it|stay where the file has them}");
    for (const std::string& note : file_.notes()) answer_.notes.push_back(note);
  }

  GltfFile& file_;
  GltfTree tree_;
  GltfMotion motion_;
  std::set<std::size_t> used_cameras_, used_lights_;
  std::size_t hidden_count_ = 0, colored_lights_ = 0, moved_count_ = 0;
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
