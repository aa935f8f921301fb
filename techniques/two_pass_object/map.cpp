#include "map.h"

#include <gnomon/kit/parallel.h>

namespace gnomon::two_pass_object {

namespace {

/// The first division of a face: its rectangle fits the footprints, and there is about one cell for each `share` of them; there
/// are fewer where large triangles would lie in too many.
Node divide_face(std::span<const Footprint> footprints, double share, bool is_cube) {
  Node node{INFINITY, INFINITY, -INFINITY, -INFINITY};
  double area = 0, width = 0, height = 0;
  for (const Footprint& f : footprints) {
    node.u0 = std::min(node.u0, f.u0);
    node.u1 = std::max(node.u1, f.u1);
    node.v0 = std::min(node.v0, f.v0);
    node.v1 = std::max(node.v1, f.v1);
    area += (f.u1 - f.u0) * (f.v1 - f.v0);
    width += f.u1 - f.u0;
    height += f.v1 - f.v0;
  }
  // Never without width: points beside all triangles are lit, and those on the border are asked.
  const double size = std::max({node.u1 - node.u0, node.v1 - node.v0, 1e-6});
  const double grow = 0x1p-10 * size;
  node.u0 -= grow;
  node.u1 += grow;
  node.v0 -= grow;
  node.v1 += grow;
  // Faces of a cube meet and do not overlap.
  if (is_cube) {
    node.u0 = std::max(node.u0, -1.0);
    node.u1 = std::min(node.u1, 1.0);
    node.v0 = std::max(node.v0, -1.0);
    node.v1 = std::min(node.v1, 1.0);
  }
  const double du = node.u1 - node.u0, dv = node.v1 - node.v0, n = static_cast<double>(footprints.size());
  for (double cells = std::clamp(n / share, 1.0, 0x1p20);; cells /= 2) {
    const double stretch = std::sqrt(du / dv);
    const double columns = std::clamp(std::round(std::sqrt(cells) * stretch), 1.0, 2048.0);
    const double rows = std::clamp(std::round(std::sqrt(cells) / stretch), 1.0, 2048.0);
    const double touched = n + width / du * columns + height / dv * rows + area / (du * dv) * columns * rows;
    if (cells > 1 && touched > 4 * n + 64) continue;
    node.columns = static_cast<std::uint32_t>(columns);
    node.rows = static_cast<std::uint32_t>(rows);
    return node;
  }
}

/// Fills a patch: divides crowded cells, and keeps what is lit in the others.
class PatchMaker {
 public:
  PatchMaker(const Triangles& triangles, const std::vector<Footprint>& footprints, int face, double margin, double crowd,
             Patch& patch)
      : triangles_(triangles),
        footprints_(footprints),
        face_(face),
        margin_(margin),
        crowd_(crowd),
        patch_(patch),
        clipper_(triangles, face) {}

  /// Fills a node, whose rectangle is known, with footprints. `items` are their indices in rising order.
  void fill(std::uint32_t node, std::span<const std::uint32_t> items, int depth) {
    if (!divide(node, items, depth)) keep(node, items);
  }
  const Work& work() const { return clipper_.work(); }

 private:
  bool divide(std::uint32_t node, std::span<const std::uint32_t> items, int depth);
  void keep(std::uint32_t node, std::span<const std::uint32_t> items);
  LitPiece piece_of(std::span<const Corner> polygon, const Node& cell);
  Entry entry_of(const CellClipper::Member& m, std::uint32_t first_piece, std::uint32_t piece_count);

