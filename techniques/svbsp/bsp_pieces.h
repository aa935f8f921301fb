#pragma once
// Private to bsp.cpp: triangles and their parts on the way down a BSP tree that is being made.
#include <gnomon/kit/geometry/clip.h>
#include <gnomon/scene.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <vector>

namespace gnomon::svbsp::bsp {

/// A triangle, or a part of one. It carries what most tests need, so that a list is read in a row.
struct Piece {
  float at[9];             ///< three corners; of a part the lower and the upper corner of a box around it
  std::uint32_t triangle;  ///< counted over the scene
  const Corner* corners;   ///< of a part; null for a triangle
  std::uint32_t count;     ///< corners

  glm::dvec3 corner(int k) const { return {at[3 * k], at[3 * k + 1], at[3 * k + 2]}; }  ///< of a triangle
  float low(int axis) const { return corners ? at[axis] : std::min({at[axis], at[axis + 3], at[axis + 6]}); }
  float high(int axis) const { return corners ? at[axis + 3] : std::max({at[axis], at[axis + 3], at[axis + 6]}); }
};

inline Piece piece_of(std::uint32_t triangle, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return {{a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z}, triangle, nullptr, 3};
}

inline Piece piece_of(std::uint32_t triangle, const Corner* corners, std::size_t count) {
  Piece made{{}, triangle, corners, static_cast<std::uint32_t>(count)};
  glm::dvec3 low = corners[0].at, high = low;
  for (std::size_t i = 1; i < count; ++i) {
    low = glm::min(low, corners[i].at);
    high = glm::max(high, corners[i].at);
  }
  for (int k = 0; k < 3; ++k) {
    const auto down = static_cast<float>(low[k]), up = static_cast<float>(high[k]);
    made.at[k] = down > low[k] ? std::nextafter(down, -INFINITY) : down;
    made.at[3 + k] = up < high[k] ? std::nextafter(up, INFINITY) : up;
  }
  return made;
}

/// Memory for the corners of parts, for many threads. They stay where they are as long as the arena lives.
class Arena {
 public:
  /// What one thread takes from it.
  class Room {
   public:
    explicit Room(Arena& arena) : arena_(arena) {}
    /// Room for as many, of which `keep` takes the first ones.
    Corner* reserve(std::size_t count) {
      if (static_cast<std::size_t>(end_ - next_) < count) {
        const std::size_t size = std::max<std::size_t>(count, 512);
        next_ = arena_.take(size);
        end_ = next_ + size;
      }
      return next_;
    }
    void keep(std::size_t count) { next_ += count; }

   private:
    Arena& arena_;
    Corner *next_ = nullptr, *end_ = nullptr;
  };

 private:
  Corner* take(std::size_t size) {
    std::unique_ptr<Corner[]> block(new Corner[size]);
    const std::scoped_lock lock(mutex_);
    blocks_.push_back(std::move(block));
    return blocks_.back().get();
  }
  std::mutex mutex_;
  std::vector<std::unique_ptr<Corner[]>> blocks_;
};

}  // namespace gnomon::svbsp::bsp
