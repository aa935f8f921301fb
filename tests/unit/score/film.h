#pragma once
// Masks and references of a row, frame by frame, with what the pixels show, for tests of errors over time.
#include <algorithm>
#include <memory>

#include "hand_made.h"
#include "measure/score/over_time.h"

namespace gnomon::film {

/// One frame. By default all pixels are tested and show mesh 0, triangle 0 at (number of the pixel, 0, 0).
struct Frame {
  std::vector<float> mask, reference;
  std::vector<PixelClass> classes;
  std::unique_ptr<hand_made::Picture> picture;

  Frame(int width, int height)
      : mask(static_cast<std::size_t>(width) * height),
        reference(mask),
        classes(mask.size(), PixelClass::T),
        picture(std::make_unique<hand_made::Picture>(width, height)) {
    for (std::size_t i = 0; i < mask.size(); ++i) show(i, static_cast<float>(i), 0);
  }
  Frame(Frame&&) = default;
  Frame& operator=(Frame&&) = default;
  void show(std::size_t pixel, float x, std::uint32_t triangle) { picture->set(pixel, {x, 0, 0}, {0, 1, 0}, 0, triangle); }
  Evidence evidence() const {
    return {.width = picture->gbuffer.width,
            .height = picture->gbuffer.height,
            .classes = classes,
            .reference = reference,
            .mask = mask,
            .causes = {},
            .gbuffer = &picture->gbuffer};
  }
};

using Film = std::vector<Frame>;

inline Film blank(std::size_t frames, int width, int height) {
  Film film;
  while (film.size() < frames) film.emplace_back(width, height);
  return film;
}

inline Metrics score(const Film& film, double frame_rate, Path::Moves moves = Path::Moves::light) {
  TimeScore score(std::max(1, static_cast<int>(film.size())), frame_rate, moves);
  for (const Frame& frame : film) score.add(frame.evidence());
  return score.metrics();
}

}  // namespace gnomon::film
