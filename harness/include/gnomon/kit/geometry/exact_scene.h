#pragma once
#include <gnomon/changes.h>
#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/geometry/crossings.h>
#include <gnomon/kit/geometry/receiver.h>

namespace gnomon {

struct ExactAnswer {
  bool blocked = false;
  bool degenerate = false;  ///< blocked, but only by edges or vertices that the segment goes through exactly
  bool operator==(const ExactAnswer&) const = default;
};

/// The same of a scene with transmission.
struct ExactShare {
  Crossings::Product light;  ///< that arrives: 0 exactly where an opaque caster blocks it
  bool degenerate = false;   ///< as of ExactAnswer; or not blocked, and through an edge or vertex of what lets light through
};

/// Work of exact queries.
struct ExactTally {
  std::uint64_t rays = 0, triangles = 0, degenerate = 0;
  SignTally signs;
  ExactTally& operator+=(const ExactTally& other) {
    using Tally = ExactTally;
    return add_up(*this, other, &Tally::rays, &Tally::triangles, &Tally::degenerate, &Tally::signs);
  }
};

/// How close a segment passes by edges that could change its answer; infinite when no edge is within the limit.
struct EdgeMargin {
  double clearance = INFINITY;  ///< smallest distance from the segment to an edge, meters
  double carried = INFINITY;    ///< the same, each scaled from its edge's place to the receiver by |PL| / |Le|
};

/// All casting triangles of a scene as they are, with the holes of their alpha masks and without shapes, behind exact
/// predicates. Shares no code with the ray tracer that it certifies. The scene must outlive it. Every query may run on many
/// threads.
class ExactScene {
 public:
  explicit ExactScene(const Scene& scene);
  /// Vertices of the scene moved in place since it was built or updated last. Answers are then those of a scene that is built
  /// there. The tree is refitted, and built anew where it has decayed or triangles lost or got their area.
  void update(const Changes& changes);

  /// Whether a caster blocks the way to a homogeneous light. Triangles are closed: a way through an edge or a vertex is
  /// blocked. Those with transmission block nothing.
  ExactAnswer occluded(const Receiver& receiver, const glm::dvec4& light, ExactTally& tally) const;

  /// What part of a homogeneous light arrives: 0 where it is blocked, else the product of what the triangles let through that
  /// the way crosses.
  ExactShare transmitted(const Receiver& receiver, const glm::dvec4& light, ExactTally& tally) const;
  bool has_transmission() const { return has_transmission_; }

  /// What part arrives (red of three) at every pixel that faces the light, on all threads: 1 lit, 0 blocked, 1 where not
  /// facing.
  ExactTally decide(const GBuffer& gbuffer, const Light& light, std::span<float> visibility) const;

  /// Margin of a segment to the edges of the casters that can occlude the receiver, looking `limit` meters far. An edge between
  /// the receiver's triangle and a neighbor out of its plane is among them: a receiver that rounding put below its plane may
  /// be blocked by that neighbor. In double, so its own rounding is eight digits below that of the coordinates.
  EdgeMargin edge_margin(const Receiver& receiver, const glm::dvec4& light, double limit) const;

  /// Of one that is built where the scene is now: how many boxes a refitted tree has depends on where it was built.
  std::size_t bytes() const {
    return is_refitted_ ? ExactScene(*scene_).bytes() : tree_.bytes() + bytes_of(casters_, left_out_);
  }

 private:
  struct Caster {
    Triangle corners;
    std::uint32_t mesh, triangle;
  };
  struct Named {
    std::uint32_t mesh, triangle;
  };
  /// Answers whether the tree may stay.
  bool refit(const Changes& changes);
  bool leaves_out(const Receiver& receiver, const Caster& caster) const {
    return receiver.is_own(caster.mesh, caster.triangle) || receiver.is_coplanar(*scene_, caster.corners.points);
  }

  const Scene* scene_;
  bool has_transmission_ = false;
  BoxTree tree_;
  std::vector<Caster> casters_;  ///< in the order of the tree
  std::vector<Named> left_out_;  ///< those without area
  bool is_refitted_ = false;     ///< since it was built
  double built_cost_ = 0;        ///< of the tree, once it is refitted
};

}  // namespace gnomon
