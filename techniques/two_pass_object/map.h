#pragma once
#include "cell.h"

namespace gnomon::two_pass_object {

/// What is asked for its light.
struct Asked {
  static constexpr std::uint32_t none = 0xffffffffu;
  glm::vec3 point{0};
  std::uint32_t triangle = none;  ///< its own; none: on a body's exact shape
  std::uint32_t first_own = 0,
                end_own = 0;  ///< triangles of a body that leaves itself out
};

struct Tally {
  std::uint64_t points = 0, asked = 0;  ///< located; decided by the triangles of their cell, one by one
  Tally& operator+=(const Tally& t) {
    points += t.points, asked += t.asked;
    return *this;
  }
};

/// The triangles as the light sees them, in the cells of a grid whose crowded cells have grids of their own, and in each cell
/// the lit pieces of what it holds.
class LightMap {
 public:
  void clear() { patches_.clear(), roots_.clear(), work_ = {}; }
  void make(const Triangles& triangles, double cell_triangles);

  bool is_lit(const Triangles& triangles, const Asked& asked, Tally& tally) const;
  /// The first triangle that shades a point, of those in its cell; none.
  std::uint32_t shading(const Triangles& triangles, const Asked& asked) const;
  /// Casters that took something from the point's triangle in its cell; 0 where it is not found.
  std::uint32_t clips_at(const Triangles& triangles, const Asked& asked) const;

  /// Calls visit(face, cell, triangles) for all cells of a patch.
  template <class Visit>
  void for_leaves(std::size_t patch, Visit&& visit) const;
  std::size_t patch_count() const { return patches_.size(); }
  const Work& work() const { return work_; }
  std::size_t bytes() const;

 private:
  static constexpr std::size_t patch_cells = 64;
  struct Face {
    Node node;
    std::uint32_t first_root = 0, first_patch = 0;
    double margin = 0;
  };
  struct Place {
    const Patch* patch = nullptr;  ///< none beside all triangles
    const Node* cell = nullptr;
    int face = 0;
    Seen seen{};
  };
  /// A grid being made.
  struct Maker {
    const Triangles& triangles;
    const std::vector<Footprint>& footprints;
    int face;
    double margin, crowd;
    Patch& patch;
    CellClipper clipper;
    std::vector<std::uint32_t> triangles_here = {};
    void fill(std::uint32_t node, std::span<const std::uint32_t> items, int depth);
    bool divide(std::uint32_t node, std::span<const std::uint32_t> items, int depth);
    void keep(std::uint32_t node, std::span<const std::uint32_t> items);
  };
  Place find(const Triangles& triangles, const glm::dvec3& point) const;
  const Entry* find(const Place& place, std::uint32_t triangle) const;

