#pragma once
#include <gnomon/kit/add_up.h>

#include "visible_area.h"

namespace gnomon::area_svbsp {

/// A node, from 0 up; a cell where all of the light is seen or nothing of it; or a cell of the penumbra, from -3 down.
using Link = std::int32_t;
constexpr Link lit_cell = -1, umbra_cell = -2;
constexpr Link penumbra_cell(std::size_t number) { return -3 - static_cast<Link>(number); }
constexpr bool is_penumbra(Link link) { return link <= -3; }
constexpr std::size_t number_of(Link link) { return static_cast<std::size_t>(-3 - link); }

/// A plane of a volume, or a border of tiles.
struct Node {
  ClipPlane plane;
  Link sides[2];  ///< negative; zero and positive
};

/// A cell in which some polygons may hide a part of the light, and no other one does.
struct Penumbra {
  std::uint32_t first, count;          ///< polygons, of Tree::polygons; `open`: too many, none are listed
  std::uint32_t corner, corner_count;  ///< of Tree::corners where corners are shaded; else none
  static constexpr std::uint32_t open = 0xffffffffu;
};

/// A corner of a fragment of the penumbra, and how much of the light it sees.
struct ShadedCorner {
  glm::dvec3 at;
  double share;
};

/// The tree of one side of a triangle: cells are the fragments that it is divided into.
struct Tree {
  Link root = lit_cell;
  std::vector<Node> nodes;
  std::vector<Penumbra> penumbras;
  std::vector<std::uint32_t> polygons;
  std::vector<ShadedCorner> corners;

  Link locate(const glm::dvec3& point, std::uint64_t& visits) const {
    Link link = root;
    for (; link >= 0; ++visits) link = nodes[link].sides[nodes[link].plane.at(point) >= 0];
    return link;
  }
  std::size_t bytes() const { return bytes_of(nodes, penumbras, polygons, corners); }
};

/// How fragments are made.
struct Rules {
  double epsilon = 0;            ///< meters: as near to a plane is on it
  double least_width = 0;        ///< meters: narrower fragments are divided no more
  double largest = INFINITY;     ///< meters: longer fragments of the penumbra are
  int light_splits = 0;          ///< halvings of the light, one within the other
  std::uint32_t tile_size = 16;  ///< volumes whose planes cross a fragment; with more it is halved first
  std::uint32_t most_listed = 64;
  bool asks_corners = false;  ///< whether the light is clipped from the corners of fragments
};

struct Work {
  std::uint64_t tests = 0;                         ///< fragments against volumes
  std::uint64_t lit = 0, penumbra = 0, umbra = 0;  ///< fragments
  std::uint64_t halved = 0, cuts = 0;              ///< by borders of tiles; by planes of volumes
  std::uint64_t light_parts = 0;                   ///< parts of the light whose umbra was looked for
  std::uint64_t clips = 0;                         ///< of the light by a polygon, from corners and middles of fragments
  std::uint64_t stopped = 0;                       ///< fragments left whole because their share of the work was spent
  /// In tests: to clip the light by a polygon takes as long as some ten of them.
  std::uint64_t spent() const { return tests + 10 * clips; }
  Work& operator+=(const Work& w) {
    return add_up(*this, w, &Work::tests, &Work::lit, &Work::penumbra, &Work::umbra, &Work::halved, &Work::cuts,
                  &Work::light_parts, &Work::clips, &Work::stopped);
  }
};

/// What all trees of a light are made of. Everything outlives the division.
struct Lighting {
  const Casters* casters = nullptr;
  const Volumes* volumes = nullptr;
  const LightBody* body = nullptr;
  Light light;
};

/// How much of a light a point sees past polygons, by their numbers.
double seen_past(std::span<const CasterPolygon> casters, std::span<const std::uint32_t> polygons, const glm::dvec3& point,
                 const LightFigure& figure, VisibleArea& area);

/// Divides one side of a triangle into fragments that see all of the light, a part of it, or nothing. A fragment is cut by the
/// planes of the penumbra volumes of polygons until it is inside one of them or outside all, and in there by those of umbra
/// volumes. What is in the penumbra of one polygon is not cut by the penumbra volumes of others: their polygons are only
/// listed.
class Divider {
 public:
  Divider(const Lighting& lighting, const Rules& rules) : lighting_(lighting), rules_(rules) {}

