#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace gnomon {

// How the meshes of a scene move, as data: a tree of nodes, tracks of keys that move them, and what places each vertex. All in
// double; the harness alone poses (measure/scene/pose.h) and rounds once to float32. Source: Khronos, glTF 2.0 specification
// (ISO/IEC 12113:2022), sections 3.7.3 (skins), 3.11 (animations) and Appendix C (interpolation).

/// A place in the tree: a matrix, or translation after rotation after scale. Local: parent from node.
struct MotionNode {
  static constexpr std::uint32_t none = 0xffffffffu;
  std::uint32_t parent = none;       ///< of a smaller number than the node's own
  std::optional<glm::dmat4> matrix;  ///< in place of the three that follow; no track moves it
  glm::dvec3 translation{0};         ///< meters
  glm::dvec4 rotation{0, 0, 0, 1};   ///< unit quaternion x, y, z, w
  glm::dvec3 scale{1};
  std::vector<double> weights;  ///< of the morph targets of its mesh
};

/// Parent from node: scaled first, then turned by the unit quaternion x, y, z, w, then moved. All readers and poses use it, so
/// that equal values give equal bits.
glm::dmat4 node_matrix(const glm::dvec3& translation, const glm::dvec4& rotation, const glm::dvec3& scale);

/// The keys of one property of one node.
struct Track {
  enum class Property : std::uint8_t { translation, rotation, scale, weights };
  enum class Interpolation : std::uint8_t { step, linear, cubic };
  std::uint32_t node = 0;
  Property property = Property::translation;
  Interpolation interpolation = Interpolation::linear;
  std::vector<double> times;   ///< seconds, ascending; one at least
  std::vector<double> values;  ///< key after key; of a cubic key its in-tangents, its values, its out-tangents
  /// Numbers of one value: 3, 4, or as many as there are weights.
  std::size_t width() const { return values.size() / times.size() / (interpolation == Interpolation::cubic ? 3 : 1); }
};

struct Animation {
  std::string name;  ///< plain, unique in a scene
  std::vector<Track> tracks;
  /// The last key's time, seconds; it begins at 0.
  double end() const;
};

struct Skin {
  std::vector<std::uint32_t> joints;     ///< nodes
  std::vector<glm::dmat4> inverse_bind;  ///< of each joint: joint from mesh at rest
};

/// Where a description puts what a file holds: scaled, then turned about x, y and z in this order, then moved.
struct Placement {
  glm::dvec3 scale{1}, rotate_degrees{0}, translate{0};
  glm::dvec3 apply(const glm::dvec3& p) const;
};

/// What places the vertices of one mesh: morph targets first, then the joints of a skin or else the node, then the placement.
struct Rig {
  static constexpr std::uint32_t no_skin = 0xffffffffu;
  std::uint32_t mesh = 0;  ///< of the scene
  std::uint32_t node = 0;  ///< carries the weights; places the mesh where it has no skin
  std::uint32_t skin = no_skin;
  Placement placement;
  std::vector<glm::dvec3> base;  ///< of each vertex, before all of that
  /// Of each target what it adds to each vertex at weight 1, one target after the other.
  std::vector<glm::dvec3> targets;
  std::uint32_t joints_per_vertex = 0;  ///< 0 without a skin
  std::vector<std::uint32_t> joints;    ///< of each vertex, of the skin; one of weight 0 counts for nothing
  std::vector<double> weights;          ///< of these
};

struct Motion {
  std::vector<MotionNode> nodes;
  std::vector<Animation> animations;  ///< one at least
  std::vector<Skin> skins;
  std::vector<Rig> rigs;  ///< of meshes of which an animation moves a place; at most one for each
};

}  // namespace gnomon
