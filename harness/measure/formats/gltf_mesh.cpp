#include "measure/formats/gltf_mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <numeric>

#include "measure/formats/readers.h"

namespace gnomon::importing {

/// One primitive of one node's mesh.
struct GltfMeshes::Primitive {
  const Json &node, &mesh, &json;
  std::string where, name;
};

void GltfMeshes::add(std::size_t node, std::size_t index, const std::vector<glm::dmat4>& places) {
  const Json& mesh = file_.item("meshes", index);
  const Json* primitives = list_in(mesh, "primitives");
  if (!primitives) throw Error("{}: mesh {} has no primitives", file_.name(), index);
  const Json& owner = file_.item("nodes", node);
  std::string name = file_.text(mesh, "name");
  if (name.empty()) name = file_.text(owner, "name");
  for (std::size_t p = 0; p < primitives->size(); ++p) {
    const std::string where = fmt::format("mesh {}, primitive {}", index, p);
    if (!primitives->at(p).is_object()) throw Error("{}: {} is no object", file_.name(), where);
    add_primitive({owner, mesh, primitives->at(p), where, primitives->size() > 1 ? fmt::format("{}-{}", name, p) : name},
                  places);
  }
}

std::optional<std::size_t> GltfMeshes::attribute(const Primitive& primitive, const char* name) const {
  const Json* attributes = object_in(primitive.json, "attributes");
  return attributes ? file_.index(*attributes, primitive.where, name) : std::nullopt;
}

namespace {

/// Primitives may share their vertices: each keeps those that its faces name.
void drop_unused_vertices(ImportedMesh& mesh) {
  constexpr std::uint32_t unused = 0xffffffffu;
  std::vector<std::uint32_t> place(mesh.positions.size(), unused);
  for (const std::uint32_t corner : mesh.corners) place[corner] = 0;
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < place.size(); ++v) {
    if (place[v] == unused) continue;
    mesh.positions[count] = mesh.positions[v];
    if (!mesh.uv.empty()) mesh.uv[count] = mesh.uv[v];
    place[v] = count++;
  }
  mesh.positions.resize(count);
  if (!mesh.uv.empty()) mesh.uv.resize(count);
  for (std::uint32_t& corner : mesh.corners) corner = place[corner];
}

}  // namespace

void GltfMeshes::add_primitive(const Primitive& primitive, const std::vector<glm::dmat4>& places) {
  if (!attribute(primitive, "POSITION")) return void(++without_positions_);
  // A primitive of many nodes is read once.
  const std::string key = fmt::format("{} {}", primitive.where, primitive.name);
  const bool is_posed = primitive.node.contains("skin") || primitive.node.contains("weights");
  if (const auto known = known_.find(key); known != known_.end() && !is_posed) {
    std::vector<glm::dmat4>& there = answer_.meshes[known->second].places;
    there.insert(there.end(), places.begin(), places.end());
    return;
  }
  ImportedMesh mesh;
  mesh.name = primitive.name;
  mesh.positions = positions(primitive);
  add_faces(primitive, mesh.positions.size(), mesh);
  if (mesh.corner_counts.empty()) return;
  read_material(primitive, mesh);
  const auto skin = file_.index(primitive.node, primitive.where, "skin");
  if (skin) pose(primitive, *skin, mesh.positions);
  mesh.places = skin ? std::vector{glm::dmat4(1)} : places;  // the joints alone place a mesh with a skin
  if (!is_posed) known_.emplace(key, answer_.meshes.size());
  drop_unused_vertices(mesh);
  answer_.meshes.push_back(std::move(mesh));
}

/// Of the node, else of the mesh, else 0.
std::vector<double> GltfMeshes::weights(const Primitive& primitive, std::size_t target_count) const {
  std::vector<double> weights = file_.numbers(primitive.node, primitive.where, "weights", 0);
  if (weights.empty()) weights = file_.numbers(primitive.mesh, primitive.where, "weights", 0);
  if (weights.empty()) weights.resize(target_count);
  if (weights.size() != target_count)
    throw Error("{}: {} has {} morph targets and {} weights", file_.name(), primitive.where, target_count, weights.size());
  return weights;
}

