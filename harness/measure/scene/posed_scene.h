#pragma once
// A scene whose vertices are moved in place, frame after frame.
#include <gnomon/changes.h>

#include <optional>
#include <string>

#include "measure/scene/pose.h"

namespace gnomon {

/// Most frames of a row whose geometry moves.
inline constexpr int most_motion_frames = 10'000;

/// A pose as a row's frame has it: the time of an animation, and all times of the row, over which meshes have their reach.
/// Times are `start + n / frame_rate`, n = 0 .. frames - 1.
struct RowPose {
  std::string animation;  ///< never empty
  double seconds = 0;
  double start = 0, frame_rate = 60;
  int frames = 1;
  bool operator==(const RowPose&) const = default;
  /// The same row: animation and all times.
  bool is_of_row(const RowPose& other) const;
};

/// The pose of a path's frame; nothing where it moves no geometry.
std::optional<RowPose> pose_at(const Path& path, int frame);

/// Hash of the positions of all meshes, to the bit: processes that must have the same pose compare it.
std::string pose_hash(const Scene& scene);

/// A pose, and the hash of the positions that it must give (pose_hash): another is an Error, for two programs would then look
/// at different scenes.
struct WantedPose {
  RowPose at;
  std::string hash;
};

/// Moves one scene from pose to pose and tells by how much it moved. The scene must outlive it, stay at its address and be
/// moved by nobody else. Arrays of positions keep their addresses.
class PosedScene {
 public:
  /// At rest: the positions that the scene has now.
  explicit PosedScene(Scene& scene);
  PosedScene(const PosedScene&) = delete;
  PosedScene& operator=(const PosedScene&) = delete;
  /// Moves the meshes to this pose, or back to rest; does nothing where they are there. A pose of another row, or rest after
  /// one, also gives each mesh its `Mesh::reach`. Raises Scene::pose_number where a position changed. Meshes that the animation
  /// moves have no exact shape until they are at rest again; no note says so. Answers whether the pose is of the row that the
  /// one before was of: otherwise what is known of the scene counts for nothing. Throws Error as posed_positions() does, and on
  /// times that are no row's; the scene is then as it was.
  bool go_to(const std::optional<RowPose>& at);
  const std::optional<RowPose>& now() const { return now_; }
  /// What moved since the last call, or since the beginning: by comparing bits.
  Changes take_changes();
  /// Whether take_changes() would tell of any.
  bool has_moved() const;
  /// pose_hash of the present pose; empty at rest. Found once for each pose.
  const std::string& hash();

 private:
  /// A mesh with a rig.
  struct Moving {
    std::vector<glm::vec3> rest, taken;  ///< positions at rest, and at the last take_changes()
    std::optional<Shape> shape;          ///< at rest
  };
  Mesh& mesh_of(std::size_t rig) { return scene_.meshes[scene_.motion->rigs[rig].mesh]; }
  const Mesh& mesh_of(std::size_t rig) const { return scene_.meshes[scene_.motion->rigs[rig].mesh]; }
  std::vector<MotionNode> nodes_of(const std::optional<RowPose>& at) const;

  Scene& scene_;
  std::vector<Moving> moving_;             ///< of each rig
  std::optional<RowPose> now_, taken_at_;  ///< the pose of the last take_changes()
  std::uint64_t taken_number_ = 0;         ///< its Scene::pose_number
  std::vector<Bounds> taken_bounds_;       ///< of each mesh there; empty before the first call
  std::string hash_;                       ///< of the present pose, where it was requested
};

}  // namespace gnomon