  Face faces_[6];
  std::vector<std::uint32_t> roots_;  ///< node of each cell of the first division
  std::vector<Patch> patches_;
  Work work_;
};

inline void LightMap::make(const Triangles& triangles, double cell_triangles) {
  clear();
  Footprints footprints = find_footprints(triangles);
  for (int face = 0; face < 6; ++face) {
    Face& f = faces_[face] = {};
    f.first_root = static_cast<std::uint32_t>(roots_.size()), f.first_patch = static_cast<std::uint32_t>(patches_.size());
    if (footprints[face].empty()) continue;
    f.node = divide_face(footprints[face], cell_triangles, !triangles.space().is_parallel());
    f.margin = margin_of(f.node);
    const std::size_t cells = static_cast<std::size_t>(f.node.columns) * f.node.rows;
    roots_.resize(roots_.size() + cells);
    patches_.resize(patches_.size() + (cells + patch_cells - 1) / patch_cells);
    Dealt dealt;
    deal(footprints[face].size(), 16384, cells, dealt, [&](std::size_t i, auto&& visit) {
      for_cells(triangles, face, f.node, f.margin, footprints[face][i],
                [&](std::uint32_t c, std::uint32_t r) { visit(static_cast<std::size_t>(r) * f.node.columns + c); });
    });
    std::vector<Work> works((cells + patch_cells - 1) / patch_cells);
    for_blocks(cells, patch_cells, [&](std::size_t begin, std::size_t end) {
      Patch& patch = patches_[f.first_patch + begin / patch_cells];
      Maker maker{triangles, footprints[face], face, f.margin, 2 * cell_triangles, patch, CellClipper(triangles, face)};
      for (std::size_t cell = begin; cell < end; ++cell) {
        const auto node = static_cast<std::uint32_t>(patch.nodes.size());
        roots_[f.first_root + cell] = node;
        patch.nodes.push_back(
            f.node.child(static_cast<std::uint32_t>(cell % f.node.columns), static_cast<std::uint32_t>(cell / f.node.columns)));
        maker.fill(node, std::span(dealt.items).subspan(dealt.begin[cell], dealt.begin[cell + 1] - dealt.begin[cell]), 0);
      }
      patch.fit();
      works[begin / patch_cells] = maker.clipper.work();
    });
    for (const Work& work : works) work_ += work;
    footprints[face] = {};
  }
}

inline void LightMap::Maker::fill(std::uint32_t node, std::span<const std::uint32_t> items, int depth) {
  if (!divide(node, items, depth)) keep(node, items);
}

/// Crowded cells get a grid of their own, unless that would only multiply what lies in them.
inline bool LightMap::Maker::divide(std::uint32_t node, std::span<const std::uint32_t> items, int depth) {
  const auto n = static_cast<double>(items.size());
  Node cell = patch.nodes[node];
  if (n <= crowd || depth >= 8 || std::max(cell.u1 - cell.u0, cell.v1 - cell.v0) < 64 * margin) return false;
  const double side = std::clamp(std::ceil(std::sqrt(2 * n / crowd)), 2.0, 64.0);
  const double stretch = std::clamp(std::sqrt((cell.u1 - cell.u0) / (cell.v1 - cell.v0)), 0.5, 2.0);
  cell.columns = static_cast<std::uint32_t>(std::max(1.0, std::round(side * stretch)));
  cell.rows = static_cast<std::uint32_t>(std::max(1.0, std::round(side / stretch)));
  Dealt dealt;
  const std::size_t cells = static_cast<std::size_t>(cell.columns) * cell.rows;
  deal(items.size(), items.size(), cells, dealt, [&](std::size_t i, auto&& visit) {
    for_cells(triangles, face, cell, margin, footprints[items[i]],
              [&](std::uint32_t c, std::uint32_t r) { visit(static_cast<std::size_t>(r) * cell.columns + c); });
  });
  // Each triangle is gathered once in its cell; pairs are a little work each until they overlap.
  const auto cost = [&](double count) { return count + count * count / (4 * crowd); };
  double below_cost = 0;
  for (std::size_t k = 0; k < cells; ++k) below_cost += cost(dealt.begin[k + 1] - dealt.begin[k]);
  if (below_cost >= cost(n)) return false;
  cell.first = static_cast<std::uint32_t>(patch.nodes.size());
  patch.nodes[node] = cell;
  for (std::uint32_t r = 0; r < cell.rows; ++r)
    for (std::uint32_t c = 0; c < cell.columns; ++c) patch.nodes.push_back(cell.child(c, r));
  std::vector<std::uint32_t> below;
  for (std::size_t k = 0; k < cells; ++k) {
    below.clear();
    for (std::uint32_t i = dealt.begin[k]; i < dealt.begin[k + 1]; ++i) below.push_back(items[dealt.items[i]]);
    fill(cell.first + static_cast<std::uint32_t>(k), below, depth + 1);
  }
  return true;
}

inline void LightMap::Maker::keep(std::uint32_t node, std::span<const std::uint32_t> items) {
  triangles_here.clear();
  for (const std::uint32_t i : items) triangles_here.push_back(footprints[i].triangle);
  const auto first = static_cast<std::uint32_t>(patch.entries.size());
  const Node cell = patch.nodes[node];
  const LightSpace& space = triangles.space();
  // Entries stand in the order of the members, which is not the one in which they are done.
  struct Made {
    std::uint32_t first_piece, piece_count;
  };
  std::vector<Made> made(items.size());
  const auto done = [&](const CellClipper::Member& m, const Pieces& pieces) {
    Made& mine = made[static_cast<std::size_t>(&m - clipper.members().data())];
    mine = {static_cast<std::uint32_t>(patch.pieces.size()), 0};
    if (!m.has_pieces) return;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      LitPiece piece{INFINITY, INFINITY, -INFINITY, -INFINITY, static_cast<std::uint32_t>(patch.marks.size()), 0};
      double u0 = INFINITY, v0 = INFINITY, u1 = -INFINITY, v1 = -INFINITY;
      for (const Corner& corner : pieces[k]) {
        if (corner.edge != 0) patch.marks.push_back(corner.edge), ++piece.mark_count;
        const bool is_lost = !space.is_parallel() && !(space.depth(face, corner.at) > 0x1p-30 * space.extent());
        const Seen s = is_lost ? Seen{0, 0, 0} : space.seen(face, corner.at);
        u0 = std::min(u0, is_lost ? cell.u0 : s.u), u1 = std::max(u1, is_lost ? cell.u1 : s.u);
        v0 = std::min(v0, is_lost ? cell.v0 : s.v), v1 = std::max(v1, is_lost ? cell.v1 : s.v);
      }
      piece.u0 = std::nextafter(static_cast<float>(u0 - margin), -INFINITY);
      piece.v0 = std::nextafter(static_cast<float>(v0 - margin), -INFINITY);
      piece.u1 = std::nextafter(static_cast<float>(u1 + margin), INFINITY);
      piece.v1 = std::nextafter(static_cast<float>(v1 + margin), INFINITY);
      patch.pieces.push_back(piece);
    }
    mine.piece_count = static_cast<std::uint32_t>(pieces.size());
  };
  clipper.clip(cell, margin, false, triangles_here, done, [](const CellClipper::Member&, std::span<const Corner>) {});
  for (std::size_t k = 0; k < clipper.members().size(); ++k) {
    const CellClipper::Member& m = clipper.members()[k];
    Entry entry{.triangle = m.triangle};
    if (m.receives) {
      const bool is_too_much = made[k].piece_count > 0xffff || m.near_count > 0xffff;
      entry.first_piece = made[k].first_piece, entry.piece_count = static_cast<std::uint16_t>(made[k].piece_count);
      entry.first_near = static_cast<std::uint32_t>(patch.near.size());
      entry.near_count = static_cast<std::uint16_t>(m.near_count);
      entry.clips = static_cast<std::uint16_t>(std::min(m.clips, 0xffffu));
      entry.kind = m.asks || is_too_much ? Entry::Kind::asks
                   : !m.has_pieces       ? Entry::Kind::lit
                   : made[k].piece_count ? Entry::Kind::pieces
                                         : Entry::Kind::dark;
      if (entry.kind == Entry::Kind::lit || entry.kind == Entry::Kind::pieces) {
        const auto near = clipper.near_of(m);
        patch.near.insert(patch.near.end(), near.begin(), near.end());
      }
    }
    patch.entries.push_back(entry);
  }
  patch.nodes[node].first = first;
  patch.nodes[node].count = static_cast<std::uint32_t>(patch.entries.size()) - first;
}

