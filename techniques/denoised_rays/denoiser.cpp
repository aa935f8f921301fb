#include "denoiser.h"

#include <gnomon/kit/bytes.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <cmath>

namespace gnomon::denoised_rays {

namespace {

/// Levels of the tiles' filter: steps of 1, 2 and 4 pixels.
constexpr int tile_levels = 3;
/// Frames below which a clamped history counts as young.
constexpr float young = 8;

/// Whether the variance is that of the tiles' memory, which has a rule of its own for short histories.
bool has_own_variance(const Settings& settings) { return settings.filter == Filter::tiles && settings.memory == Memory::clamp; }

/// What a mean over frames leaves of the variance of one. Filters look at the mean: by the variance of single frames, as SVGF
/// has it, they would go on blurring where the noise is gone.
float left_of_noise(const Settings& settings, float length) {
  return std::max(settings.alpha / (2 - settings.alpha), 1 / std::max(length, 1.0f));
}

/// Spreads planes over pixels. `keep` is called when they are as the next frame has them for a history: before the filter, or
/// where its weights look at values after its first level, so that the next frame looks at calmer ones.
template <class Keep>
void spread(const FrameInput& in, const Settings& settings, GuidedFilter& filter, const FilterPlanes& planes,
            std::span<const float> strength, const Keep& keep) {
  switch (settings.filter) {
    case Filter::none:
      keep();
      return;
    case Filter::width:
      keep();
      filter.run_by_sigma(in.guides, in.sigma, planes);
      return;
    case Filter::svgf:
      filter.run(in.guides, svgf_rule, 0, 1, planes);
      keep();
      filter.run(in.guides, svgf_rule, 1, most_filter_levels, planes);
      return;
    case Filter::tiles:
      filter.run(in.guides, tile_rule, 0, 1, planes, strength);
      keep();
      filter.run(in.guides, tile_rule, 1, tile_levels, planes, strength);
      return;
  }
}

/// work(i) for every pixel, on all threads.
template <class Work>
void for_pixels(std::size_t size, const Work& work) {
  for_blocks(size, 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) work(i);
  });
}

void copy(std::span<const float> from, std::span<float> to) {
  for_pixels(from.size(), [&](std::size_t i) { to[i] = from[i]; });
}

}  // namespace

void History::resize(std::size_t size, bool has_moments) {
  asked.resize(size);
  seen.resize(size);
  length.resize(size);
  mean.resize(has_moments ? size : 0);
  squares.resize(has_moments ? size : 0);
}

std::size_t History::bytes() const { return bytes_of(asked, seen, length, mean, squares); }

void Denoiser::advance() {
  if (!has_stepped_) return;
  std::swap(last_, next_);
  has_stepped_ = false;
}

void Denoiser::resize(std::size_t size, const Settings& settings) {
  const bool looks = settings.looks_at_values();
  for (UnsetVector<float>* plane : {&asked_, &seen_, &blended_asked_, &blended_seen_}) plane->resize(size);
  variance_.resize(looks ? size : 0);
  variance_left_.resize(looks ? size : 0);
  blends_.resize(settings.remembers() ? size : 0);
  next_.resize(settings.remembers() ? size : 0, settings.remembers() && settings.needs_moments());
  // From the first frame on, so that a frame's number does not show in what is held.
  if (!settings.remembers() || begins_) last_.resize(next_.asked.size(), !next_.mean.empty());
  begins_ = false;
}

void Denoiser::step(const FrameInput& in, const Settings& settings, GuidedFilter& filter, std::span<float> mask) {
  const std::size_t size = in.asked.size();
  resize(size, settings);
  // Where a change may need it the first frame has it, too, so that none allocates later.
  const bool may_hold = settings.remembers() && settings.on_change == OnChange::clamp;
  const bool holds = settings.memory == Memory::clamp || (may_hold && (in.has_changed || tiles_.mean().size() != size));
  if (holds || settings.filter == Filter::tiles) tiles_.make(in.guides, in.seen, in.asked);
  blend_all(in, settings);
  if (settings.looks_at_values()) {
    const std::span<const float> lengths =
        settings.remembers() ? std::span<const float>(next_.length) : std::span<const float>();
    if (!has_own_variance(settings))
      spread_variance(in.guides, blended_seen_, blended_asked_, variance_, lengths, short_history);
    copy(variance_, variance_left_);
  }
  copy(blended_asked_, asked_);
  copy(blended_seen_, seen_);
  const std::array<std::span<float>, 1> numerators{seen_};
  const FilterPlanes planes{.denominators = asked_, .numerators = numerators, .variance = variance_left_};
  spread(in, settings, filter, planes, tiles_.strength(), [&] {
    if (!settings.remembers()) return;
    copy(asked_, next_.asked);
    copy(seen_, next_.seen);
  });
  // Nothing asked: nothing of the light was found hidden. Sums of products may round to a hair more than their whole.
  for_pixels(size, [&](std::size_t i) {
    if (in.faces[i]) mask[i] = asked_[i] > 0 ? std::min(seen_[i] / asked_[i], 1.0f) : 1.0f;
  });
  has_stepped_ = true;
}

