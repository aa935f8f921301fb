#pragma once
#include <algorithm>
#include <array>

#include "hand_made.h"
#include "measure/picture/picture.h"

/// What tests of pictures read of them.
namespace pixels {

using namespace gnomon;
using Rgb = std::array<int, 3>;

inline Rgb pixel(const Picture& picture, int x, int y) {
  const std::uint8_t* rgb = &picture.rgb[3 * (static_cast<std::size_t>(y) * picture.width + x)];
  return {rgb[0], rgb[1], rgb[2]};
}

/// Counts the pixels of a color in the rows from `first` up to `last`.
inline int count(const Picture& picture, const Rgb& color, int first, int last) {
  int found = 0;
  for (int y = first; y < last; ++y)
    for (int x = 0; x < picture.width; ++x) found += pixel(picture, x, y) == color;
  return found;
}

/// Darkest channel in the rows from `first` up to `last`.
inline int darkest(const Picture& picture, int first, int last) {
  const auto row = [&](int y) { return picture.rgb.begin() + 3 * static_cast<std::ptrdiff_t>(y) * picture.width; };
  return *std::min_element(row(first), row(last));
}

/// A square seen from above, one receiver point per pixel, all turned up.
struct Flat {
  Scene scene;
  hand_made::Picture picture;
  Flat(int width, int height) : picture(width, height) {
    scene.meshes = {hand_made::square(5, 0)};
    for (std::size_t i = 0; i < picture.mesh.size(); ++i) picture.set(i, {0, 0, 0}, {0, 1, 0}, 0, 0);
  }
};

}  // namespace pixels
