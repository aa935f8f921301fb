#include <gnomon/kit/maps/alpha_levels.h>
#include <gnomon/kit/parallel.h>

#include <bit>
#include <functional>

#include "kit/gl/gl_masks.h"

namespace gnomon {

namespace {

int level_count(const AlphaMask& mask, AlphaRule rule) {
  if (rule == AlphaRule::texel) return 0;
  return rule == AlphaRule::hashed ? 1 : std::bit_width(static_cast<unsigned>(std::max(mask.width(), mask.height())));
}

/// The texels of a row, or of a column, that one of the next level lies over: three at most, each with its share of that one.
struct Parts {
  int first = 0, count = 0;
  double shares[3] = {};

  Parts(int texel, std::int64_t coarse, std::int64_t fine) {
    first = static_cast<int>(texel * fine / coarse);
    count = static_cast<int>(((texel + 1) * fine - 1) / coarse) + 1 - first;
    for (int k = 0; k < count; ++k) {
      const std::int64_t low = std::max((first + k) * coarse, texel * fine);
      const std::int64_t high = std::min((first + k + 1) * coarse, (texel + 1) * fine);
      shares[k] = static_cast<double>(high - low) / static_cast<double>(fine);
    }
  }
};

AlphaLevel next_level(const AlphaLevel& fine) {
  AlphaLevel coarse{level_size(fine.width, 1), level_size(fine.height, 1)};
  coarse.alpha.resize(std::size_t(coarse.width) * coarse.height);
  for_blocks(static_cast<std::size_t>(coarse.height), 16, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      const Parts rows(y, coarse.height, fine.height);
      for (int x = 0; x < coarse.width; ++x) {
        const Parts columns(x, coarse.width, fine.width);
        double sum = 0;
        for (int j = 0; j < rows.count; ++j)
          for (int i = 0; i < columns.count; ++i)
            sum += rows.shares[j] * columns.shares[i] *
                   static_cast<double>(fine.alpha[std::size_t(rows.first + j) * fine.width + columns.first + i]);
        coarse.alpha[std::size_t(y) * coarse.width + x] = static_cast<float>(sum);
      }
    }
  });
  return coarse;
}

/// Scales a level until so many of its texels pass the cutoff.
void keep(AlphaLevel& level, std::size_t solid, float factor, float cutoff) {
  if (solid == 0 || cutoff == 0) return;
  std::vector<float> sorted = level.alpha;
  const auto last = sorted.begin() + static_cast<std::ptrdiff_t>(solid - 1);
  std::ranges::nth_element(sorted, last, std::greater<>());
  const double least = *last;
  double scale = static_cast<double>(cutoff) / (static_cast<double>(factor) * least);
  // Rounding to float32 may take the last one below the cutoff.
  while (!(factor * static_cast<float>(scale * least) >= cutoff)) scale *= 1 + 0x1p-24;
  for (float& alpha : level.alpha) alpha = static_cast<float>(std::min(scale * static_cast<double>(alpha), 1.0));
}

/// As gl_caster_programs.cpp reads it.
std::vector<std::uint32_t> words_for_shaders(const Scene& scene, AlphaRule rule) {
  const std::vector<const AlphaMask*> masks = masks_in(scene);
  std::vector<std::uint32_t> words(mask_facts_words * masks.size());
  words.reserve(alpha_bytes(scene, rule) / 4);
  for (std::size_t k = 0; k < masks.size(); ++k) {
    const AlphaMask& mask = *masks[k];
    const std::vector<AlphaLevel> levels = alpha_levels(mask, rule);
    const std::size_t list = words.size();
    const std::uint32_t facts[mask_facts_words] = {std::uint32_t(mask.width()),
                                                   std::uint32_t(mask.height()),
                                                   std::uint32_t(mask.wrap_u()),
                                                   std::uint32_t(mask.wrap_v()),
                                                   std::bit_cast<std::uint32_t>(mask.factor()),
                                                   std::bit_cast<std::uint32_t>(mask.cutoff()),
                                                   std::uint32_t(levels.size() - 1),
                                                   std::uint32_t(list)};
    std::ranges::copy(facts, words.begin() + static_cast<std::ptrdiff_t>(mask_facts_words * k));
    words.resize(list + levels.size());
    for (std::size_t l = 0; l < levels.size(); ++l) {
      words[list + l] = static_cast<std::uint32_t>(words.size());
      for (const float alpha : levels[l].alpha) words.push_back(std::bit_cast<std::uint32_t>(alpha));
    }
  }
  return words;
}

}  // namespace

std::size_t AlphaLevel::solid_count(float factor, float cutoff) const {
  return static_cast<std::size_t>(std::ranges::count_if(alpha, [&](float a) { return factor * a >= cutoff; }));
}

std::vector<AlphaLevel> alpha_levels(const AlphaMask& mask, AlphaRule rule) {
  const int count = level_count(mask, rule);
  std::vector<AlphaLevel> levels;
  if (count == 0) return levels;
  levels.push_back({mask.width(), mask.height()});
  for (const std::uint8_t byte : mask.alpha()) levels[0].alpha.push_back(static_cast<float>(byte) / 255);
  while (static_cast<int>(levels.size()) < count) levels.push_back(next_level(levels.back()));
  if (rule != AlphaRule::mips_kept) return levels;
  const std::uint64_t solid = levels[0].solid_count(mask.factor(), mask.cutoff()), texels = levels[0].alpha.size();
  for (AlphaLevel& level : std::span(levels).subspan(1)) {
    const std::uint64_t wanted = solid * level.alpha.size();  // of as many texels as level 0 has: below 2^56
    keep(level, static_cast<std::size_t>((wanted + texels - 1) / texels), mask.factor(), mask.cutoff());
  }
  return levels;
}

std::size_t alpha_bytes(const Scene& scene, AlphaRule rule) {
  std::size_t words = 0;
  for (const AlphaMask* mask : masks_in(scene)) {
    const int count = level_count(*mask, rule);
    if (count > 0) words += mask_facts_words + static_cast<std::size_t>(count);
    for (int l = 0; l < count; ++l) words += std::size_t(level_size(mask->width(), l)) * level_size(mask->height(), l);
  }
  return 4 * words;
}

void AlphaLevels::use(const Scene& scene, AlphaRule rule) {
  if (!scene.has_alpha_masks()) rule = AlphaRule::texel;
  if (rule == rule_) return;
  levels_ = {};
  rule_ = AlphaRule::texel;
  if (rule == AlphaRule::texel) return;
  require_storage_block(alpha_bytes(scene, rule));
  const std::vector<std::uint32_t> words = words_for_shaders(scene, rule);
  levels_ = Buffer(words.data(), words.size() * 4);
  rule_ = rule;
}

}  // namespace gnomon
