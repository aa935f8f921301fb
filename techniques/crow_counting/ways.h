#pragma once
#include <gnomon/kit/add_up.h>
#include <gnomon/kit/scratch_pool.h>

#include "unresolved_points.h"

namespace gnomon::crow_counting {

inline constexpr std::uint32_t no_polygon = 0xffffffffu;

/// The counts of a pixel.
struct PixelCount {
  std::int32_t depth = 0;              ///< volumes that hold the point, its own ones left out
  std::uint32_t crossings = 0;         ///< polygons met on the way, its own ones left out
  std::uint32_t entered = no_polygon;  ///< the last polygon through which the way enters a volume
};

/// The work of some pixels.
struct CountingWork {
  std::uint64_t rays = 0, crossings = 0, longest = 0, tests = 0, exact = 0, again = 0, touching = 0;
  std::int64_t deepest = 0;
  CountingWork& operator+=(const CountingWork& other) {
    using W = CountingWork;
    longest = std::max(longest, other.longest);
    deepest = std::max(deepest, other.deepest);
    return add_up(*this, other, &W::rays, &W::crossings, &W::tests, &W::exact, &W::again, &W::touching);
  }
};

/// Counts volumes along the ways from a start to the points of all pixels, tile by tile on all threads.
class WayCounter {
 public:
  /// Begins a picture: every pixel that faces the light is undecided, and lit until it is decided. `extent` is the largest
  /// coordinate of the scene.
  void begin(const Scene& scene, double extent, const GBuffer& gbuffer, const Light& light, Volumes& volumes,
             const OwnVolumes& own, std::span<float> mask) {
    gbuffer_ = &gbuffer;
    extent_ = extent;
    volumes_ = &volumes;
    own_ = &own;
    mask_ = mask;
    work_ = {};
    found_.assign(gbuffer.size(), {});
    is_undecided_.resize(gbuffer.size());
    for_blocks(gbuffer.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        is_undecided_[i] = faces_light(scene, gbuffer, light, i);
        mask_[i] = 1;
      }
    });
    pyramid_.fit(gbuffer.width, gbuffer.height);
  }

  /// Decides what is left to decide, from one start. Returns how many pixels that leaves.
  std::size_t count_from(const Frame& frame, std::int64_t volumes_at_start) {
    frame_ = frame;
    volumes_at_start_ = volumes_at_start;
    volumes_->look_from(frame);
    bound_tiles();
    const int level = pyramid_.top();
    Pyramid::Level& top = pyramid_.level(level);
    std::vector<CountingWork> works(top.tiles.size());
    std::vector<std::vector<UnresolvedPoint>> unresolved(top.tiles.size());
    for_blocks(top.tiles.size(), 1, [&](std::size_t k, std::size_t) {
      if (top.tiles[k].undecided == 0) return;
      const auto scratch = scratch_.borrow();
      scratch->polygons.resize(std::max<std::size_t>(scratch->polygons.size(), level + 2));
      scratch->unresolved = &unresolved[k];
      std::vector<std::uint32_t>& list = scratch->polygons[level + 1];
      list.clear();
      for (std::uint32_t p = 0; p < volumes_->count(); ++p)
        if (!top.tiles[k].misses(volumes_->outline(p))) list.push_back(p);
      const int x = static_cast<int>(k) % top.columns, y = static_cast<int>(k) / top.columns;
      works[k] = descend(level, x, y, list, *scratch);
    });
    std::size_t left = 0;
    for (const CountingWork& work : works) {
      work_ += work;
      left += work.again;
    }
    settle(unresolved);
    return left;
  }

  /// Makes the pixels dark that no start decides: they lie on the border of a volume.
  void darken_rest() {
    for (std::size_t i = 0; i < is_undecided_.size(); ++i) {
      if (!is_undecided_[i]) continue;
      mask_[i] = 0;
      ++work_.touching;
      ++work_.rays;
    }
  }

  /// Darkens a lit pixel that a volume beside the counted ones holds. Threads may name different pixels at the same time.
  void add_volume(std::size_t pixel) {
    mask_[pixel] = 0;
    found_[pixel].depth = std::max(found_[pixel].depth, 0) + 1;
  }

  std::span<const PixelCount> found() const { return found_; }
  const CountingWork& work() const { return work_; }
  std::size_t bytes() const { return pyramid_.bytes() + bytes_of(found_, is_undecided_); }

 private:
  static constexpr int tile_size = Pyramid::leaf * Pyramid::leaf;

  /// A polygon met on the way to a point.
  struct MetPolygon {
    double share;  ///< of the way to the point, 0 .. 1
    std::uint32_t polygon;
    int step;
  };
  /// What one thread works with.
  struct Scratch {
    std::vector<std::vector<std::uint32_t>> polygons;  ///< of the tile on each level
    std::vector<std::uint32_t> caps;                   ///< triangles among those of the smallest
    std::vector<MetPolygon> met[tile_size];
    std::vector<UnresolvedPoint>* unresolved;  ///< of the tile of the top level
  };
  /// A pixel of a tile while its polygons are searched.
  struct Query {
    std::size_t pixel;
    glm::dvec3 seen;  ///< the point in the frame of the start
    double error;     ///< of a plane's value there
    bool unclear = false, touches = false;
  };

  void bound_tiles() {
    Pyramid::Level& leaves = pyramid_.level(0);
    for_blocks(leaves.rows, 1, [&](std::size_t row, std::size_t) {
      for (int column = 0; column < leaves.columns; ++column) {
        Tile& tile = leaves.at(column, static_cast<int>(row)) = Tile{};
        pyramid_.for_pixels(column, static_cast<int>(row), [&](std::size_t i) {
          if (!is_undecided_[i]) return;
          const glm::vec3 p = gbuffer_->position(i);
          tile.add(frame_.seen(p), extent(p));
        });
      }
    });
    pyramid_.join();
  }

  /// Passes the polygons that a tile does not miss on to the tiles in it, down to the smallest.
  CountingWork descend(int level, int x, int y, std::span<const std::uint32_t> polygons, Scratch& scratch) {
    const Tile& tile = pyramid_.level(level).at(x, y);
    if (tile.undecided == 0) return {};
    std::vector<std::uint32_t>& near = scratch.polygons[level];
    near.clear();
    const Volumes& volumes = *volumes_;
    for (const std::uint32_t p : polygons)
      if (!tile.misses(volumes.outline(p)) && !tile.misses(volumes.polygon(p))) near.push_back(p);
    if (level == 0) return decide_tile(x, y, near, scratch);
    const Pyramid::Level& lower = pyramid_.level(level - 1);
    CountingWork sum;
    for (int v = 2 * y; v < std::min(2 * y + 2, lower.rows); ++v)
      for (int u = 2 * x; u < std::min(2 * x + 2, lower.columns); ++u) sum += descend(level - 1, u, v, near, scratch);
    return sum;
  }

  CountingWork decide_tile(int x, int y, std::span<const std::uint32_t> polygons, Scratch& scratch) {
    Query queries[tile_size];
    int count = 0;
    pyramid_.for_pixels(x, y, [&](std::size_t i) {
      if (!is_undecided_[i]) return;
      const glm::dvec3 seen = frame_.seen(gbuffer_->position(i));
      scratch.met[count].clear();
      queries[count++] = {i, seen, relative_error * glm::length(seen)};
    });
    CountingWork work;
    work.tests = static_cast<std::uint64_t>(count) * polygons.size();
    scratch.caps.clear();
    for (const std::uint32_t p : polygons) {
      if (!volumes_->is_side(p)) scratch.caps.push_back(volumes_->cap(p));
      const Polygon& polygon = volumes_->polygon(p);
      for (int k = 0; k < count; ++k) meet(p, polygon, queries[k], scratch.met[k], work);
    }
    for (int k = 0; k < count; ++k) {
      const Query& a = queries[k];
      if (a.unclear && !a.touches) {
        ++work.again;
        continue;
      }
      const bool in_shadow = walk(a, scratch.met[k], scratch, work);
      mask_[a.pixel] = in_shadow || a.touches ? 0.0f : 1.0f;
      work.touching += a.touches;
      is_undecided_[a.pixel] = 0;
    }
    return work;
  }

  /// Appends to `met` the way from the start to a pixel's point, if it meets the polygon of that number.
  /// Called for every polygon of every pixel: put into the loop, where the compiler alone would call it.
  [[gnu::always_inline]] void meet(std::uint32_t p, const Polygon& polygon, Query& query, std::vector<MetPolygon>& met,
                                   CountingWork& work) const {
    const double along = glm::dot(polygon.plane, query.seen), beyond = along - polygon.distance;
    if (beyond < -(polygon.slack + query.error)) return;
    const glm::dvec3* n = polygon.inside;
    const double inside = std::min({glm::dot(n[0], query.seen), glm::dot(n[1], query.seen), glm::dot(n[2], query.seen)});
    if (inside < -query.error) return;
    if (!(beyond > polygon.slack + query.error && inside > query.error)) {
      ++work.exact;
      const Meeting meeting = volumes_->meet(p, frame_.start, gbuffer_->position(query.pixel));
      query.unclear |= meeting == Meeting::unclear;
      if (meeting == Meeting::touches) {
        const auto [low, high] = volumes_->ends(p);
        query.touches |= !own_->is_own_edge(*volumes_, own_->surface(*gbuffer_, query.pixel), low, high);
      }
      if (meeting != Meeting::crosses) return;
    }
    const double share = polygon.distance / along;
    met.push_back({std::isfinite(share) ? share : 1.0, p, polygon.step});
  }

  /// The count front to back. Returns whether the point is in shadow.
  bool walk(const Query& query, std::vector<MetPolygon>& met, const Scratch& scratch, CountingWork& work) {
    std::ranges::sort(met, [](const MetPolygon& one, const MetPolygon& other) {
      return one.share != other.share ? one.share < other.share : one.polygon < other.polygon;
    });
    std::int64_t depth = volumes_at_start_, deepest = depth;
    for (const MetPolygon& m : met) {
      depth += m.step;
      deepest = std::max(deepest, depth);
      if (m.step > 0) found_[query.pixel].entered = m.polygon;
    }
    ++work.rays;
    work.crossings += met.size();
    work.longest = std::max<std::uint64_t>(work.longest, met.size());
    work.deepest = std::max(work.deepest, deepest);
    const auto crossings = static_cast<std::uint32_t>(met.size());
    return conclude(query.pixel, depth, crossings, depth > 0 ? count_own(query, depth, crossings, scratch) : 0);
  }

  /// The volumes of the triangle that the point lies on, which do not count: a point rounded to below it is in them. Records
  /// the point as unresolved where the caps of the tile do not decide.
  std::int64_t count_own(const Query& query, std::int64_t depth, std::uint32_t crossings, const Scratch& scratch) const {
    const NumberedReceiver surface = own_->surface(*gbuffer_, query.pixel);
    const auto segment = [&] {
      return SegmentToOwnPlane(volumes_->adjacency().corners(surface.first_own), surface.point, volumes_->silhouette().light,
                               extent_);
    };
    std::int64_t own = 0;
    bool may_leave = false;  // a body, through the half of it that does not count
    const bool is_behind = own_->for_holding(*volumes_, surface, frame_.start, scratch.caps, [&](std::uint32_t t) {
      ++own;
      may_leave |= surface.has_triangle() && volumes_->is_half(t) && segment().is_near_edge(volumes_->adjacency().corners(t));
    });
    if (query.touches) return own;
    const bool is_grazed = depth > own && is_behind && segment().leaves_tile(query.seen);
    if (is_grazed || (depth == own && may_leave))
      scratch.unresolved->push_back(
          {query.pixel, depth, crossings, is_grazed, segment().box(), static_cast<std::int32_t>(own)});
    return own;
  }

  /// Returns whether the point is in shadow.
  bool conclude(std::size_t pixel, std::int64_t depth, std::uint32_t crossings, std::int64_t own) {
    found_[pixel].depth = static_cast<std::int32_t>(depth - own);
    found_[pixel].crossings = crossings - static_cast<std::uint32_t>(std::clamp<std::int64_t>(own, 0, crossings));
    return depth > own;
  }

  /// Decides the unresolved points.
  void settle(std::span<const std::vector<UnresolvedPoint>> unresolved) {
    std::vector<UnresolvedPoint> all;
    for (const std::vector<UnresolvedPoint>& some : unresolved) all.insert(all.end(), some.begin(), some.end());
    if (all.empty()) return;
    test_casters(*volumes_, *own_, *gbuffer_, frame_.start, all);
    for (const UnresolvedPoint& d : all)
      mask_[d.pixel] = conclude(d.pixel, d.depth + d.behind, d.crossings, d.own) ? 0.0f : 1.0f;
  }

  const GBuffer* gbuffer_ = nullptr;
  double extent_ = 0;  // of the scene
  Volumes* volumes_ = nullptr;
  const OwnVolumes* own_ = nullptr;
  std::span<float> mask_;
  Frame frame_;  // of the present start
  std::int64_t volumes_at_start_ = 0;
  Pyramid pyramid_;
  std::vector<PixelCount> found_;           // of each pixel
  std::vector<std::uint8_t> is_undecided_;  // of each pixel
  CountingWork work_;
  ScratchPool<Scratch> scratch_;
};

}  // namespace gnomon::crow_counting
