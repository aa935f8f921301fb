#pragma once
#include "cell.h"

namespace gnomon::two_pass_object {

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

}  // namespace gnomon::two_pass_object
