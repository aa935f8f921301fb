#pragma once
// Private to the inputs of OpenGL: what tells a scene from another one, and its triangles on the device.
#include <gnomon/kit/gl/gl.h>
#include <gnomon/kit/unset_vector.h>

namespace gnomon {

/// Tells a new scene at an old address, and a new pose, from the old one without reading all of it. It misses an edit in place
/// that raises no Scene::pose_number and leaves four vertices of some meshes alone: call release_inputs after one.
struct SceneStamp {
  std::uint64_t identity = 0;  ///< of addresses and sizes of arrays, of flags, and of a triangle of some meshes
  std::uint64_t pose_number = 0;
  std::uint64_t sample = 0;  ///< of four vertices of some meshes, and of whether their shapes are curved

  explicit SceneStamp(const Scene& scene);
  SceneStamp() = default;
  bool operator==(const SceneStamp&) const = default;
  /// Whether it is the other one's scene with its vertices moved since.
  bool is_later_pose_of(const SceneStamp& other) const { return identity == other.identity && pose_number > other.pose_number; }
};

/// The vertices that buffers hold, in memory: what a new pose is compared with. Empty where a scene cannot move. It is a mirror
/// of the harness's own buffers, and counts as nobody's memory.
using UploadedPositions = UnsetVector<glm::vec3>;

/// The triangles of a scene. Those of a scene with motion can be moved.
SceneBuffers upload_scene(const Scene& scene, UploadedPositions& uploaded);
/// Whether these vertices, of what has the scene's identity, can be moved to where the scene has them.
bool can_take_positions(const Scene& scene, const UploadedPositions& uploaded);
/// Writes vertices of a scene where its buffers have them: of each mesh the range that holds all whose bits differ. The rest
/// stays. Returns how many bytes.
std::size_t upload_positions(const Scene& scene, const SceneBuffers& buffers, UploadedPositions& uploaded);

}  // namespace gnomon
