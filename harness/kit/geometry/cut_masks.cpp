#include <gnomon/error.h>
#include <gnomon/kit/geometry/clip.h>
#include <gnomon/kit/geometry/cut_masks.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace gnomon {

namespace {

/// Of a mask, unwrapped: columns x0 .. x1 - 1 and rows y0 .. y1 - 1.
struct Texels {
  std::int64_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  double count() const { return static_cast<double>(x1 - x0) * static_cast<double>(y1 - y0); }
};

/// A row's solid texels next to each other: from x0 to before x1; and the row in which their rectangle began.
struct TexelRun {
  std::int64_t x0, x1, y0;
  std::vector<std::int64_t> top;  ///< columns of corners on the rectangle's upper edge, both ends included
};

/// Columns of the corners on an edge from a run's start to its end: its own two, and those of runs across the edge.
std::vector<std::int64_t> corners_along(const TexelRun& run, const std::vector<TexelRun>& across) {
  std::vector<std::int64_t> corners{run.x0};
  auto other = std::ranges::lower_bound(across, run.x0, {}, &TexelRun::x1);
  for (; other != across.end() && other->x0 < run.x1; ++other)
    for (const std::int64_t x : {other->x0, other->x1})
      if (x > corners.back() && x < run.x1) corners.push_back(x);
  corners.push_back(run.x1);
  return corners;
}

/// Calls visit(corners) with three corners in texels, counter-clockwise where x goes right and y up, for each triangle of a
/// rectangle whose edges are divided by the corners of its neighbors; until visit returns false.
template <class Visit>
bool visit_rectangle(const TexelRun& run, std::int64_t y1, const std::vector<std::int64_t>& bottom, const Visit& visit) {
  const auto at = [](std::int64_t x, std::int64_t y) { return glm::dvec2(static_cast<double>(x), static_cast<double>(y)); };
  const std::vector<std::int64_t>& top = run.top;
  for (std::size_t i = 0, j = 0; i + 1 < top.size() || j + 1 < bottom.size();) {
    const bool goes_along_top = j + 1 == bottom.size() || (i + 1 < top.size() && top[i + 1] <= bottom[j + 1]);
    const glm::dvec2 upper = at(top[i], run.y0), lower = at(bottom[j], y1);
    const glm::dvec2 next = goes_along_top ? at(top[++i], run.y0) : at(bottom[++j], y1);
    if (!visit(std::array{upper, next, lower})) return false;
  }
  return true;
}

/// The same for all rectangles of the solid texels. Says whether it came to the end.
template <class Visit>
bool visit_solid(const AlphaMask& mask, const Texels& texels, const Visit& visit) {
  std::vector<TexelRun> open, row;
  for (std::int64_t y = texels.y0; y <= texels.y1; ++y) {
    row.clear();
    const int wrapped_row = AlphaMask::wrapped(y, mask.height(), mask.wrap_v());
    bool was_solid = false;
    for (std::int64_t x = texels.x0; y < texels.y1 && x < texels.x1; ++x) {
      const bool is_solid = mask.is_solid(AlphaMask::wrapped(x, mask.width(), mask.wrap_u()), wrapped_row);
      if (is_solid && !was_solid) row.push_back({x, x, y, {}});
      if (is_solid) row.back().x1 = x + 1;
      was_solid = is_solid;
    }
    // Both are in the order of x. A run that goes on as it was stays in its rectangle.
    auto above = open.begin();
    for (TexelRun& run : row) {
      while (above != open.end() && above->x0 < run.x0) ++above;
      if (above == open.end() || above->x0 != run.x0 || above->x1 != run.x1) {
        run.top = corners_along(run, open);
        continue;
      }
      run.y0 = above->y0;
      run.top = above->top;
    }
    for (const TexelRun& run : open) {
      const auto same = std::ranges::lower_bound(row, run.x0, {}, &TexelRun::x0);
      const bool goes_on = same != row.end() && same->x0 == run.x0 && same->x1 == run.x1;
      if (!goes_on && !visit_rectangle(run, y, corners_along(run, row), visit)) return false;
    }
    std::swap(open, row);
  }
  return true;
}

/// The pieces of a triangle, as weights of its corners; convex polygons, wound as the triangle is.
struct PiecesOfUv {
  struct Polygon {
    std::uint32_t first, count;
  };
  std::vector<Polygon> polygons;
  std::vector<glm::dvec3> weights;
  std::size_t triangle_count = 0;
};

/// Cuts triangles whose corners have places in a mask. Triangles with the same places in the same mask are cut once.
class MaskCutter {
 public:
  /// Gives up at a triangle with more than `most` pieces. `keeps_pieces`: else they are only counted.
  MaskCutter(std::size_t most, bool keeps_pieces) : most_(most), keeps_pieces_(keeps_pieces) {}

