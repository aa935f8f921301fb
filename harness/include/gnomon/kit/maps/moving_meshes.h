#pragma once
#include <gnomon/kit/maps/light_camera.h>
#include <gnomon/technique.h>

namespace gnomon {

/// Which meshes of a scene move in its row, as Mesh::reach says, and how often the scene was built and updated. What belongs to
/// one light looks at this, in what all lights share, to find how old it is.
class MovingMeshes {
 public:
  struct Number {
    std::uint64_t builds = 0, updates = 0;
    /// Whether nothing but updates came after `earlier`, one at least.
    bool is_update_of(const Number& earlier) const { return builds == earlier.builds && updates > earlier.updates; }
  };

  void build(const Scene& scene);
  /// Whether what build found still holds: each mesh has the reach that it had, and none without one moved. False: build.
  [[nodiscard]] bool update(const Scene& scene, const Changes& changes);
  const Number& number() const { return number_; }
  /// Whether a mesh is none of those that stand still.
  bool moves(std::size_t mesh) const { return !reaches_.empty() && !reaches_[mesh].empty(); }
  /// Whether some casters move and others stand still.
  bool divide(const MeshBoxes& boxes) const;
  /// Where the vertices of a mesh that moves are now.
  const Bounds& place(std::size_t mesh) const { return places_[mesh]; }
  /// Whether its vertices moved after `earlier`, since which nothing but updates came.
  bool moved_after(std::size_t mesh, const Number& earlier) const { return moved_at_[mesh] > earlier.updates; }
  std::size_t bytes() const { return reaches_.size() * (2 * sizeof(Bounds) + sizeof(std::uint64_t)); }

 private:
  // None where no mesh moves.
  std::vector<Bounds> reaches_, places_;
  std::vector<std::uint64_t> moved_at_;  // numbers of updates
  Number number_;
};

/// The parameter `update` of techniques that draw casters into maps, and what it means. A member of the technique, which hands
/// it on to DepthImages::StillLayer::start_relight.
class UpdateSetting {
 public:
  explicit UpdateSetting(Parametrized* owner, std::string_view sentence = depths_alone)
      : how_(owner, "update", "layers", {"layers", "redraw"}, Stage::relight, sentence) {}
  static constexpr std::string_view depths_alone =
      "Where some casters move and others do not: layers draws those that stand still into an image of their own. The first "
      "relight after an update, or the resolve after it where that draws, keeps this image, and draws the others over a copy of "
      "it. redraw draws all. What is made of the depths is made anew.";

  bool keeps_layers() const { return how_.is("layers"); }

 private:
  Choice how_;
};

}  // namespace gnomon
