#include "map.h"

#include <gnomon/kit/parallel.h>

namespace gnomon::two_pass_object {

namespace {

/// The first division of a face: its rectangle fits the footprints, and there is about one cell for each `share` of them; there
/// are fewer where large triangles would lie in too many.
Node divide_face(std::span<const Footprint> footprints, double share, bool is_cube) {
  Places box;
  double area = 0, width = 0, height = 0;
  for (const Footprint& f : footprints) {
    box.add(f.box);
    area += f.box.area();
    width += f.box.width();
    height += f.box.height();
  }
  // Never without width: points beside all triangles are lit, and those on the border are decided by exact signs.
  box = box.grown(0x1p-10 * std::max({box.width(), box.height(), 1e-6}));
  if (is_cube) box = box.within(cube_face);
  const double du = box.width(), dv = box.height(), n = static_cast<double>(footprints.size());
  for (double cells = std::clamp(n / share, 1.0, 0x1p20);; cells /= 2) {
    const double stretch = std::sqrt(du / dv);
    const double columns = std::clamp(std::round(std::sqrt(cells) * stretch), 1.0, 2048.0);
    const double rows = std::clamp(std::round(std::sqrt(cells) / stretch), 1.0, 2048.0);
    const double touched = n + width / du * columns + height / dv * rows + area / (du * dv) * columns * rows;
    if (!(cells > 1 && touched > 4 * n + 64))
      return {.box = box, .columns = static_cast<std::uint32_t>(columns), .rows = static_cast<std::uint32_t>(rows)};
  }
}

/// Fills a patch: divides crowded cells, and keeps what is lit in the others.
struct PatchMaker {
  using State = CellClipper::Member::State;
  const Triangles& triangles;
  const std::vector<Footprint>& footprints;
  int face;
  double margin, crowd;
  Patch& patch;
  CellClipper clipper{triangles, face};
  std::vector<const Footprint*> here = {};  ///< in the present cell
  struct Made {
    std::uint32_t first_piece, piece_count;
  };
  /// Lit pieces of each member. Entries are in the order of the members, which is not the one in which they are clipped.
  std::vector<Made> made = {};

  /// Fills a node, whose rectangle is known, with footprints. `items` are their indices in rising order.
  void fill(std::uint32_t node, std::span<const std::uint32_t> items, int depth) {
    if (!divide(node, items, depth)) keep(node, items);
  }

  /// Crowded cells get a grid of their own, unless that would only multiply what lies in them.
  bool divide(std::uint32_t node, std::span<const std::uint32_t> items, int depth) {
    const auto n = static_cast<double>(items.size());
    Node cell = patch.nodes[node];
    if (n <= crowd || depth >= 8 || std::max(cell.box.width(), cell.box.height()) < 64 * margin) return false;
    const double side = std::clamp(std::ceil(std::sqrt(2 * n / crowd)), 2.0, 64.0);
    const double stretch = std::clamp(std::sqrt(cell.box.width() / cell.box.height()), 0.5, 2.0);
    cell.columns = static_cast<std::uint32_t>(std::max(1.0, std::round(side * stretch)));
    cell.rows = static_cast<std::uint32_t>(std::max(1.0, std::round(side / stretch)));
    Bins bins;
    const std::uint32_t cells = cell.cell_count();
    sort_into_bins_at_once(items.size(), items.size(), cells, bins, [&](std::size_t i, auto&& visit) {
      for_cells(triangles, face, cell, margin, footprints[items[i]], visit);
    });
    // Each triangle costs one unit in every cell; a pair costs little until the two overlap.
    const auto cost = [&](double count) { return count + count * count / (4 * crowd); };
    double below_cost = 0;
    for (std::uint32_t k = 0; k < cells; ++k) below_cost += cost(static_cast<double>(bins.of(k).size()));
    if (below_cost >= cost(n)) return false;
    cell.first = static_cast<std::uint32_t>(patch.nodes.size());
    patch.nodes[node] = cell;
    for (std::uint32_t k = 0; k < cells; ++k) patch.nodes.push_back(cell.child(k));
    for (std::uint32_t& item : bins.items) item = items[item];
    for (std::uint32_t k = 0; k < cells; ++k) fill(cell.first + k, bins.of(k), depth + 1);
    return true;
  }

