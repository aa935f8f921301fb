#include "measure/exchange/gltf.h"

#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/geometry/camera.h>

#include <algorithm>
#include <map>

#include "measure/exchange/gltf_transmission.h"
#include "measure/exchange/mask_png.h"
#include "measure/scene/blob.h"
#include "measure/scene/channels.h"
#include "measure/scene/scene_json.h"

namespace gnomon {

namespace {

// Numbers of the format: component types, targets of buffers.
constexpr int float_type = 5126, unsigned_type = 5125, vertex_target = 34962, index_target = 34963, nearest_filter = 9728;

int wrap_number(AlphaMask::Wrap wrap) {
  constexpr int numbers[] = {10497, 33648, 33071};  // repeat, mirror, clamp
  return numbers[static_cast<int>(wrap)];
}

/// Columns of a node's matrix: x to the right, y up, z backward, as cameras and lights of glTF look along -z.
Json matrix(const glm::dvec3& right, const glm::dvec3& up, const glm::dvec3& back, const glm::dvec3& place) {
  Json m = Json::array();
  const glm::dvec3 columns[] = {right, up, back, place};
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 3; ++r) m.push_back(columns[c][r]);
    m.push_back(c == 3 ? 1 : 0);
  }
  return m;
}

/// Looks along a direction from a place.
Json looking(const glm::dvec3& direction, const glm::dvec3& place) {
  const glm::dvec3 back = -glm::normalize(direction);
  const Across sides(back);
  return matrix(sides.u, sides.v, back, place);
}

class GltfWriter {
 public:
  explicit GltfWriter(const Scene& scene) : scene_(scene) {
    json_ = json_object({{"asset", json_object({{"version", "2.0"}, {"generator", "gnomon"}})}, {"scene", 0}});
    for (const char* list : {"scenes", "nodes", "meshes", "materials", "accessors", "bufferViews", "cameras"})
      json_[list] = Json::array();
    for (const Mesh& mesh : scene.meshes) add(mesh);
    for (const View& view : scene.views) add(view);
    for (const Light& light : whole_lights(scene.lights)) add(light);
    Json roots = Json::array();
    for (std::size_t n = 0; n < json_["nodes"].size(); ++n) roots.push_back(n);
    json_["scenes"].push_back(json_object({{"name", scene.name}, {"nodes", roots}}));
    if (!punctual_.empty()) {
      use("KHR_lights_punctual");
      json_["extensions"]["KHR_lights_punctual"]["lights"] = punctual_;
    }
    for (const char* list : {"meshes", "materials", "accessors", "bufferViews", "cameras"})
      if (json_[list].empty()) json_.erase(list);  // the format allows no empty lists
  }

  void write(const std::filesystem::path& file) {
    const std::filesystem::path numbers = std::filesystem::path(file).replace_extension(".bin");
    if (!bytes_.empty())
      json_["buffers"].push_back(json_object({{"uri", numbers.filename().string()}, {"byteLength", bytes_.size()}}));
    write_file(numbers, bytes_);
    write_file(file, json_text(json_, 1) + "\n");
  }

