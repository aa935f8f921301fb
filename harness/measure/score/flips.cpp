#include "measure/score/flips.h"

#include <gnomon/kit/add_up.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>

#include "measure/frame/classify.h"

namespace gnomon {

namespace {

constexpr std::size_t word_bits = 64;

/// What one pixel does, by frame.
struct Course {
  std::vector<std::int8_t> mask, reference;  ///< 1: becomes lit; -1: becomes dark; 0: neither
  std::vector<std::uint32_t> run;            ///< number of the run of compared frames
};

Flips::Counts match(Course& course, std::size_t window) {
  Flips::Counts counts;
  const std::size_t frames = std::size(course.mask);
  const auto take = [&](std::size_t flip, std::size_t of_reference) {
    if (course.reference[of_reference] != course.mask[flip] || course.run[of_reference] != course.run[flip]) return false;
    course.mask[flip] = course.reference[of_reference] = 0;
    return true;
  };
  std::vector<std::size_t> flips;
  for (std::size_t t = 0; t < frames; ++t)
    if (course.mask[t] != 0) flips.push_back(t);
  for (std::size_t distance = 0; distance <= std::min(window, frames - 1) && !flips.empty(); ++distance)
    std::erase_if(flips, [&](std::size_t t) {
      const bool is_taken = (t >= distance && take(t, t - distance)) || (t + distance < frames && take(t, t + distance));
      if (is_taken && distance > 0) ++counts.late;
      return is_taken;
    });
  counts.unmatched += flips.size();
  return counts;
}

Flips::Counts sum(Flips::Counts a, const Flips::Counts& b) {
  add_up(a, b, &Flips::Counts::pairs, &Flips::Counts::late, &Flips::Counts::unmatched);
  return a;
}

}  // namespace

void Flips::add(std::span<const float> mask, std::span<const float> reference, std::span<const std::uint32_t> age) {
  const std::size_t words = (std::size(mask) + word_bits - 1) / word_bits;
  Frame& frame = frames_.emplace_back(Frame{Plane(words), Plane(words), Plane(words)});
  for (std::size_t i = 0; i < std::size(mask); ++i) {
    const auto put = [&](Plane& plane, bool bit) {
      plane[i / word_bits] |= static_cast<std::uint64_t>(bit) << (i % word_bits);
    };
    put(frame.lit, is_lit(mask[i]));
    put(frame.reference_lit, is_lit(reference[i]));
    put(frame.compared, age[i] > 1);
  }
}

Flips::Counts Flips::count(std::size_t window) const {
  if (frames_.empty()) return {};
  const auto count = [&](const tbb::blocked_range<std::size_t>& words, Counts counts) {
    for (std::size_t word = words.begin(); word < words.end(); ++word) counts = sum(counts, count_word(word, window));
    return counts;
  };
  return tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, std::size(frames_.front().lit)), Counts{}, count, sum);
}

Flips::Counts Flips::count_word(std::size_t word, std::size_t window) const {
  Counts counts;
  std::uint64_t flipping = 0;  // pixels with a flip of the mask
  for (std::size_t t = 1; t < std::size(frames_); ++t) {
    const std::uint64_t compared = frames_[t].compared[word];
    counts.pairs += static_cast<std::uint64_t>(std::popcount(compared));
    flipping |= compared & (frames_[t].lit[word] ^ frames_[t - 1].lit[word]);
  }
  Course course;
  for (; flipping != 0; flipping &= flipping - 1) {
    const int bit = std::countr_zero(flipping);
    const auto has = [&](const Plane& plane) { return (plane[word] >> bit & 1) != 0; };
    const auto flip = [&](const Plane& before, const Plane& now) {
      return static_cast<std::int8_t>(has(now) == has(before) ? 0 : has(now) ? 1 : -1);
    };
    course.mask.assign(std::size(frames_), 0);
    course.reference.assign(std::size(frames_), 0);
    course.run.assign(std::size(frames_), 0);
    for (std::size_t t = 1; t < std::size(frames_); ++t) {
      const Frame &before = frames_[t - 1], &now = frames_[t];
      const bool is_compared = has(now.compared);
      course.run[t] = course.run[t - 1] + (is_compared ? 0 : 1);
      if (!is_compared) continue;
      course.mask[t] = flip(before.lit, now.lit);
      course.reference[t] = flip(before.reference_lit, now.reference_lit);
    }
    counts = sum(counts, match(course, window));
  }
  return counts;
}

}  // namespace gnomon