  /// Null where it gives up; then it is of no more use.
  const PiecesOfUv* cut(const Mesh& mesh, const glm::uvec3& triangle) {
    const glm::vec2 &a = mesh.uv[triangle.x], &b = mesh.uv[triangle.y], &c = mesh.uv[triangle.z];
    const Key key{mesh.alpha_mask.get(), {a.x, a.y, b.x, b.y, c.x, c.y}};
    const auto [place, is_new] = known_.try_emplace(key);
    if (!is_new) return &place->second;
    if (!cut(*mesh.alpha_mask, {a, b, c}, place->second)) return nullptr;
    if (!keeps_pieces_) {
      place->second.polygons = {};
      place->second.weights = {};
    }
    return &place->second;
  }

 private:
  struct Key {
    const AlphaMask* mask;
    std::array<float, 6> uv;
    auto operator<=>(const Key&) const = default;
  };
  static constexpr double most_texels = 0x1p28;  ///< read in all: the largest mask once
  /// Weights are ratios of areas in the mask: rounding of double makes 1e-15 of them, and float32 tells 6e-8 apart.
  static constexpr double epsilon = 1e-12;
  static constexpr double line_epsilon = 1e-9;  ///< of texels

  using Places = std::array<glm::dvec2, 3>;  ///< of the corners, in texels

  bool cut(const AlphaMask& mask, const std::array<glm::vec2, 3>& uv, PiecesOfUv& pieces) {
    const glm::dvec2 size(mask.width(), mask.height());
    const Places at{size * glm::dvec2(uv[0]), size * glm::dvec2(uv[1]), size * glm::dvec2(uv[2])};
    const glm::dvec2 low = glm::floor(glm::min(at[0], glm::min(at[1], at[2]))),
                     high = glm::max(glm::ceil(glm::max(at[0], glm::max(at[1], at[2]))), low + 1.0);
    if (!(glm::all(glm::lessThan(glm::abs(low), glm::dvec2(0x1p40))) &&
          glm::all(glm::lessThan(high - low, glm::dvec2(0x1p40)))))
      return false;
    if (const double solid = coverage(mask); solid == 0 || solid == 1) {
      if (solid == 1) add(whole(), pieces);
      return true;
    }
    const Texels texels{static_cast<std::int64_t>(low.x), static_cast<std::int64_t>(low.y), static_cast<std::int64_t>(high.x),
                        static_cast<std::int64_t>(high.y)};
    const glm::dvec2 u = at[1] - at[0], v = at[2] - at[0];
    const double area = u.x * v.y - u.y * v.x;
    // One point or one line of the mask, or all but that: weights of a rectangle's corners would have too few digits.
    const bool is_line = !(std::abs(area) > 1e-6 * std::max(glm::dot(u, u), glm::dot(v, v)));
    texels_ += is_line ? high.x - low.x + high.y - low.y : texels.count();
    if (texels_ > most_texels) return false;
    return is_line ? cut_line(mask, texels, at, pieces) : cut_area(mask, texels, at, area, pieces);
  }

