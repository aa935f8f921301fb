#pragma once
// Poses of a scene that moves. Only the harness poses: every technique gets the same float32 points.
#include <gnomon/scene.h>

#include <string>
#include <vector>

namespace gnomon {

/// The value of a track, `width()` numbers: outside of its keys that of the nearest one, at a key exactly that key's; of keys
/// at one time the last counts. Rotations are unit quaternions where the keys are: linear keys by spherical interpolation the
/// short way, cubic ones normalized. Throws Error where a cubic rotation passes 0.
std::vector<double> sampled(const Track& track, double seconds);

/// The nodes with what the tracks of the animation give them at that time; without one as the file has them.
std::vector<MotionNode> nodes_at(const Motion& motion, const Animation* animation, double seconds);
/// World from node, of each.
std::vector<glm::dmat4> node_matrices(const std::vector<MotionNode>& nodes);
/// The same of each node at that time; without an animation in the file's own pose.
std::vector<glm::dmat4> node_matrices(const Motion& motion, const Animation* animation, double seconds);

/// Whether the animation moves what the rig places. A track is on the rig's node, or with a skin on one of its joints, or on a
/// node above these; or a track is on the weights of its targets.
bool moves(const Motion& motion, const Animation& animation, const Rig& rig);
/// The same of each rig of the motion, in one pass.
std::vector<bool> moved_rigs(const Motion& motion, const Animation& animation);

/// Where the animation has the vertices of each rig's mesh at that time; empty for rigs whose flag in `moved` is false. All in
/// double, rounded once: morph targets, then joints in their order or the node, then the placement. Throws Error where the time
/// is below 0 or not finite, and with mesh, vertex and time where a position is outside `coordinate_range`.
std::vector<std::vector<glm::vec3>> posed_positions(const Scene& scene, const Animation& animation, double seconds,
                                                    const std::vector<bool>& moved);

/// Moves the vertices of all meshes that the animation moves to where they are at that time, in place; others keep their bits.
/// A mesh that moves loses its exact shape, a curved one with a note. Throws Error as `posed_positions` does; the scene is then
/// as it was.
void pose(Scene& scene, const Animation& animation, double seconds);

/// What a reference says behind its scene: "@1.5" or "@walk=1.5".
struct PoseTime {
  std::string animation;  ///< empty: the scene's first
  double seconds = 0;
};
/// The animation of that name, or the first. Throws Error with those that there are.
const Animation& animation_of(const Scene& scene, const std::string& name);
/// A scene without views or lights gets those that frame it at rest, so that all its stills have the same.
void add_framing_at_rest(Scene& scene);
/// Poses a scene for good: it has no motion afterwards.
void freeze(Scene& scene, const PoseTime& at);

}  // namespace gnomon