 private:
  std::size_t add_bytes(std::span<const std::byte> bytes) {
    json_["bufferViews"].push_back(json_object({{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}}));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return json_["bufferViews"].size() - 1;
  }
  std::size_t add_numbers(std::span<const std::byte> numbers, int target) {
    const std::size_t view = add_bytes(numbers);
    json_["bufferViews"][view]["target"] = target;
    return view;
  }
  std::size_t add_accessor(std::size_t view, int type, std::size_t count, const char* shape) {
    json_["accessors"].push_back(
        json_object({{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", shape}}));
    return json_["accessors"].size() - 1;
  }

  /// Appends to a list of the file, which is there only with something in it.
  std::size_t append(const char* list, Json item) {
    if (!json_.contains(list)) json_[list] = Json::array();
    json_[list].push_back(std::move(item));
    return json_[list].size() - 1;
  }

  void use(const char* extension) {
    Json& used = json_["extensionsUsed"];
    if (!used.is_array()) used = Json::array();
    if (std::ranges::find(used, Json(extension)) == used.end()) used.push_back(extension);
  }

  /// A texture of a PNG that is wrapped as `image` is: a mask or a transmission. Meshes that share that share it.
  template <class Image>
  std::size_t texture_of(const Image& image, const auto& png) {
    if (const auto known = textures_.find(&image); known != textures_.end()) return known->second;
    const std::size_t view = add_bytes(png());
    bytes_.resize((bytes_.size() + 3) / 4 * 4);  // numbers that follow begin at a multiple of 4
    const std::size_t source = append("images", json_object({{"bufferView", view}, {"mimeType", "image/png"}}));
    const std::size_t sampler = append("samplers", json_object({{"magFilter", nearest_filter},
                                                                {"minFilter", nearest_filter},
                                                                {"wrapS", wrap_number(image.wrap_u())},
                                                                {"wrapT", wrap_number(image.wrap_v())}}));
    return textures_[&image] = append("textures", json_object({{"source", source}, {"sampler", sampler}}));
  }

  /// To a mesh whose material is the last one.
  void add_mask(const Mesh& mesh) {
    Json& material = json_["materials"].back();
    material["alphaMode"] = "MASK";
    material["alphaCutoff"] = 0.5;
    const AlphaMask& mask = *mesh.alpha_mask;
    material["pbrMetallicRoughness"]["baseColorTexture"]["index"] = texture_of(mask, [&] { return mask_png(mask); });
  }

  /// The same. The color of the material is then that of the transmission; albedo and rounding are in `extras`.
  void add_transmission(const Mesh& mesh, Json& extras) {
    const Transmission& transmission = *mesh.transmission;
    const GltfTransmission words = gltf_transmission(transmission);
    if (mesh.alpha_mask && words.channels == 3)
      throw Error("mesh '{}' has an alpha mask and a transmission of colored texels; glTF has one image for both", mesh.name);
    use("KHR_materials_transmission");
    Json& material = json_["materials"].back();
    Json& color = material["pbrMetallicRoughness"]["baseColorFactor"];
    color = number_json(words.color);
    color.push_back(1);
    Json& extension = material["extensions"]["KHR_materials_transmission"];
    extension["transmissionFactor"] = number_json(words.factor);
    extras["albedo"] = number_json(mesh.albedo);
    if (words.channels == 0) return;
    const std::size_t texture = texture_of(
        transmission, [&] { return png_of(transmission.width(), transmission.height(), words.channels, words.bytes); });
    (words.channels == 3 ? material["pbrMetallicRoughness"]["baseColorTexture"] : extension["transmissionTexture"])["index"] =
        texture;
    extras["transmission_rounding"] = words.rounding;
  }

  void add(const Mesh& mesh) {
    Json node = json_object({{"name", mesh.name}});
    node["extras"] = json_object(
        {{"casts", mesh.casts}, {"receives", mesh.receives}, {"shape", mesh.shape ? scene_json(*mesh.shape) : Json()}});
    if (mesh.transmission || !mesh.seen) node["extras"]["seen"] = mesh.seen;
    if (!mesh.triangles.empty()) {
      Bounds bounds;
      bounds.add(mesh.positions);
      const std::size_t positions = add_accessor(add_numbers(std::as_bytes(std::span(mesh.positions)), vertex_target),
                                                 float_type, mesh.positions.size(), "VEC3");
      json_["accessors"][positions]["min"] = number_json(bounds.min);
      json_["accessors"][positions]["max"] = number_json(bounds.max);
      const std::size_t indices = add_accessor(add_numbers(std::as_bytes(std::span(mesh.triangles)), index_target),
                                               unsigned_type, 3 * mesh.triangles.size(), "SCALAR");
      Json color = number_json(mesh.albedo);
      color.push_back(1);
      json_["materials"].push_back(json_object(
          {{"pbrMetallicRoughness", json_object({{"baseColorFactor", color}, {"metallicFactor", 0}, {"roughnessFactor", 1}})},
           {"doubleSided", true}}));
      Json primitive = json_object({{"attributes", json_object({{"POSITION", positions}})},
                                    {"indices", indices},
                                    {"material", json_["materials"].size() - 1}});
      if (mesh.alpha_mask) add_mask(mesh);
      if (mesh.transmission) add_transmission(mesh, node["extras"]);
      if (mesh.needs_uv())
        primitive["attributes"]["TEXCOORD_0"] =
            add_accessor(add_numbers(std::as_bytes(std::span(mesh.uv)), vertex_target), float_type, mesh.uv.size(), "VEC2");
      node["mesh"] = json_["meshes"].size();
      json_["meshes"].push_back(json_object({{"name", mesh.name}, {"primitives", Json::array({primitive})}}));
    }
    json_["nodes"].push_back(node);
  }

  void add(const View& view) {
    const Camera camera(view, 1, 1);
    Json node = json_object({{"name", view.name}, {"camera", json_["cameras"].size()}});
    node["matrix"] = matrix(camera.right, camera.up, -camera.forward, camera.eye);
    node["extras"] = scene_json(view);
    json_["nodes"].push_back(node);
    json_["cameras"].push_back(json_object(
        {{"name", view.name},
         {"type", "perspective"},
         {"perspective", json_object({{"yfov", glm::radians(static_cast<double>(view.fov_y_degrees))}, {"znear", near()}})}}));
  }

  void add(const Light& light) {
    Json node = json_object({{"name", light.name}, {"extras", scene_json(light)}});
    Json facts = json_object(
        {{"name", light.name}, {"type", kind_name(light)}, {"intensity", number_json(lumens_per_watt * light.intensity)}});
    if (const auto* point = std::get_if<PointLight>(&light.kind)) node["translation"] = number_json(point->position);
    if (const auto* sun = std::get_if<DirectionalLight>(&light.kind)) node["matrix"] = looking(sun->direction, glm::dvec3(0));
    if (const auto* spot = std::get_if<SpotLight>(&light.kind)) {
      node["matrix"] = looking(spot->direction, spot->position);
      facts["spot"] = json_object({{"innerConeAngle", glm::radians(static_cast<double>(spot->inner_degrees))},
                                   {"outerConeAngle", glm::radians(static_cast<double>(spot->outer_degrees))}});
    }
    if (!has_area(light)) {
      node["extensions"]["KHR_lights_punctual"]["light"] = punctual_.size();
      punctual_.push_back(facts);
    }
    json_["nodes"].push_back(node);
  }

  /// Cameras of the format require a near plane: at a thousandth of the scene's extent, which cuts nothing off.
  double near() const {
    const double size = scene_.bounds().extent();
    return size > 0 ? size / 1000 : 0.001;
  }

  const Scene& scene_;
  Json json_, punctual_ = Json::array();
  std::vector<std::byte> bytes_;
  std::map<const void*, std::size_t> textures_;  ///< of masks and transmissions
};

}  // namespace

void write_gltf(const std::filesystem::path& file, const Scene& scene) { GltfWriter(scene).write(file); }

}  // namespace gnomon