std::vector<glm::dvec3> GltfMeshes::positions(const Primitive& primitive) {
  const std::size_t accessor = *attribute(primitive, "POSITION");
  if (file_.extension_of(primitive.json, "KHR_draco_mesh_compression") &&
      !file_.item("accessors", accessor).contains("bufferView"))
    throw Error("{}: {} is compressed by KHR_draco_mesh_compression, which is not read", file_.name(), primitive.where);
  if (!last_ || last_->first != accessor) last_.emplace(accessor, file_.read(accessor, 3));  // primitives may share it
  const Numbers& numbers = last_->second;
  std::vector<glm::dvec3> positions(numbers.count);
  for (std::size_t v = 0; v < numbers.count; ++v) positions[v] = numbers.vector(v);

  const Json* targets = list_in(primitive.json, "targets");
  if (!targets) return positions;
  const std::vector<double> shares = weights(primitive, targets->size());
  for (std::size_t t = 0; t < targets->size(); ++t) {
    if (shares[t] == 0) continue;
    const auto moves = file_.index(targets->at(t), fmt::format("{}, target {}", primitive.where, t), "POSITION");
    if (!moves) continue;
    const Numbers target = file_.read(*moves, 3);
    if (target.count != numbers.count)
      throw Error("{}: {}, target {} moves {} vertices of {}", file_.name(), primitive.where, t, target.count, numbers.count);
    for (std::size_t v = 0; v < numbers.count; ++v) positions[v] += shares[t] * target.vector(v);
  }
  return positions;
}

std::vector<glm::dmat4> GltfMeshes::joints(std::size_t skin) const {
  const Json& json = file_.item("skins", skin);
  const std::string where = fmt::format("skin {}", skin);
  std::vector<glm::dmat4> matrices;
  for (const double name : file_.numbers(json, where, "joints", 0)) {
    if (!(name >= 0 && name < static_cast<double>(nodes_.size()) && name == std::floor(name)))
      throw Error("{}: {} names node {} of {}", file_.name(), where, name, nodes_.size());
    matrices.push_back(nodes_[static_cast<std::size_t>(name)]);
  }
  const auto inverse = file_.index(json, where, "inverseBindMatrices");  // the identity without them
  if (!inverse) return matrices;
  const Numbers numbers = file_.read(*inverse, 16);
  if (numbers.count < matrices.size())
    throw Error("{}: {} has {} joints and {} inverse bind matrices", file_.name(), where, matrices.size(), numbers.count);
  for (std::size_t j = 0; j < matrices.size(); ++j) matrices[j] *= glm::make_mat4(&numbers.values[16 * j]);
  return matrices;
}

/// Places each vertex by the weighted sum of its joints' matrices.
void GltfMeshes::pose(const Primitive& primitive, std::size_t skin, std::vector<glm::dvec3>& positions) {
  if (!last_skin_ || last_skin_->first != skin) last_skin_.emplace(skin, joints(skin));
  const std::vector<glm::dmat4>& matrices = last_skin_->second;
  std::vector<glm::dmat4> sums(positions.size(), glm::dmat4(0));
  std::vector<double> weight_sums(positions.size());
  for (int set = 0;; ++set) {
    const auto joint_accessor = attribute(primitive, fmt::format("JOINTS_{}", set).c_str());
    const auto weight_accessor = attribute(primitive, fmt::format("WEIGHTS_{}", set).c_str());
    if (!joint_accessor || !weight_accessor) {
      if (set == 0 || joint_accessor != weight_accessor)
        throw Error("{}: {} has a skin but not both JOINTS_{} and WEIGHTS_{}", file_.name(), primitive.where, set, set);
      break;
    }
    double largest = 0;
    const Numbers joint = file_.read_indices(*joint_accessor, 4, largest), weight = file_.read(*weight_accessor, 4);
    if (joint.count != positions.size() || weight.count != positions.size())
      throw Error("{}: {} has {} vertices, joints for {} and weights for {}", file_.name(), primitive.where, positions.size(),
                  joint.count, weight.count);
    for (std::size_t v = 0; v < positions.size(); ++v)
      for (std::size_t k = 0; k < 4; ++k) {
        if (weight.at(v, k) == 0) continue;
        if (joint.at(v, k) >= static_cast<double>(matrices.size()))
          throw Error("{}: {}, vertex {} names joint {} of {}", file_.name(), primitive.where, v, joint.at(v, k),
                      matrices.size());
        sums[v] += weight.at(v, k) * matrices[static_cast<std::size_t>(joint.at(v, k))];
        weight_sums[v] += weight.at(v, k);
      }
  }
  for (std::size_t v = 0; v < positions.size(); ++v) {
    positions[v] = glm::dvec3(sums[v] * glm::dvec4(positions[v], 1));
    constexpr double rounding = 0.01;  // four weights of 8 bits are off by this much at most
    odd_weights_ += !(std::abs(weight_sums[v] - 1) <= rounding);
  }
}

