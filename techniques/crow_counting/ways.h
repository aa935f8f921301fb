#pragma once
#include <gnomon/kit/scratch_pool.h>

#include "own_volumes.h"
#include "tiles.h"
#include "volumes.h"

namespace gnomon::crow_counting {

inline constexpr std::uint32_t no_polygon = 0xffffffffu;

/// What a pixel was found to be.
struct PixelCount {
  std::int32_t depth = 0;              ///< volumes that hold the point, its own ones left out
  std::uint32_t crossings = 0;         ///< polygons met on the way, its own ones left out
  std::uint32_t entered = no_polygon;  ///< the last polygon through which the way enters a volume
};

/// The work of some pixels.
struct CountingWork {
  std::uint64_t rays = 0, crossings = 0, longest = 0, tests = 0, exact = 0, again = 0, touching = 0;
  std::int64_t deepest = 0;
  CountingWork& operator+=(const CountingWork& other);
};

/// Counts volumes along the ways from a start to the points of all pixels, tile by tile on all threads. Hidden, because
/// position independent code inlines no function that another library could replace: `meet` is called for every polygon of
/// every pixel.
class [[gnu::visibility("hidden")]] WayCounter {
 public:
  /// Begins a picture: every pixel that faces the light is undecided, and lit until it is decided.
  void begin(const Scene& scene, const GBuffer& gbuffer, const Light& light, Volumes& volumes, const OwnVolumes& own,
             std::span<float> mask);
  /// Decides what is left to decide, from one start. Returns how many pixels that leaves.
  std::size_t count_from(const Frame& frame, std::int64_t volumes_at_start);
  /// Makes the pixels dark that no start decides: they lie on the border of a volume.
  void darken_rest();

  std::span<const PixelCount> found() const { return found_; }
  const CountingWork& work() const { return work_; }
  std::size_t bytes() const;

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
    std::size_t bytes() const {
      std::size_t sum = sizeof(Scratch) + caps.capacity() * sizeof(std::uint32_t);
      for (const auto& list : polygons) sum += list.capacity() * sizeof(std::uint32_t);
      for (const auto& list : met) sum += list.capacity() * sizeof(MetPolygon);
      return sum;
    }
  };
  struct Query;

  void bound_tiles();
  /// Hands each tile of a tile the polygons that it does not miss, down to the smallest.
  CountingWork descend(int level, int x, int y, std::span<const std::uint32_t> polygons, Scratch& scratch);
  CountingWork decide_tile(int x, int y, std::span<const std::uint32_t> polygons, Scratch& scratch);
  /// Appends to `met` the way from the start to a pixel's point, if it meets the polygon of that number.
  void meet(std::uint32_t number, const Polygon& polygon, Query& query, std::vector<MetPolygon>& met, CountingWork& work) const;
  /// The count front to back; says whether the point is in shadow.
  bool walk(const Query& query, std::vector<MetPolygon>& met, std::span<const std::uint32_t> caps, CountingWork& work);

  const GBuffer* gbuffer_ = nullptr;
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
