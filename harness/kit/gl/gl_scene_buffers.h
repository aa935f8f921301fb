#pragma once
// Private to the inputs of OpenGL: what tells a scene from another one, and its triangles on the device.
#include <gnomon/kit/gl/gl.h>

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

/// The triangles of a scene. Those of a scene with motion can be moved.
SceneBuffers upload_scene(const Scene& scene);
/// Whether these buffers, of what has the scene's identity, can take its vertices.
bool can_take_positions(const Scene& scene, const SceneBuffers& buffers);
/// Writes all vertices of a scene where its buffers have them; the rest stays. Returns how many bytes.
std::size_t upload_positions(const Scene& scene, SceneBuffers& buffers);

}  // namespace gnomon