  void keep(std::uint32_t node, std::span<const std::uint32_t> items) {
    here.clear();
    for (const std::uint32_t i : items) here.push_back(&footprints[i]);
    made.assign(items.size(), {});
    Node& cell = patch.nodes[node];
    const auto done = [&](std::uint32_t index, const Pieces& pieces) {
      if (clipper.members()[index].state != State::cut) return;
      made[index] = {static_cast<std::uint32_t>(patch.pieces.size()), static_cast<std::uint32_t>(pieces.size())};
      for (std::size_t k = 0; k < pieces.size(); ++k) patch.pieces.push_back(piece_of(pieces[k], cell.box));
    };
    clipper.clip(cell, margin, false, here, done, [](const CellClipper::Member&, std::span<const Corner>) {});
    cell.first = static_cast<std::uint32_t>(patch.entries.size());
    for (std::size_t k = 0; k < items.size(); ++k)
      if (const CellClipper::Member& m = clipper.members()[k]; m.state != State::absent)
        patch.entries.push_back(entry_of(m, made[k]));
    cell.count = static_cast<std::uint32_t>(patch.entries.size()) - cell.first;
  }

  /// Its marks are added to the patch.
  LitPiece piece_of(std::span<const Corner> polygon, const Places& cell) {
    const SceneLightSpace& space = triangles.space();
    const auto first_mark = static_cast<std::uint32_t>(patch.marks.size());
    Places box;
    for (const Corner& corner : polygon) {
      if (corner.edge != 0) patch.marks.push_back(corner.edge);
      if (space.has_place(space.depth(face, corner.at)))
        box.add(space.seen(face, corner.at));
      else
        box.add(cell);
    }
    box = box.grown(margin);
    return {std::nextafter(static_cast<float>(box.u0), -INFINITY),
            std::nextafter(static_cast<float>(box.v0), -INFINITY),
            std::nextafter(static_cast<float>(box.u1), INFINITY),
            std::nextafter(static_cast<float>(box.v1), INFINITY),
            first_mark,
            static_cast<std::uint32_t>(patch.marks.size()) - first_mark};
  }

