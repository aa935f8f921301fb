#include "measure/formats/gltf_mesh.h"

#include <algorithm>
#include <numeric>

#include "measure/formats/readers.h"

namespace gnomon::importing {

void GltfMeshes::add(std::size_t node, std::size_t index) {
  const Json& mesh = file_.item("meshes", index);
  const Json* primitives = list_in(mesh, "primitives");
  if (!primitives) throw Error("{}: mesh {} has no primitives", file_.name(), index);
  const Json& owner = file_.item("nodes", node);
  std::string name = file_.text(mesh, "name");
  if (name.empty()) name = file_.text(owner, "name");
  const std::vector<glm::dmat4> places = tree_.places(node);
  for (std::size_t p = 0; p < primitives->size(); ++p) {
    const std::string where = fmt::format("mesh {}, primitive {}", index, p);
    if (!primitives->at(p).is_object()) throw Error("{}: {} is no object", file_.name(), where);
    add_primitive(
        {owner, mesh, primitives->at(p), node, index, where, primitives->size() > 1 ? fmt::format("{}-{}", name, p) : name},
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
  for (std::uint32_t& number : place)
    if (number != unused) number = count++;
  // Each list holds `width` items of every vertex, and some hold that several times: targets one after the other.
  const auto keep_used = [&](auto& items, std::size_t width) {
    if (items.empty() || width == 0) return;
    const std::size_t size = width * place.size(), times = items.size() / size;
    for (std::size_t t = 0; t < times; ++t)
      for (std::size_t v = 0; v < place.size(); ++v)
        if (place[v] != unused)
          for (std::size_t k = 0; k < width; ++k) items[width * (t * count + place[v]) + k] = items[t * size + width * v + k];
    items.resize(times * width * count);
  };
  keep_used(mesh.positions, 1);
  keep_used(mesh.uv, 1);
  keep_used(mesh.base, 1);
  keep_used(mesh.targets, 1);
  keep_used(mesh.joints, mesh.joints_per_vertex);
  keep_used(mesh.weights, mesh.joints_per_vertex);
  for (std::uint32_t& corner : mesh.corners) corner = place[corner];
}

void drop_motion(ImportedMesh& mesh) {
  mesh.base = mesh.targets = {};
  mesh.joints_per_vertex = 0;
  mesh.joints = {};
  mesh.weights = {};
}

}  // namespace

void GltfMeshes::add_primitive(const Primitive& primitive, const std::vector<glm::dmat4>& places) {
  if (!attribute(primitive, "POSITION")) return void(++without_positions_);
  // A primitive of many nodes is read once.
  const std::string key = fmt::format("{} {}", primitive.where, primitive.name);
  const bool is_posed = primitive.node.contains("skin") || primitive.node.contains("weights");
  if (const auto known = known_.find(key); known != known_.end() && !is_posed) {
    ImportedMesh& mesh = answer_.meshes[known->second];
    mesh.places.insert(mesh.places.end(), places.begin(), places.end());
    return add_origin(primitive, mesh, origins_[known->second]);
  }
  ImportedMesh mesh;
  mesh.name = primitive.name;
  add_positions(primitive, mesh);
  add_faces(primitive, mesh.positions.size(), mesh);
  if (mesh.corner_counts.empty()) return;
  read_material(primitive, mesh);
  Origin origin;
  add_origin(primitive, mesh, origin);
  const auto skin = file_.index(primitive.node, primitive.where, "skin");
  if (skin) {
    if (origin.is_moved && mesh.base.empty()) mesh.base = mesh.positions;
    add_joints(primitive, motion_.skin(*skin).joints.size(), mesh);
    pose(*skin, mesh);
    if (origin.is_moved)
      mesh.skin = motion_.number_of_skin(*skin);
    else
      drop_motion(mesh);
  }
  mesh.places = skin ? std::vector{glm::dmat4(1)} : places;  // the joints alone place a mesh with a skin
  if (!is_posed) known_.emplace(key, answer_.meshes.size());
  check_targets(primitive, mesh);
  drop_unused_vertices(mesh);
  answer_.meshes.push_back(std::move(mesh));
  origins_.push_back(std::move(origin));
}

void GltfMeshes::add_origin(const Primitive& primitive, const ImportedMesh& mesh, Origin& origin) const {
  origin.nodes.push_back(primitive.node_index);
  origin.is_moved |= motion_.moves(primitive.node_index);
  origin.is_moved |= motion_.morphs(primitive.node_index) && !mesh.targets.empty();
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

/// The coordinates of a textureInfo, where a mask or a transmission needs them or they are requested; nothing where there are
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

void GltfMeshes::finish() {
  for (std::size_t m = 0; m < answer_.meshes.size(); ++m) {
    if (!origins_[m].is_moved) drop_motion(answer_.meshes[m]);
    for (const std::size_t node : origins_[m].nodes)
      if (origins_[m].is_moved) motion_.place(node, answer_.meshes[m]);
  }
  answer_.note(points_and_lines_, "{point or line is|points and lines are} left out");
  answer_.note(without_positions_, "primitive{s} {has|have} no positions and {is|are} left out");
  answer_.note(odd_weights_,
               "vert{ex has|ices have} weights of joints whose sum is not 1, and {is used as it is|are used as they are}");
  answer_.note(vertex_alpha_, "vert{ex|ices} of masked meshes {has|have} a color with alpha, which is not used");
  answer_.note(vertex_colors_, "vert{ex|ices} of meshes that transmit light {has|have} a color, which is not used");
  textures_.note();
}

}  // namespace gnomon::importing