inline LightMap::Place LightMap::find(const Triangles& triangles, const glm::dvec3& point) const {
  const LightSpace& space = triangles.space();
  Place place;
  place.face = space.face_of(point);
  const Face& face = faces_[place.face];
  if (face.node.is_leaf()) return place;
  place.seen = space.seen(place.face, point);
  if (!face.node.holds(place.seen.u, place.seen.v)) return place;
  const std::size_t cell =
      static_cast<std::size_t>(face.node.row(place.seen.v)) * face.node.columns + face.node.column(place.seen.u);
  place.patch = &patches_[face.first_patch + cell / patch_cells];
  place.cell = &place.patch->nodes[roots_[face.first_root + cell]];
  while (!place.cell->is_leaf())
    place.cell = &place.patch->nodes[place.cell->first + place.cell->row(place.seen.v) * place.cell->columns +
                                     place.cell->column(place.seen.u)];
  return place;
}

inline const Entry* LightMap::find(const Place& place, std::uint32_t triangle) const {
  const Entry* const begin = place.patch->entries.data() + place.cell->first;
  const Entry* const end = begin + place.cell->count;
  const Entry* const entry =
      std::lower_bound(begin, end, triangle, [](const Entry& e, std::uint32_t t) { return e.triangle < t; });
  return entry != end && entry->triangle == triangle ? entry : nullptr;
}

