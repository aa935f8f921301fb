// Vertices of glTF by morph targets and by the joints of skins, in the file's own pose.
// Source: Khronos, glTF 2.0 specification (ISO/IEC 12113:2022), 3.7.2.2 (morph targets) and 3.7.3 (skins).
#include "measure/formats/gltf_deform.h"

#include <cmath>
#include <glm/gtc/type_ptr.hpp>

#include "measure/formats/gltf_mesh.h"

namespace gnomon::importing {

GltfSkin read_skin(const GltfFile& file, std::size_t index) {
  GltfSkin skin;
  const Json& json = file.item("skins", index);
  const std::string where = fmt::format("skin {}", index);
  const std::size_t node_count = file.count("nodes");
  for (const double name : file.numbers(json, where, "joints", 0)) {
    if (!(name >= 0 && name < static_cast<double>(node_count) && name == std::floor(name)))
      throw Error("{}: {} names node {} of {}", file.name(), where, name, node_count);
    skin.joints.push_back(static_cast<std::size_t>(name));
  }
  skin.inverse_bind.assign(skin.joints.size(), glm::dmat4(1));
  const auto inverse = file.index(json, where, "inverseBindMatrices");
  if (!inverse) return skin;
  const Numbers numbers = file.read(*inverse, 16);
  if (numbers.count < skin.joints.size())
    throw Error("{}: {} has {} joints and {} inverse bind matrices", file.name(), where, skin.joints.size(), numbers.count);
  for (std::size_t j = 0; j < skin.joints.size(); ++j) skin.inverse_bind[j] = glm::make_mat4(&numbers.values[16 * j]);
  return skin;
}

std::size_t morph_target_count(const GltfFile& file, const Json& node, const std::string& where) {
  const auto mesh = file.index(node, where, "mesh");
  const Json* primitives = mesh ? list_in(file.item("meshes", *mesh), "primitives") : nullptr;
  if (!primitives) return 0;
  for (const Json& primitive : *primitives)
    if (const Json* targets = list_in(primitive, "targets"); targets && !targets->empty()) return targets->size();
  return 0;
}

std::vector<double> morph_weights(const GltfFile& file, const Json& node, const Json& mesh, const std::string& where,
                                  std::size_t target_count) {
  std::vector<double> weights = file.numbers(node, where, "weights", 0);
  if (weights.empty()) weights = file.numbers(mesh, where, "weights", 0);
  if (weights.empty()) weights.resize(target_count);
  if (weights.size() != target_count)
    throw Error("{}: {} has {} morph targets and {} weights", file.name(), where, target_count, weights.size());
  return weights;
}

/// Of the vertices that faces use.
void GltfMeshes::check_targets(const Primitive& primitive, const ImportedMesh& mesh) const {
  const std::size_t count = mesh.positions.size();
  std::vector<bool> used(count);
  for (const std::uint32_t corner : mesh.corners) used[corner] = true;
  for (std::size_t i = 0; i < mesh.targets.size(); ++i)
    if (const glm::dvec3& move = mesh.targets[i]; used[i % count] && !std::isfinite(move.x + move.y + move.z))
      throw Error("{}: {}, target {} moves vertex {} by ({}, {}, {}), which is not finite", file_.name(), primitive.where,
                  i / count, i % count, move.x, move.y, move.z);
}

/// Sets the positions, morphed. Keeps the base and the targets where an animation may need them.
void GltfMeshes::add_positions(const Primitive& primitive, ImportedMesh& mesh) {
  const std::size_t accessor = *attribute(primitive, "POSITION");
  if (file_.extension_of(primitive.json, "KHR_draco_mesh_compression") &&
      !file_.item("accessors", accessor).contains("bufferView"))
    throw Error("{}: {} is compressed by KHR_draco_mesh_compression, which is not read", file_.name(), primitive.where);
  if (!last_ || last_->first != accessor) last_.emplace(accessor, file_.read(accessor, 3));  // primitives may share it
  const Numbers& numbers = last_->second;
  std::vector<glm::dvec3>& positions = mesh.positions;
  positions.resize(numbers.count);
  for (std::size_t v = 0; v < numbers.count; ++v) positions[v] = numbers.vector(v);

  const Json* targets = list_in(primitive.json, "targets");
  if (!targets) return;
  const std::vector<double> shares = morph_weights(file_, primitive.node, primitive.mesh, primitive.where, targets->size());
  const bool is_kept = motion_.moves_mesh(primitive.mesh_index);
  if (is_kept) {
    mesh.base = positions;
    mesh.targets.resize(targets->size() * numbers.count);
  }
  for (std::size_t t = 0; t < targets->size(); ++t) {
    if (shares[t] == 0 && !is_kept) continue;
    const auto moves = file_.index(targets->at(t), fmt::format("{}, target {}", primitive.where, t), "POSITION");
    if (!moves) continue;
    const Numbers target = file_.read(*moves, 3);
    if (target.count != numbers.count)
      throw Error("{}: {}, target {} moves {} vertices of {}", file_.name(), primitive.where, t, target.count, numbers.count);
    for (std::size_t v = 0; v < numbers.count; ++v) {
      const glm::dvec3 move = target.vector(v);
      if (shares[t] != 0) positions[v] += shares[t] * move;
      if (!is_kept) continue;
      mesh.targets[t * numbers.count + v] = move;
    }
  }
}

/// Reads the joints of each vertex and their weights, of all sets. A joint of weight 0 may have any number in the file, and is
/// 0 here.
void GltfMeshes::add_joints(const Primitive& primitive, std::size_t joint_count, ImportedMesh& mesh) {
  const std::size_t vertex_count = mesh.positions.size();
  std::vector<std::pair<Numbers, Numbers>> sets;
  bool is_float = true;
  for (std::size_t set = 0;; ++set) {
    const auto joint_accessor = attribute(primitive, fmt::format("JOINTS_{}", set).c_str());
    const auto weight_accessor = attribute(primitive, fmt::format("WEIGHTS_{}", set).c_str());
    if (!joint_accessor || !weight_accessor) {
      if (set == 0 || joint_accessor != weight_accessor)
        throw Error("{}: {} has a skin but not both JOINTS_{} and WEIGHTS_{}", file_.name(), primitive.where, set, set);
      break;
    }
    double largest = 0;
    auto& [joint, weight] = sets.emplace_back(file_.read_indices(*joint_accessor, 4, largest), file_.read(*weight_accessor, 4));
    if (joint.count != vertex_count || weight.count != vertex_count)
      throw Error("{}: {} has {} vertices, joints for {} and weights for {}", file_.name(), primitive.where, vertex_count,
                  joint.count, weight.count);
    constexpr std::size_t float32 = 5126;
    is_float = is_float && file_.index(file_.item("accessors", *weight_accessor), primitive.where, "componentType") == float32;
  }
  mesh.joints_per_vertex = static_cast<std::uint32_t>(4 * sets.size());
  mesh.joints.reserve(mesh.joints_per_vertex * vertex_count);
  mesh.weights.reserve(mesh.joints_per_vertex * vertex_count);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    double sum = 0, count = 0;
    for (const auto& [joint, weight] : sets)
      for (std::size_t k = 0; k < 4; ++k) {
        const bool counts = weight.at(v, k) != 0;
        if (counts && joint.at(v, k) >= static_cast<double>(joint_count))
          throw Error("{}: {}, vertex {} names joint {} of {}", file_.name(), primitive.where, v, joint.at(v, k), joint_count);
        mesh.joints.push_back(counts ? static_cast<std::uint32_t>(joint.at(v, k)) : 0);
        mesh.weights.push_back(weight.at(v, k));
        sum += weight.at(v, k);
        count += counts;
      }
    // Four weights of 8 bits are off by 0.01 at most; of float weights the specification allows 2e-7 each.
    odd_weights_ += !(std::abs(sum - 1) <= (is_float ? 2e-7 * count : 0.01));
  }
}

/// Places each vertex by the weighted sum of its joints' matrices.
void GltfMeshes::pose(std::size_t skin, ImportedMesh& mesh) {
  if (!last_skin_ || last_skin_->first != skin) {
    const GltfSkin& joints = motion_.skin(skin);
    std::vector<glm::dmat4> matrices;
    for (std::size_t j = 0; j < joints.joints.size(); ++j)
      matrices.push_back(tree_.world()[joints.joints[j]] * joints.inverse_bind[j]);
    last_skin_.emplace(skin, std::move(matrices));
  }
  const std::vector<glm::dmat4>& matrices = last_skin_->second;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    glm::dmat4 sum(0);
    for (std::size_t k = v * mesh.joints_per_vertex; k < (v + 1) * mesh.joints_per_vertex; ++k)
      if (mesh.weights[k] != 0) sum += mesh.weights[k] * matrices[mesh.joints[k]];
    mesh.positions[v] = glm::dvec3(sum * glm::dvec4(mesh.positions[v], 1));
  }
}

}  // namespace gnomon::importing
