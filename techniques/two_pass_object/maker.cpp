#include "maker.h"

namespace gnomon::two_pass_object {

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

}  // namespace gnomon::two_pass_object