  bool cut_area(const AlphaMask& mask, const Texels& texels, const Places& at, double area, PiecesOfUv& pieces) {
    const glm::dvec2 u = at[1] - at[0], v = at[2] - at[0];
    return visit_solid(mask, texels, [&](const std::array<glm::dvec2, 3>& corners) {
      clipper_.start();
      for (const glm::dvec2& corner : corners) {
        const glm::dvec2 d = corner - at[0];
        const double b = snapped((d.x * v.y - d.y * v.x) / area), c = snapped((u.x * d.y - u.y * d.x) / area);
        clipper_.add({{snapped(1 - b - c), b, c}});
      }
      for (int k = 0; k < 3; ++k) {
        glm::dvec3 toward(0);
        toward[k] = 1;
        if (!has_inside(clipper_.keep_positive({toward, 0}, epsilon))) return true;
      }
      return add_clipped(area < 0, pieces);
    });
  }

  /// Texel by texel: their borders are parallel lines in the triangle.
  bool cut_line(const AlphaMask& mask, const Texels& texels, const Places& at, PiecesOfUv& pieces) {
    const auto cut_off = [&](Clipper& polygon, int axis, std::int64_t texel) {
      const auto border = static_cast<double>(texel);
      const glm::dvec3 beyond(at[0][axis] - border, at[1][axis] - border, at[2][axis] - border);
      return polygon.keep_positive({beyond, 0}, line_epsilon) != Lies::negative &&
             polygon.keep_positive({1.0 - beyond, 0}, line_epsilon) != Lies::negative;
    };
    Clipper column;
    for (std::int64_t x = texels.x0; x < texels.x1; ++x) {
      column.start();
      for (const glm::dvec3& corner : whole()) column.add({corner});
      if (!cut_off(column, 0, x)) continue;
      double low = INFINITY, high = -INFINITY;
      for (const Corner& corner : column.corners()) {
        const double y = corner.at.x * at[0].y + corner.at.y * at[1].y + corner.at.z * at[2].y;
        low = std::min(low, y);
        high = std::max(high, y);
      }
      const std::int64_t first = std::max(texels.y0, static_cast<std::int64_t>(std::floor(low))),
                         last = std::min(texels.y1 - 1, static_cast<std::int64_t>(std::floor(high)));
      for (std::int64_t y = first; y <= last; ++y) {
        if (!mask.is_solid_wrapped(x, y)) continue;
        clipper_.start(column.corners());
        if (cut_off(clipper_, 1, y) && !add_clipped(false, pieces)) return false;
      }
    }
    return true;
  }

  /// What the clipper holds. Says whether that may go on.
  bool add_clipped(bool is_reversed, PiecesOfUv& pieces) {
    polygon_.clear();
    for (const Corner& corner : clipper_.corners())
      polygon_.emplace_back(snapped(corner.at.x), snapped(corner.at.y), snapped(corner.at.z));
    if (is_reversed) std::ranges::reverse(polygon_);
    add(polygon_, pieces);
    return pieces.triangle_count <= most_;
  }

  static std::array<glm::dvec3, 3> whole() { return {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)}; }
  static double snapped(double weight) { return std::abs(weight) <= epsilon ? 0 : weight; }

  static void add(std::span<const glm::dvec3> polygon, PiecesOfUv& pieces) {
    pieces.polygons.push_back({static_cast<std::uint32_t>(pieces.weights.size()), static_cast<std::uint32_t>(polygon.size())});
    pieces.weights.insert(pieces.weights.end(), polygon.begin(), polygon.end());
    pieces.triangle_count += polygon.size() - 2;
  }

  double coverage(const AlphaMask& mask) {
    const auto [place, is_new] = coverages_.try_emplace(&mask, 0);
    if (is_new) place->second = mask.coverage();
    return place->second;
  }

  std::size_t most_;
  bool keeps_pieces_;
  double texels_ = 0;
  std::map<Key, PiecesOfUv> known_;
  std::map<const AlphaMask*, double> coverages_;
  Clipper clipper_;
  std::vector<glm::dvec3> polygon_;
};