inline std::uint32_t LightMap::shading(const Triangles& triangles, const Asked& asked) const {
  const Place place = find(triangles, glm::dvec3(asked.point));
  if (!place.patch) return Asked::none;
  const Entry* const begin = place.patch->entries.data() + place.cell->first;
  for (const Entry* e = begin; e != begin + place.cell->count; ++e) {
    if (!triangles.is(e->triangle, Triangles::casts)) continue;
    if (asked.triangle == Asked::none) {
      if (e->triangle >= asked.first_own && e->triangle < asked.end_own) continue;
      if (crosses({asked.point, triangles.space().light()}, triangles[e->triangle]) != Crossing::none) return e->triangle;
    } else if (triangles.shades(e->triangle, asked.triangle, asked.point)) {
      return e->triangle;
    }
  }
  return Asked::none;
}

inline std::uint32_t LightMap::clips_at(const Triangles& triangles, const Asked& asked) const {
  const Place place = find(triangles, glm::dvec3(asked.point));
  if (!place.patch || asked.triangle == Asked::none) return 0;
  const Entry* const entry = find(place, asked.triangle);
  return entry ? entry->clips : 0;
}

inline bool LightMap::is_lit(const Triangles& triangles, const Asked& asked, Tally& tally) const {
  const LightSpace& space = triangles.space();
  const glm::dvec3 point(asked.point);
  ++tally.points;
  const Place place = find(triangles, point);
  if (!place.patch) return true;
  const auto ask = [&] {
    ++tally.asked;
    return shading(triangles, asked) == Asked::none;
  };
  if (asked.triangle == Asked::none) return ask();
  const Entry* const entry = find(place, asked.triangle);
  if (!entry || entry->kind == Entry::Kind::asks || entry->kind == Entry::Kind::absent) return ask();
  // A point so near to the light that a cell's margin is within epsilon there.
  if (!space.is_parallel() && place.seen.depth * faces_[place.face].margin < 4 * space.epsilon()) return ask();
  // Its ray must go through its triangle, and the point lie on it but for rounding.
  const double doubt = space.doubt();
  for (int k = 0; k < 3; ++k)
    if (!triangles.side(asked.triangle, k).is_inside(point, doubt)) return ask();
  const RawPlane own = triangles.cap(asked.triangle);
  if (own.is_inside(point, space.rounding()) || own.is_outside(point, space.rounding())) return ask();
  if (entry->kind == Entry::Kind::dark) return false;
  const std::uint32_t* const near = place.patch->near.data() + entry->first_near;
  for (std::uint32_t k = 0; k < entry->near_count; ++k)
    if (triangles.shades(near[k], asked.triangle, asked.point)) return false;
  if (entry->kind == Entry::Kind::lit) return true;
  const LitPiece* const pieces = place.patch->pieces.data() + entry->first_piece;
  for (std::uint32_t i = 0; i < entry->piece_count; ++i) {
    const LitPiece& piece = pieces[i];
    if (place.seen.u < piece.u0 || place.seen.u > piece.u1 || place.seen.v < piece.v0 || place.seen.v > piece.v1) continue;
    bool is_inside = true, is_outside = false;
    for (std::uint32_t k = 0; k < piece.mark_count && !is_outside; ++k) {
      const Mark mark(place.patch->marks[piece.first_mark + k]);
      RawPlane side = triangles.side(mark.triangle, mark.plane);
      if (!mark.is_inner) side.normal = -side.normal;
      if (side.is_inside(point, doubt)) continue;
      is_inside = false, is_outside = side.is_outside(point, doubt);
    }
    if (is_inside) return true;
    if (!is_outside) return ask();
  }
  return false;
}

template <class Visit>
void LightMap::for_leaves(std::size_t patch, Visit&& visit) const {
  int face = 0;
  for (int k = 0; k < 6; ++k)
    if (!faces_[k].node.is_leaf() && faces_[k].first_patch <= patch) face = k;
  std::vector<std::uint32_t> triangles;
  for (const Node& node : patches_[patch].nodes) {
    if (!node.is_leaf()) continue;
    triangles.clear();
    for (std::uint32_t k = 0; k < node.count; ++k) triangles.push_back(patches_[patch].entries[node.first + k].triangle);
    visit(face, node, triangles);
  }
}

inline std::size_t LightMap::bytes() const {
  std::size_t bytes = roots_.capacity() * sizeof(std::uint32_t) + patches_.capacity() * sizeof(Patch);
  for (const Patch& patch : patches_) bytes += patch.bytes();
  return bytes;
}

}  // namespace gnomon::two_pass_object