void GltfMeshes::add_faces(const Primitive& primitive, std::size_t vertex_count, ImportedMesh& mesh) {
  enum Mode : std::size_t { points, lines, line_loop, line_strip, triangles, strip, fan };
  const std::size_t mode = file_.index(primitive.json, primitive.where, "mode").value_or(triangles);
  if (mode > fan) throw Error("{}: {}: mode = {} is outside 0 .. 6", file_.name(), primitive.where, mode);
  std::vector<std::uint32_t> corners(vertex_count);
  std::iota(corners.begin(), corners.end(), 0u);
  if (const auto indices = file_.index(primitive.json, primitive.where, "indices")) {
    double largest = 0;
    const Numbers numbers = file_.read_indices(*indices, 1, largest);
    corners.resize(numbers.count);
    for (std::size_t i = 0; i < numbers.count; ++i) {
      const double index = numbers.at(i);
      if (index == largest)
        throw Error("{}: {}: index {} is {}, which restarts primitives and is not allowed", file_.name(), primitive.where, i,
                    index);
      if (index >= static_cast<double>(vertex_count))
        throw Error("{}: {}: index {} names vertex {}, out of range: allowed are 0 .. {}", file_.name(), primitive.where, i,
                    index, static_cast<std::int64_t>(vertex_count) - 1);
      corners[i] = static_cast<std::uint32_t>(index);
    }
  }
  const std::size_t n = corners.size();
  if (mode < triangles) {
    points_and_lines_ += mode == points ? n : mode == lines ? n / 2 : mode == line_loop ? n : n - std::min<std::size_t>(n, 1);
    return;
  }
  if ((mode == triangles && n % 3 != 0) || (mode != triangles && n > 0 && n < 3))
    throw Error("{}: {}: {} indices make no triangles", file_.name(), primitive.where, n);
  if (mode == triangles) {
    mesh.corner_counts.assign(n / 3, 3);
    mesh.corners = std::move(corners);
    return;
  }
  for (std::size_t i = 0; i + 2 < n; ++i)
    if (mode == fan)
      mesh.add_triangle(corners[i + 1], corners[i + 2], corners[0]);
    else
      mesh.add_triangle(corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]);
}

void GltfMeshes::read_material(const Primitive& primitive, ImportedMesh& mesh) {
  const auto index = file_.index(primitive.json, primitive.where, "material");
  if (!index) return add_uv(primitive, nullptr, mesh);
  const Json& material = file_.item("materials", *index);
  const std::string where = fmt::format("material {}", *index);
  const Json none = Json::object();
  const Json* glossy = file_.extension_of(material, "KHR_materials_pbrSpecularGlossiness");
  const Json* metallic = object_in(material, "pbrMetallicRoughness");
  const Json& colors = glossy ? *glossy : metallic ? *metallic : none;
  const std::vector<double> factor = file_.numbers(colors, where, glossy ? "diffuseFactor" : "baseColorFactor", 4);
  mesh.has_color = true;
  mesh.color = factor.empty() ? glm::vec3(1) : glm::vec3(factor[0], factor[1], factor[2]);
  const char* const texture_key = glossy ? "diffuseTexture" : "baseColorTexture";
  mesh.has_texture = colors.contains(texture_key);
  const GltfColor color{factor.empty() ? glm::dvec4(1) : glm::dvec4(factor[0], factor[1], factor[2], factor[3]),
                        object_in(colors, texture_key)};
  read_textures(primitive, material, where, color, mesh);
}