void Denoiser::blend_all(const FrameInput& in, const Settings& settings) {
  for_pixels(in.asked.size(), [&](std::size_t i) {
    if (settings.remembers() && in.faces[i]) return blend(in, settings, i);
    blended_asked_[i] = in.asked[i];
    blended_seen_[i] = in.seen[i];
    if (!variance_.empty()) variance_[i] = 0;
    if (!settings.remembers()) return;
    blends_[i] = {};
    next_.length[i] = 0;
    if (!next_.mean.empty()) next_.mean[i] = next_.squares[i] = 0;
  });
}

void Denoiser::blend(const FrameInput& in, const Settings& settings, std::size_t i) {
  const SourceTaps taps(in.sources[i], in.source_width);
  const bool has_history = taps.count > 0, has_moments = settings.needs_moments();
  const bool holds = settings.memory == Memory::clamp || (settings.on_change == OnChange::clamp && in.has_changed);
  const float asked = taps.of(last_.asked), seen = taps.of(last_.seen);
  const TileMoments before{has_moments ? taps.of(last_.mean) : 0, has_moments ? taps.of(last_.squares) : 0,
                           taps.of(last_.length)};
  const float around = holds ? tiles_.mean()[i] : 1;
  const bool is_asked = in.asked[i] > 0;
  const float now = is_asked ? in.seen[i] / in.asked[i] : holds ? around : before.mean;

  Blend blend;
  float length = std::min(before.length + 1, settings.longest), variance = 0;
  if (holds && has_history) {
    const TileStep held = tile_step(before, now, around, asked > 0 ? seen / asked : around);
    blend.low = held.low;
    blend.high = held.high;
  }
  if (settings.memory == Memory::clamp) {
    const TileStep step = tile_step(before, now, around, has_history && asked > 0 ? seen / asked : around);
    length = std::min(step.moments.length, settings.longest);
    const float youth = std::sqrt(std::max(young - length, 0.0f) / young);
    if (has_history) blend.newest = settings.alpha + (1 - settings.alpha) * youth;
    next_.mean[i] = step.moments.mean;
    // The sum of squares of so many frames as are still counted.
    next_.squares[i] = step.moments.length > settings.longest ? step.moments.squares * (settings.longest / step.moments.length)
                                                              : step.moments.squares;
    variance = step.variance;
  } else {
    if (has_history) blend.newest = std::max(settings.alpha, 1 / length);
    if (has_moments) {
      next_.mean[i] = blend.of(now, before.mean);
      next_.squares[i] = blend.of(now * now, before.squares);
      variance = std::max(next_.squares[i] - next_.mean[i] * next_.mean[i], 0.0f);
    }
  }
  blends_[i] = blend;
  next_.length[i] = length;
  if (!variance_.empty()) variance_[i] = has_own_variance(settings) ? variance : variance * left_of_noise(settings, length);
  blended_asked_[i] = blend.of(in.asked[i], asked);
  blended_seen_[i] = blend.of(in.seen[i], blend.held(seen, asked));
}

void Denoiser::follow(const FrameInput& in, const Settings& settings, GuidedFilter& filter, const Followers& twin) const {
  const std::size_t size = in.asked.size();
  if (settings.remembers())
    for_pixels(size, [&](std::size_t i) {
      if (!in.faces[i]) return;
      const SourceTaps taps(in.sources[i], in.source_width);
      const Blend& blend = blends_[i];
      twin.now[i] = blend.of(twin.now[i], blend.held(taps.of(twin.before), taps.of(last_.asked)));
    });
  std::vector<float> seen(blended_seen_.begin(), blended_seen_.end()), variance(variance_.begin(), variance_.end());
  copy(blended_asked_, twin.asked);
  const std::array<std::span<float>, 3> numerators{seen, twin.now, twin.still};
  const FilterPlanes planes{.denominators = twin.asked, .numerators = numerators, .variance = variance};
  spread(in, settings, filter, planes, tiles_.strength(), [&] {
    if (settings.remembers()) copy(twin.now, twin.kept);
  });
}

std::vector<float> Denoiser::reach_of(const FrameInput& in, const Settings& settings, std::size_t pixel) const {
  std::vector<float> seen(blended_seen_.begin(), blended_seen_.end()), asked(blended_asked_.begin(), blended_asked_.end());
  std::vector<float> variance(variance_.begin(), variance_.end()), part(seen.size());
  part[pixel] = asked[pixel];
  const std::array<std::span<float>, 2> numerators{seen, part};
  GuidedFilter filter;
  spread(in, settings, filter, {.denominators = asked, .numerators = numerators, .variance = variance}, tiles_.strength(),
         [] {});
  for (std::size_t i = 0; i < part.size(); ++i) part[i] = in.faces[i] && asked[i] > 0 ? part[i] / asked[i] : 0;
  return part;
}

std::size_t Denoiser::bytes() const {
  return last_.bytes() + next_.bytes() + tiles_.bytes() +
         bytes_of(blends_, blended_asked_, blended_seen_, asked_, seen_, variance_, variance_left_);
}

}  // namespace gnomon::denoised_rays
