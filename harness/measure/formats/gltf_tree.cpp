// Source: Khronos, glTF 2.0 specification (ISO/IEC 12113:2022), 3.5; EXT_mesh_gpu_instancing; KHR_node_visibility.
#include "measure/formats/gltf_tree.h"

#include <cmath>
#include <glm/gtc/type_ptr.hpp>

namespace gnomon::importing {
namespace {

/// Parents before children, without recursion: a chain may be as long as the file allows.
template <class Visit>
void walk(const std::vector<std::size_t>& roots, const std::vector<std::vector<std::size_t>>& children, Visit visit) {
  std::vector<std::size_t> open(roots.rbegin(), roots.rend());
  while (!open.empty()) {
    const std::size_t n = open.back();
    open.pop_back();
    visit(n);
    open.insert(open.end(), children[n].rbegin(), children[n].rend());
  }
}

bool hides(const GltfFile& file, const Json& node) {
  const Json* visibility = file.extension_of(node, "KHR_node_visibility");
  return visibility && !flag_in(*visibility, "visible", true);
}

glm::dvec4 unit_rotation(const GltfFile& file, const std::string& where, const glm::dvec4& rotation) {
  if (const double length = glm::length(rotation); !(length > 0 && std::isfinite(length)))
    throw Error("{}: {}: rotation = ({}, {}, {}, {}) is none", file.name(), where, rotation.x, rotation.y, rotation.z,
                rotation.w);
  return glm::normalize(rotation);
}

}  // namespace

GltfTree::GltfTree(const GltfFile& file)
    : file_(file), parents_(file.count("nodes"), none), world_(parents_.size()), is_hidden_(parents_.size()) {
  std::vector<std::vector<std::size_t>> below(size());
  for (std::size_t n = 0; n < size(); ++n) {
    below[n] = children(file_.item("nodes", n), fmt::format("node {}", n), "children");
    for (const std::size_t child : below[n]) {
      if (parents_[child] != none || child == n)
        throw Error("{}: node {} is below more than one node, or below itself", file_.name(), child);
      parents_[child] = n;
    }
  }
  std::vector<std::size_t> roots;
  for (std::size_t n = 0; n < size(); ++n)
    if (parents_[n] == none) roots.push_back(n);
  walk(roots, below, [&](std::size_t n) {
    const glm::dmat4 own = matrix(n);
    world_[n] = parents_[n] == none ? own : world_[parents_[n]] * own;
    is_hidden_[n] = (parents_[n] != none && is_hidden_[parents_[n]]) || hides(file_, file_.item("nodes", n));
    all_.push_back(n);
  });
  if (all_.size() < size()) throw Error("{}: {} nodes are below themselves", file_.name(), size() - all_.size());

  if (file_.count("scenes") > 0) {
    const std::size_t scene = file_.index(file_.root(), "file", "scene").value_or(0);
    roots = children(file_.item("scenes", scene), fmt::format("scene {}", scene), "nodes");
  }
  std::vector<bool> seen(size());
  walk(roots, below, [&](std::size_t n) {
    if (seen[n]) throw Error("{}: node {} is twice in the scene", file_.name(), n);
    seen[n] = true;
    scene_.push_back(n);
  });
}

std::vector<std::size_t> GltfTree::children(const Json& owner, const std::string& where, const char* key) const {
  std::vector<std::size_t> nodes;
  for (const double child : file_.numbers(owner, where, key, 0)) {
    if (!(child >= 0 && child < static_cast<double>(size()) && child == std::floor(child)))
      throw Error("{}: {}: {} names node {} of {}", file_.name(), where, key, child, size());
    nodes.push_back(static_cast<std::size_t>(child));
  }
  return nodes;
}

MotionNode GltfTree::local(std::size_t n) const {
  MotionNode place;
  const Json& node = file_.item("nodes", n);
  const std::string where = fmt::format("node {}", n);
  if (const std::vector<double> m = file_.numbers(node, where, "matrix", 16); !m.empty()) {
    place.matrix = glm::make_mat4(m.data());
    return place;
  }
  const std::vector<double> t = file_.numbers(node, where, "translation", 3), r = file_.numbers(node, where, "rotation", 4),
                            s = file_.numbers(node, where, "scale", 3);
  if (!t.empty()) place.translation = {t[0], t[1], t[2]};
  if (!r.empty()) place.rotation = unit_rotation(file_, where, {r[0], r[1], r[2], r[3]});
  if (!s.empty()) place.scale = {s[0], s[1], s[2]};
  return place;
}

glm::dmat4 GltfTree::matrix(std::size_t n) const {
  const MotionNode place = local(n);
  return place.matrix ? *place.matrix : node_matrix(place.translation, place.rotation, place.scale);
}

std::optional<std::vector<glm::dmat4>> GltfTree::instances(std::size_t n) const {
  const Json* extension = file_.extension_of(file_.item("nodes", n), "EXT_mesh_gpu_instancing");
  const Json* attributes = extension ? object_in(*extension, "attributes") : nullptr;
  if (!attributes) return {};
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
  if (!given) return {};
  const std::size_t count = *given;
  constexpr std::size_t most = 10'000'000;
  if (count > most) throw Error("{}: {}: {} of them; at most {} are read", file_.name(), where, count, most);
  for (const Numbers* numbers : {&t, &r, &s})
    if (!numbers->values.empty() && numbers->count != count)
      throw Error("{}: {} have accessors of {} and {} elements", file_.name(), where, count, numbers->count);
  std::vector<glm::dmat4> matrices;
  for (const Numbers* numbers : {&t, &r, &s})
    for (std::size_t k = 0; k < numbers->values.size(); ++k)
      if (!std::isfinite(numbers->values[k]))
        throw Error("{}: {}: {} of instance {} is not finite", file_.name(), where, numbers->values[k],
                    k / (numbers == &r ? 4 : 3));
  for (std::size_t i = 0; i < count; ++i)
    matrices.push_back(
        node_matrix(t.count ? t.vector(i) : glm::dvec3(0),
                    r.count ? unit_rotation(file_, where, glm::dvec4(r.vector(i), r.at(i, 3))) : glm::dvec4(0, 0, 0, 1),
                    s.count ? s.vector(i) : glm::dvec3(1)));
  return matrices;
}

std::vector<glm::dmat4> GltfTree::places(std::size_t node) const {
  auto matrices = instances(node);
  if (!matrices) return {world_[node]};
  for (glm::dmat4& matrix : *matrices) matrix = world_[node] * matrix;
  return std::move(*matrices);
}

}  // namespace gnomon::importing