/// What is wrong with a mask or a transmission is said where it is used: a description may leave it out.
void GltfMeshes::read_textures(const Primitive& primitive, const Json& material, const std::string& where,
                               const GltfColor& color, ImportedMesh& mesh) {
  const bool is_masked = file_.text(material, "alphaMode") == "MASK";
  mesh.is_transparent = is_masked && color.factor.a < file_.number(material, where, "alphaCutoff", 0.5);
  const auto attempt = [&](std::uint32_t& image, auto read) {
    try {
      read();
    } catch (const Error& error) {
      mesh.uv.clear();
      image = add_broken_image(answer_, where, error.what());
    }
  };
  const Json* places = nullptr;
  attempt(mesh.mask.image, [&] {
    if (is_masked && color.texture) mesh.mask = textures_.mask(material, where, color);
    if (mesh.mask.has_image()) places = color.texture;
  });
  attempt(mesh.transmission.alpha_image, [&] { mesh.transmission = textures_.transmission(material, where, color, places); });
  mesh.is_transparent |= mesh.transmission.is_there();
  const bool is_blended = file_.text(material, "alphaMode") == "BLEND";
  if ((is_blended || mesh.transmission.transmission != 0) && !mesh.transmission.has_image())
    mesh.has_texture = false;  // a note says that its image is not there
  const bool is_glass = mesh.transmission.is_there() && !mesh.mask.has_image();
  attempt(is_glass ? mesh.transmission.alpha_image : mesh.mask.image,
          [&] { add_uv(primitive, places ? places : color.texture, mesh); });
}

/// The coordinates of a textureInfo, where a mask or a transmission needs them or they are wanted; nothing where there are
/// none.
void GltfMeshes::add_uv(const Primitive& primitive, const Json* texture, ImportedMesh& mesh) {
  if (mesh.mask.has_image() || mesh.transmission.is_there()) count_vertex_colors(primitive, mesh);
  if (!mesh.mask.has_image() && !mesh.transmission.has_image() && !with_uv_) return;
  const GltfTextureMap map(file_, primitive.where, texture);
  const auto accessor = attribute(primitive, map.attribute().c_str());
  if (!accessor) return;
  const Numbers numbers = file_.read(*accessor, 2);
  if (numbers.count != mesh.positions.size())
    throw Error("{}: {} has {} vertices and {} texture coordinates", file_.name(), primitive.where, mesh.positions.size(),
                numbers.count);
  mesh.uv = map.uv(numbers);
}

void GltfMeshes::count_vertex_colors(const Primitive& primitive, const ImportedMesh& mesh) {
  const auto colors = attribute(primitive, "COLOR_0");
  if (!colors) return;
  const bool has_alpha = file_.text(file_.item("accessors", *colors), "type") == "VEC4";
  const bool is_masked = mesh.mask.has_image(), transmits = mesh.transmission.is_there();
  if (!has_alpha && !transmits) return;
  const Numbers numbers = file_.read(*colors, has_alpha ? 4 : 3);
  for (std::size_t v = 0; v < numbers.count; ++v) {
    vertex_alpha_ += is_masked && has_alpha && numbers.at(v, 3) != 1;
    vertex_colors_ += transmits && (numbers.vector(v) != glm::dvec3(1) || (has_alpha && numbers.at(v, 3) != 1));
  }
}

void GltfMeshes::note() {
  answer_.note(points_and_lines_, "points and lines are left out");
  answer_.note(without_positions_, "primitives have no positions and are left out");
  answer_.note(odd_weights_, "vertices have weights of joints whose sum is not 1, and are used as they are");
  answer_.note(vertex_alpha_, "vertices of masked meshes have a color with alpha, which is not used");
  answer_.note(vertex_colors_, "vertices of meshes that transmit light have a color, which is not used");
  textures_.note();
}

}  // namespace gnomon::importing
