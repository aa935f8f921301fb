#pragma once
#include <algorithm>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

namespace gnomon::viewer {

/// Where words lie over the picture, so that none covers another: who is put first has its place. All in pixels of the picture.
class LabelPlaces {
 public:
  explicit LabelPlaces(const glm::dvec2& picture) : picture_(picture) {}

  /// Whether words with this upper left corner are inside the picture and touch no others.
  bool is_free(const glm::dvec2& corner, const glm::dvec2& extent) const {
    const bool is_inside =
        corner.x >= 0 && corner.y >= 0 && corner.x + extent.x <= picture_.x && corner.y + extent.y <= picture_.y;
    return is_inside && std::ranges::none_of(taken_, [&](const Place& place) { return place.touches(corner, extent); });
  }
  void take(const glm::dvec2& corner, const glm::dvec2& extent) { taken_.push_back({corner, corner + extent}); }
  /// Takes the first of the corners that is free; nothing where none is.
  std::optional<glm::dvec2> put(std::span<const glm::dvec2> corners, const glm::dvec2& extent) {
    for (const glm::dvec2& corner : corners) {
      if (!is_free(corner, extent)) continue;
      take(corner, extent);
      return corner;
    }
    return std::nullopt;
  }
  /// Takes the corner, or the next one below it that is under all that it would touch. Words that have to be read may end
  /// below the picture.
  glm::dvec2 put_below(glm::dvec2 corner, const glm::dvec2& extent) {
    for (bool is_moved = true; is_moved;) {
      is_moved = false;
      for (const Place& place : taken_)
        if (place.touches(corner, extent)) {
          corner.y = place.high.y;
          is_moved = true;
        }
    }
    take(corner, extent);
    return corner;
  }

 private:
  struct Place {
    glm::dvec2 low, high;
    bool touches(const glm::dvec2& corner, const glm::dvec2& extent) const {
      return corner.x < high.x && low.x < corner.x + extent.x && corner.y < high.y && low.y < corner.y + extent.y;
    }
  };
  glm::dvec2 picture_;
  std::vector<Place> taken_;
};

}  // namespace gnomon::viewer
