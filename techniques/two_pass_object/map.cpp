#include "map.h"

#include <gnomon/kit/parallel.h>

namespace gnomon::two_pass_object {

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
  std::size_t bytes = roots_.capacity() * sizeof(std::uint32_t) + patches_.capacity() * sizeof(Patch);
  for (const Patch& patch : patches_) bytes += patch.bytes();
  return bytes;
}

}  // namespace gnomon::two_pass_object