  /// `polygon` is the triangle, or the part of it on one side of a flat light's plane; `volumes` those that it may lie in or
  /// across; `normal` is unit, on the side that is queried. Once it has `spent` so many tests fragments are left whole, and
  /// points in them clip the light for themselves.
  void run(std::span<const Corner> polygon, const glm::dvec3& normal, std::span<const std::uint32_t> volumes,
           std::uint64_t most_tests, Tree& tree, Work& work);

 private:
  /// Volumes that crossed the fragment when it was halved last, and the time before.
  struct Crowd {
    std::size_t last = 0xffffffffu, before = 0xffffffffu;
  };
  struct Fragment {
    Slice part;           ///< corners, of corners_
    Slice list;           ///< volumes, of lists_
    bool is_dim = false;  ///< inside a penumbra volume
    Crowd crowd;
  };
  std::span<const Corner> corners(const Slice& part) const { return {corners_.data() + part.first, part.count}; }
  std::span<const std::uint32_t> volumes(const Slice& list) const { return {lists_.data() + list.first, list.count}; }
  const Volume& volume(std::size_t place) const { return lighting_.volumes->all()[lists_[place]]; }

  static Fragment with_part(Fragment fragment, const Slice& part) {
    fragment.part = part;
    return fragment;
  }
  /// A cell of this kind, which is counted.
  Link counted(std::uint64_t Work::*kind, Link cell) {
    ++(work_->*kind);
    return cell;
  }

  /// Divides a fragment. Its memory, and all that is taken meanwhile, is free again afterwards.
  Link divide(const Fragment& fragment);
  /// The volumes in the list that the fragment is not outside of are listed anew; says whether one hides all of the light.
  bool filter(Fragment& fragment, std::size_t& crossing_count);
  Link divide_filtered(Fragment& fragment, std::size_t crossing_count);
  /// The planes of the penumbra or umbra volume that reaches into a fragment by the fewest planes; none: empty.
  std::span<const ClipPlane> best_planes(const Fragment& fragment, bool of_umbra);
  /// Cuts by planes, one after the other; what is inside all of them is umbra or dim.
  Link cut_by(Fragment fragment, std::span<const ClipPlane> planes, bool is_umbra);
  Link halve(Fragment fragment, std::size_t crossing_count);
  /// Where nothing of the light is seen from the middle: umbra of parts of the light together.
  Link divide_light(Fragment& fragment);
  /// Whether polygons hide each half of a light, or half of a half, from all of a fragment. Where not, `planes` has those of an
  /// umbra volume, of a part that is halved no more, that reaches into the fragment, if the first part not hidden has one.
  bool is_hidden(const Fragment& fragment, const LightBody& light, int splits, std::vector<ClipPlane>& planes);
  /// With corners only where every fragment is as short as the rules require.
  Link add_penumbra(const Fragment& fragment, bool has_corners);

  /// The parts on the negative and on the positive side of a plane that a part lies across, at the end of corners_.
  std::pair<Slice, Slice> cut(const Slice& part, const ClipPlane& plane);
  /// Whether some of a part, of this width at least, is inside all planes.
  bool reaches_into(const Slice& part, std::span<const ClipPlane> planes, double least_width);
  glm::dvec3 middle(const Slice& part) const;
  double share_at(const glm::dvec3& point, std::span<const std::uint32_t> polygons);

  const Lighting& lighting_;
  const Rules rules_;
  std::vector<Corner> corners_;
  std::vector<double> values_;
  std::vector<std::uint32_t> lists_, polygons_;
  Clipper clipper_;
  VisibleArea area_;
  Tree* tree_ = nullptr;
  Work* work_ = nullptr;
  glm::dvec3 normal_{0};
  std::uint64_t most_spent_ = 0;
};

}  // namespace gnomon::area_svbsp