/// Appends the pieces of one triangle to a mesh. Those that rounding turns over or makes a line are left out.
void add_pieces(const Triangle& triangle, const PiecesOfUv& pieces, Mesh& mesh) {
  const glm::dvec3 a = triangle.points[0], b = triangle.points[1], c = triangle.points[2], normal = triangle.normal();
  for (const PiecesOfUv::Polygon& polygon : pieces.polygons) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::dvec3& w : std::span(pieces.weights).subspan(polygon.first, polygon.count))
      mesh.positions.emplace_back(w.x * a + w.y * b + w.z * c);
    for (std::uint32_t k = 2; k < polygon.count; ++k) {
      const glm::uvec3 corners(first, first + k - 1, first + k);
      const Triangle piece{{mesh.positions[corners.x], mesh.positions[corners.y], mesh.positions[corners.z]}};
      if (glm::dot(piece.normal(), normal) > 0) mesh.triangles.push_back(corners);
    }
  }
}

}  // namespace

CutCount cut_count(const Scene& scene, std::size_t most) {
  CutCount count;
  MaskCutter cutter(most, false);
  for (const Mesh& mesh : scene.meshes) {
    if (!casts_with_holes(mesh)) continue;
    for (const glm::uvec3& triangle : mesh.triangles) {
      const PiecesOfUv* const pieces = cutter.cut(mesh, triangle);
      if (!pieces) return {std::max(count.pieces, most), true};
      count.pieces += pieces->triangle_count;
    }
  }
  return count;
}

CutMasks::CutMasks(const Scene& scene, std::size_t most, Drawn drawn) : original_(&scene) {
  if (std::ranges::none_of(scene.meshes, casts_with_holes)) return;
  cut_ = std::make_unique<Scene>(scene);
  first_piece_ = static_cast<std::uint32_t>(scene.triangle_count());
  MaskCutter cutter(most, true);
  std::uint32_t source = 0;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (!casts_with_holes(mesh)) {
      source += static_cast<std::uint32_t>(mesh.triangles.size());
      continue;
    }
    Mesh solid;
    solid.name = mesh.name + " without holes";
    solid.receives = false;
    solid.albedo = mesh.albedo;
    solid.seen = mesh.seen;
    if (mesh.transmission && mesh.transmission->is_constant()) solid.transmission = mesh.transmission;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t, ++source) {
      const PiecesOfUv* const pieces = cutter.cut(mesh, mesh.triangles[t]);
      const std::size_t before = solid.triangles.size();
      if (pieces) add_pieces(mesh.corners(t), *pieces, solid);
      sources_.resize(sources_.size() + solid.triangles.size() - before, source);
      if (!pieces || sources_.size() > most)
        throw Error("the alpha masks of scene {} make more than {} pieces, in mesh {}", scene.name, most, mesh.name);
    }
    Mesh& old = cut_->meshes[m];
    old.casts = false;
    old.alpha_mask.reset();
    old.uv.clear();
    if (drawn == Drawn::pieces) std::ranges::fill(old.triangles, glm::uvec3(0));
    if (solid.triangles.empty()) continue;
    solid.facts = measure_facts(solid.positions, solid.triangles);
    cut_->meshes.push_back(std::move(solid));
  }
}

bool CutMasks::follow(const Changes& changes) {
  if (!cut_) return true;
  const auto moves = [&](std::size_t m) { return changes.meshes[m].kind != MeshChange::Kind::still; };
  for (std::size_t m = 0; m < changes.meshes.size(); ++m)
    if (moves(m) && casts_with_holes(original_->meshes[m])) return false;
  for (std::size_t m = 0; m < changes.meshes.size(); ++m) {
    cut_->meshes[m].reach = original_->meshes[m].reach;
    if (moves(m)) cut_->meshes[m].positions = original_->meshes[m].positions;
  }
  cut_->pose_number = original_->pose_number;
  return true;
}

std::pair<std::uint32_t, std::uint32_t> CutMasks::pieces_of(std::uint32_t source) const {
  const auto number_of = [&](auto place) { return first_piece_ + static_cast<std::uint32_t>(place - sources_.begin()); };
  return {number_of(std::ranges::lower_bound(sources_, source)), number_of(std::ranges::upper_bound(sources_, source))};
}

std::size_t CutMasks::bytes() const {
  std::size_t bytes = bytes_of(sources_);
  if (!cut_) return bytes;
  for (const Mesh& mesh : cut_->meshes) bytes += bytes_of(mesh.positions, mesh.triangles, mesh.uv);
  return bytes;
}

}  // namespace gnomon