  /// Its near casters are added to the patch.
  Entry entry_of(const CellClipper::Member& m, const Made& pieces) {
    Entry entry{.triangle = m.triangle};
    if (!m.receives) return entry;
    entry.clips = static_cast<std::uint16_t>(std::min(m.clips, 0xffffu));
    if (m.state == State::exact || pieces.piece_count > 0xffff || m.near_count > 0xffff) {
      entry.kind = Entry::Kind::exact;
    } else if (m.state == State::hidden || m.state == State::dark) {
      entry.kind = Entry::Kind::dark;
    } else {
      entry.kind = m.state == State::cut ? Entry::Kind::pieces : Entry::Kind::lit;
      entry.first_piece = pieces.first_piece;
      entry.piece_count = static_cast<std::uint16_t>(pieces.piece_count);
      entry.first_near = static_cast<std::uint32_t>(patch.near.size());
      entry.near_count = static_cast<std::uint16_t>(m.near_count);
      std::ranges::copy(clipper.near_of(m), std::back_inserter(patch.near));
    }
    return entry;
  }
};

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
    f.margin = margin_of(f.node.box);
    const std::size_t cells = f.node.cell_count(), patch_count = (cells + patch_cells - 1) / patch_cells;
    roots_.resize(roots_.size() + cells);
    patches_.resize(patches_.size() + patch_count);
    Bins bins;
    sort_into_bins_at_once(footprints[face].size(), 16384, cells, bins, [&](std::size_t i, auto&& visit) {
      for_cells(triangles, face, f.node, f.margin, footprints[face][i], visit);
    });
    std::vector<Work> works(patch_count);
    for_blocks(cells, patch_cells, [&](std::size_t begin, std::size_t end) {
      Patch& patch = patches_[f.first_patch + begin / patch_cells];
      PatchMaker maker{triangles, footprints[face], face, f.margin, 2 * cell_triangles, patch};
      for (std::size_t cell = begin; cell < end; ++cell) {
        const auto node = static_cast<std::uint32_t>(patch.nodes.size());
        roots_[f.first_root + cell] = node;
        patch.nodes.push_back(f.node.child(static_cast<std::uint32_t>(cell)));
        maker.fill(node, bins.of(cell), 0);
      }
      patch.fit();
      works[begin / patch_cells] = maker.clipper.work();
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
  const auto& [u, v, depth] = place.seen;
  const Places& box = face.node.box;
  if (face.node.is_leaf() || !(u >= box.u0 && u <= box.u1 && v >= box.v0 && v <= box.v1)) return place;
  const std::uint32_t cell = face.node.cell_at(place.seen);
  place.patch = &patches_[face.first_patch + cell / patch_cells];
  place.cell = &place.patch->nodes[roots_[face.first_root + cell]];
  while (!place.cell->is_leaf()) place.cell = &place.patch->nodes[place.cell->first + place.cell->cell_at(place.seen)];
  return place;
}

const Entry* LightMap::Place::find(std::uint32_t triangle) const {
  const std::span<const Entry> all = entries();
  const auto entry = std::ranges::lower_bound(all, triangle, {}, &Entry::triangle);
  return entry != all.end() && entry->triangle == triangle ? &*entry : nullptr;
}

std::uint32_t LightMap::shading(const Triangles& triangles, const NumberedReceiver& receiver) const {
  const Place place = find(triangles, glm::dvec3(receiver.point));
  if (!place.patch) return none;
  for (const Entry& e : place.entries())
    if (triangles.is(e.triangle, Triangles::casts) && triangles.shades(e.triangle, receiver)) return e.triangle;
  return none;
}

std::uint32_t LightMap::clips_at(const Triangles& triangles, const NumberedReceiver& receiver) const {
  const Place place = find(triangles, glm::dvec3(receiver.point));
  if (!place.patch || !receiver.has_triangle()) return 0;
  const Entry* const entry = place.find(receiver.first_own);
  return entry ? entry->clips : 0;
}

bool LightMap::is_lit(const Triangles& triangles, const NumberedReceiver& receiver, PointWork& work) const {
  const SceneLightSpace& space = triangles.space();
  const glm::dvec3 point(receiver.point);
  ++work.points;
  const Place place = find(triangles, point);
  if (!place.patch) return true;
  const auto decide_exactly = [&] {
    ++work.exact;
    return shading(triangles, receiver) == none;
  };
  if (!receiver.has_triangle()) return decide_exactly();
  const Entry* const entry = place.find(receiver.first_own);
  if (!entry || entry->kind == Entry::Kind::exact || entry->kind == Entry::Kind::absent) return decide_exactly();
  // A point so near to the light that a cell's margin is within epsilon there.
  if (!space.is_parallel() && place.seen.depth * faces_[place.face].margin < 4 * space.epsilon()) return decide_exactly();
  // Its ray must go through its triangle, and the point lie on it but for rounding.
  const double doubt = space.doubt();
  for (int k = 0; k < 3; ++k)
    if (!triangles.side(receiver.first_own, k).is_inside(point, doubt)) return decide_exactly();
  const RawPlane own = triangles.cap(receiver.first_own);
  if (own.is_inside(point, space.rounding()) || own.is_outside(point, space.rounding())) return decide_exactly();
  if (entry->kind == Entry::Kind::dark) return false;
  for (const std::uint32_t caster : std::span(place.patch->near).subspan(entry->first_near, entry->near_count))
    if (triangles.shades(caster, receiver)) return false;
  if (entry->kind == Entry::Kind::lit) return true;
  for (const LitPiece& piece : std::span(place.patch->pieces).subspan(entry->first_piece, entry->piece_count)) {
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
    if (!is_outside) return decide_exactly();
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
