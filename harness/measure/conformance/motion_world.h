#pragma once
#include <gnomon/kit/rays/rays.h>
#include <gnomon/technique.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "measure/conformance/world.h"
#include "measure/scene/posed_scene.h"

namespace gnomon::conformance {

/// A light, a sun, a ground and a box that stand still; a box that walks, one that shrinks to a point and comes back, and one
/// that moves through the light. With sheets also a strip that two joints bend, and two triangles that have no area for a
/// while. All have below 300 triangles, and one animation, see MovingWorld.
Scene moving_things(bool has_sheets);
/// A ball that stands still, with its exact shape, over a ground that moves and does not cast.
Scene moving_ground();

/// A scene that is moved in place through the frames of its first animation, at 48 x 27 pixels.
class MovingWorld {
 public:
  static constexpr int frame_count = 33;      ///< of all animations here
  static constexpr double frame_rate = 8;     ///< a second
  static constexpr int inside_frame = 8;      ///< the point light is inside of a caster
  static constexpr int touched_frame = 12;    ///< the point light is on a caster's face
  static constexpr int collapsed_frame = 16;  ///< two triangles have no area
  static constexpr int gone_frame = 24;       ///< a caster is a point

  /// Width and height of pictures are divided by `part`.
  MovingWorld(Scene the_scene, Truth the_truth, int part = 1);
  MovingWorld(const MovingWorld&) = delete;

  const Scene& scene() const { return scene_; }
  void go_to(int frame);
  int frame() const { return frame_; }
  /// What moved since the last call, or since the world was made.
  Changes take_changes() { return posed_.take_changes(); }
  /// What the eye sees in the present frame. Made once for each; it stays where it is.
  const GBuffer& gbuffer();
  /// The same from another view, made anew.
  GBuffer gbuffer(const View& view) const;
  /// In the present frame. Under a light with area the share that the technique estimates.
  World::Truthful reference(const Light& light, LightShareKind estimates = LightShareKind::area);
  /// The pixels of class T in the present frame.
  std::vector<bool> tested(const Light& light);

 private:
  RowPose row_pose() const;

  Scene scene_;
  Truth truth_;
  int part_, frame_ = 0;
  std::optional<FrameStore> frames_;  ///< of the scene at rest; made when it is first needed, which moves nothing that counts
  PosedScene posed_;
  std::map<int, GBuffer> gbuffers_;
};

class Trial;

/// The first scene that moves of which the technique supports a light, and these lights; none where it supports none.
struct SupportedWorld {
  std::unique_ptr<MovingWorld> world;
  std::vector<Light> lights;
};
SupportedWorld supported_world(const Trial& trial);

/// Where two masks of the present frame must be the same, or as near as the technique states.
class Equality {
 public:
  Equality(Trial& trial, MovingWorld& world, const Light& light) : trial_(trial), world_(world), light_(light) {}
  /// `when` begins the finding.
  void expect(const std::vector<float>& a, const std::vector<float>& b, const std::string& when) const;

 private:
  Trial& trial_;
  MovingWorld& world_;
  const Light& light_;
};

/// Of a track: seconds and the numbers of its value.
struct Key {
  double seconds;
  std::vector<double> values;
};
/// Adds a track between whose keys values change evenly to the first animation.
void add_track(Motion& motion, std::uint32_t node, Track::Property property, const std::vector<Key>& keys);
/// Adds a mesh that a new node places; at rest it is `at`, and it has no exact shape. Answers the node.
std::uint32_t add_placed(Scene& scene, Motion& motion, Mesh mesh, const glm::vec3& at);

/// The changes of a scene in which nothing moved.
Changes no_changes(const Scene& scene);

}  // namespace gnomon::conformance