  const Triangles& triangles_;
  const std::vector<Footprint>& footprints_;
  int face_;
  double margin_, crowd_;
  Patch& patch_;
  CellClipper clipper_;
  std::vector<const Footprint*> here_;
  /// Lit pieces of each member; entries stand in the order of the members, which is not the one in which they are done.
  struct Made {
    std::uint32_t first_piece, piece_count;
  };
  std::vector<Made> made_;
};

/// Crowded cells get a grid of their own, unless that would only multiply what lies in them.
bool PatchMaker::divide(std::uint32_t node, std::span<const std::uint32_t> items, int depth) {
  const auto n = static_cast<double>(items.size());
  Node cell = patch_.nodes[node];
  if (n <= crowd_ || depth >= 8 || std::max(cell.u1 - cell.u0, cell.v1 - cell.v0) < 64 * margin_) return false;
  const double side = std::clamp(std::ceil(std::sqrt(2 * n / crowd_)), 2.0, 64.0);
  const double stretch = std::clamp(std::sqrt((cell.u1 - cell.u0) / (cell.v1 - cell.v0)), 0.5, 2.0);
  cell.columns = static_cast<std::uint32_t>(std::max(1.0, std::round(side * stretch)));
  cell.rows = static_cast<std::uint32_t>(std::max(1.0, std::round(side / stretch)));
  Bins bins;
  const std::size_t cells = static_cast<std::size_t>(cell.columns) * cell.rows;
  sort_into_bins_at_once(items.size(), items.size(), cells, bins, [&](std::size_t i, auto&& visit) {
    for_cells(triangles_, face_, cell, margin_, footprints_[items[i]],
              [&](std::uint32_t c, std::uint32_t r) { visit(static_cast<std::size_t>(r) * cell.columns + c); });
  });
  // Each triangle is a work of its own in every cell; pairs are a little work each until they overlap.
  const auto cost = [&](double count) { return count + count * count / (4 * crowd_); };
  double below_cost = 0;
  for (std::size_t k = 0; k < cells; ++k) below_cost += cost(static_cast<double>(bins.of(k).size()));
  if (below_cost >= cost(n)) return false;
  cell.first = static_cast<std::uint32_t>(patch_.nodes.size());
  patch_.nodes[node] = cell;
  for (std::uint32_t r = 0; r < cell.rows; ++r)
    for (std::uint32_t c = 0; c < cell.columns; ++c) patch_.nodes.push_back(cell.child(c, r));
  for (std::uint32_t& item : bins.items) item = items[item];
  for (std::size_t k = 0; k < cells; ++k) fill(cell.first + static_cast<std::uint32_t>(k), bins.of(k), depth + 1);
  return true;
}

void PatchMaker::keep(std::uint32_t node, std::span<const std::uint32_t> items) {
  here_.clear();
  for (const std::uint32_t i : items) here_.push_back(&footprints_[i]);
  made_.assign(items.size(), {});
  const Node cell = patch_.nodes[node];
  const auto done = [&](std::uint32_t index, const Pieces& pieces) {
    if (clipper_.members()[index].state != CellClipper::Member::State::cut) return;
    made_[index] = {static_cast<std::uint32_t>(patch_.pieces.size()), static_cast<std::uint32_t>(pieces.size())};
    for (std::size_t k = 0; k < pieces.size(); ++k) patch_.pieces.push_back(piece_of(pieces[k], cell));
  };
  clipper_.clip(cell, margin_, false, here_, done, [](const CellClipper::Member&, std::span<const Corner>) {});
  const auto first = static_cast<std::uint32_t>(patch_.entries.size());
  for (std::size_t k = 0; k < items.size(); ++k)
    if (const CellClipper::Member& m = clipper_.members()[k]; m.state != CellClipper::Member::State::absent)
      patch_.entries.push_back(entry_of(m, made_[k].first_piece, made_[k].piece_count));
  patch_.nodes[node].first = first;
  patch_.nodes[node].count = static_cast<std::uint32_t>(patch_.entries.size()) - first;
}

/// Its marks are added to the patch.
LitPiece PatchMaker::piece_of(std::span<const Corner> polygon, const Node& cell) {
  const SceneLightSpace& space = triangles_.space();
  LitPiece piece{0, 0, 0, 0, static_cast<std::uint32_t>(patch_.marks.size()), 0};
  double u0 = INFINITY, v0 = INFINITY, u1 = -INFINITY, v1 = -INFINITY;
  for (const Corner& corner : polygon) {
    if (corner.edge != 0) {
      patch_.marks.push_back(corner.edge);
      ++piece.mark_count;
    }
    const bool is_lost = !space.has_place(space.depth(face_, corner.at));
    const PlaceAndDepth s = is_lost ? PlaceAndDepth{0, 0, 0} : space.seen(face_, corner.at);
    u0 = std::min(u0, is_lost ? cell.u0 : s.u);
    u1 = std::max(u1, is_lost ? cell.u1 : s.u);
    v0 = std::min(v0, is_lost ? cell.v0 : s.v);
    v1 = std::max(v1, is_lost ? cell.v1 : s.v);
  }
  piece.u0 = std::nextafter(static_cast<float>(u0 - margin_), -INFINITY);
  piece.v0 = std::nextafter(static_cast<float>(v0 - margin_), -INFINITY);
  piece.u1 = std::nextafter(static_cast<float>(u1 + margin_), INFINITY);
  piece.v1 = std::nextafter(static_cast<float>(v1 + margin_), INFINITY);
  return piece;
}

/// Its near casters are added to the patch.
Entry PatchMaker::entry_of(const CellClipper::Member& m, std::uint32_t first_piece, std::uint32_t piece_count) {
  using State = CellClipper::Member::State;
  Entry entry{.triangle = m.triangle};
  if (!m.receives) return entry;
  entry.clips = static_cast<std::uint16_t>(std::min(m.clips, 0xffffu));
  if (m.state == State::asks || piece_count > 0xffff || m.near_count > 0xffff) {
    entry.kind = Entry::Kind::asks;
  } else if (m.state == State::hidden || m.state == State::dark) {
    entry.kind = Entry::Kind::dark;
  } else {
    entry.kind = m.state == State::cut ? Entry::Kind::pieces : Entry::Kind::lit;
    entry.first_piece = first_piece;
    entry.piece_count = static_cast<std::uint16_t>(piece_count);
    entry.first_near = static_cast<std::uint32_t>(patch_.near.size());
    entry.near_count = static_cast<std::uint16_t>(m.near_count);
    const std::span<const std::uint32_t> near = clipper_.near_of(m);
    patch_.near.insert(patch_.near.end(), near.begin(), near.end());
  }
  return entry;
}

}  // namespace

void LightMap::make(const Triangles& triangles, double cell_triangles) {
  clear();
  Footprints footprints = find_footprints(triangles);
  for (int face = 0; face < 6; ++face) {
    Face& f = faces_[face] = {};
    f.first_root = static_cast<std::uint32_t>(roots_.size());
    f.first_patch = static_cast<std::uint32_t>(patches_.size());
    if (footprints[face].empty()) continue;
    f.node = divide_face(footprints[face], cell_triangles, !triangles.space().is_parallel());
    f.margin = margin_of(f.node);
    const std::size_t cells = static_cast<std::size_t>(f.node.columns) * f.node.rows;
    roots_.resize(roots_.size() + cells);
    patches_.resize(patches_.size() + (cells + patch_cells - 1) / patch_cells);
    Bins bins;
    sort_into_bins_at_once(footprints[face].size(), 16384, cells, bins, [&](std::size_t i, auto&& visit) {
      for_cells(triangles, face, f.node, f.margin, footprints[face][i],
                [&](std::uint32_t c, std::uint32_t r) { visit(static_cast<std::size_t>(r) * f.node.columns + c); });
    });
    std::vector<Work> works((cells + patch_cells - 1) / patch_cells);
    for_blocks(cells, patch_cells, [&](std::size_t begin, std::size_t end) {
      Patch& patch = patches_[f.first_patch + begin / patch_cells];
      PatchMaker maker(triangles, footprints[face], face, f.margin, 2 * cell_triangles, patch);
      for (std::size_t cell = begin; cell < end; ++cell) {
        const auto node = static_cast<std::uint32_t>(patch.nodes.size());
        roots_[f.first_root + cell] = node;
        patch.nodes.push_back(
            f.node.child(static_cast<std::uint32_t>(cell % f.node.columns), static_cast<std::uint32_t>(cell / f.node.columns)));
        maker.fill(node, bins.of(cell), 0);
      }
      patch.fit();
      works[begin / patch_cells] = maker.work();
    });
    for (const Work& work : works) work_ += work;
    footprints[face] = {};
  }
}

LightMap::Place LightMap::find(const Triangles& triangles, const glm::dvec3& point) const {
  const SceneLightSpace& space = triangles.space();
  Place place;
  std::tie(place.face, place.seen) = space.seen(point);
  const Face& face = faces_[place.face];
  if (face.node.is_leaf()) return place;
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

const Entry* LightMap::find(const Place& place, std::uint32_t triangle) const {
  const Entry* const begin = place.patch->entries.data() + place.cell->first;
  const Entry* const end = begin + place.cell->count;
  const Entry* const entry =
      std::lower_bound(begin, end, triangle, [](const Entry& e, std::uint32_t t) { return e.triangle < t; });
  return entry != end && entry->triangle == triangle ? entry : nullptr;
}

std::uint32_t LightMap::shading(const Triangles& triangles, const NumberedReceiver& receiver) const {
  const Place place = find(triangles, glm::dvec3(receiver.point));
  if (!place.patch) return none;
  const Entry* const begin = place.patch->entries.data() + place.cell->first;
  for (const Entry* e = begin; e != begin + place.cell->count; ++e) {
    if (triangles.is(e->triangle, Triangles::casts) && triangles.shades(e->triangle, receiver)) return e->triangle;
  }
  return none;
}

std::uint32_t LightMap::clips_at(const Triangles& triangles, const NumberedReceiver& receiver) const {
  const Place place = find(triangles, glm::dvec3(receiver.point));
  if (!place.patch || !receiver.has_triangle()) return 0;
  const Entry* const entry = find(place, receiver.first_own);
  return entry ? entry->clips : 0;
}

bool LightMap::is_lit(const Triangles& triangles, const NumberedReceiver& receiver, PointWork& work) const {
  const SceneLightSpace& space = triangles.space();
  const glm::dvec3 point(receiver.point);
  ++work.points;
  const Place place = find(triangles, point);
  if (!place.patch) return true;
  const auto ask = [&] {
    ++work.asked;
    return shading(triangles, receiver) == none;
  };
  if (!receiver.has_triangle()) return ask();
  const Entry* const entry = find(place, receiver.first_own);
  if (!entry || entry->kind == Entry::Kind::asks || entry->kind == Entry::Kind::absent) return ask();
  // A point so near to the light that a cell's margin is within epsilon there.
  if (!space.is_parallel() && place.seen.depth * faces_[place.face].margin < 4 * space.epsilon()) return ask();
  // Its ray must go through its triangle, and the point lie on it but for rounding.
  const double doubt = space.doubt();
  for (int k = 0; k < 3; ++k)
    if (!triangles.side(receiver.first_own, k).is_inside(point, doubt)) return ask();
  const RawPlane own = triangles.cap(receiver.first_own);
  if (own.is_inside(point, space.rounding()) || own.is_outside(point, space.rounding())) return ask();
  if (entry->kind == Entry::Kind::dark) return false;
  const std::uint32_t* const near = place.patch->near.data() + entry->first_near;
  for (std::uint32_t k = 0; k < entry->near_count; ++k)
    if (triangles.shades(near[k], receiver)) return false;
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
      is_inside = false;
      is_outside = side.is_outside(point, doubt);
    }
    if (is_inside) return true;
    if (!is_outside) return ask();
  }
  return false;
}

void LightMap::for_leaves(const Triangles& triangles, std::size_t patch, const LeafVisitor& visit) const {
  int face = 0;
  for (int k = 0; k < 6; ++k)
    if (!faces_[k].node.is_leaf() && faces_[k].first_patch <= patch) face = k;
  std::vector<Footprint> footprints;
  std::vector<const Footprint*> pointers;
  for (const Node& node : patches_[patch].nodes) {
    if (!node.is_leaf()) continue;
    footprints.clear();
    pointers.clear();
    for (std::uint32_t k = 0; k < node.count; ++k)
      for_footprints(triangles, patches_[patch].entries[node.first + k].triangle, [&](int f, const Footprint& footprint) {
        if (f == face) footprints.push_back(footprint);
      });
    for (const Footprint& footprint : footprints) pointers.push_back(&footprint);
    visit(face, node, pointers);
  }
}

std::size_t LightMap::bytes() const {
  std::size_t bytes = bytes_of(roots_, patches_);
  for (const Patch& patch : patches_) bytes += patch.bytes();
  return bytes;
}

}  // namespace gnomon::two_pass_object
