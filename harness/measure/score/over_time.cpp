#include "measure/score/over_time.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace gnomon {

namespace {

/// Lags of flicker are whole numbers of this one.
constexpr double lags_per_second = 60;
/// Flips of mask and reference belong together within 1/10 s.
constexpr double matches_per_second = 10;

double error_of(const Evidence& e, std::size_t i) { return static_cast<double>(e.mask[i]) - e.reference[i]; }

}  // namespace

void SteadyPixels::add(const Evidence& now) {
  assert(now.gbuffer && (shown_.empty() || std::size(shown_) == std::size(now.mask)));
  const GBuffer& g = *now.gbuffer;
  shown_.resize(std::size(now.mask));
  ages_.resize(std::size(now.mask));
  for (std::size_t i = 0; i < std::size(shown_); ++i) {
    const auto bits = [&](std::span<const float> values) { return std::bit_cast<std::uint32_t>(values[i]); };
    const Shown shown{g.mesh[i], g.triangle[i], {bits(g.px), bits(g.py), bits(g.pz)}};
    const bool is_same = shown == shown_[i];
    shown_[i] = shown;
    ages_[i] = now.classes[i] != PixelClass::T ? 0 : is_same ? ages_[i] + 1 : 1;
  }
  if (frames_++ == 0) tested_at_first_ = static_cast<std::size_t>(std::ranges::count(now.classes, PixelClass::T));
}

TimeScore::TimeScore(int frames, double frame_rate, Path::Moves moves)
    : frames_(frames), frame_rate_(frame_rate), moves_(moves) {
  assert(frames > 0 && frame_rate > 0);
  const bool is_defined = flicker_obstacle(frame_rate).empty();
  auto flicker = flicker_.begin();
  for (const FlickerMetric& metric : flicker_metrics) {
    const double lag = metric.sixtieths * (frame_rate / lags_per_second);
    *flicker++ = {.metric = metric.name, .lag = is_defined && lag < frames ? static_cast<std::size_t>(lag) : 0};
  }
  if (follows_camera()) views_.emplace(frames_kept());
}

std::size_t TimeScore::frames_kept() const { return std::ranges::max(flicker_, {}, &Flicker::lag).lag + 1; }

void TimeScore::add(const Evidence& now) {
  if (!now.channels.empty()) {
    if (channels_.empty()) channels_.assign(std::size(now.channels), TimeScore(frames_, frame_rate_, moves_));
    assert(std::size(channels_) == std::size(now.channels));
    for (std::size_t k = 0; k < std::size(channels_); ++k) channels_[k].add(now.channels[k]);
    return;
  }
  ++added_;
  if (!follows_camera()) steady_.add(now);
  add_flicker(now);
  if (follows_camera()) return;
  add_moments(now);
  flips_.add(now.mask, now.reference, steady_.ages());
}

std::optional<std::size_t> TimeScore::compared(const Evidence& now, std::size_t i, std::size_t lag) const {
  if (views_) return views_->pixel_of(now, i, lag);
  return steady_.ages()[i] > lag ? std::optional(i) : std::nullopt;
}

void TimeScore::add_flicker(const Evidence& now) {
  const std::size_t frame = added_ - 1, kept = frames_kept();
  if (kept == 1) return;
  if (views_) views_->add(now);
  if (std::size(errors_) < kept) errors_.emplace_back(std::size(now.mask));
  std::vector<float>& errors = errors_[frame % kept];
  for (std::size_t i = 0; i < std::size(errors); ++i) errors[i] = static_cast<float>(error_of(now, i));
  const auto tested = static_cast<std::uint64_t>(std::ranges::count(now.classes, PixelClass::T));
  for (Flicker& flicker : flicker_) {
    if (flicker.lag == 0 || frame < flicker.lag) continue;
    const std::vector<float>& before = errors_[(frame - flicker.lag) % kept];
    flicker.tested += tested;
    for (std::size_t i = 0; i < std::size(errors); ++i) {
      const std::optional<std::size_t> q = compared(now, i, flicker.lag);
      if (!q) continue;
      const double change = static_cast<double>(errors[i]) - before[*q];
      flicker.squares += change * change;
      ++flicker.count;
    }
  }
}

/// Mean and sum of squares by Welford 1962, which loses no digits where the variance is small beside the mean.
void TimeScore::add_moments(const Evidence& now) {
  const std::size_t frames = steady_.frames();
  moments_.resize(std::size(now.mask));
  for (std::size_t i = 0; i < std::size(moments_); ++i) {
    if (steady_.ages()[i] < frames) continue;
    Moments& moments = moments_[i];
    const double error = error_of(now, i), from_before = error - moments.mean;
    moments.mean += from_before / static_cast<double>(frames);
    moments.squares += from_before * (error - moments.mean);
  }
}

double TimeScore::steady_count() const { return static_cast<double>(std::ranges::count(steady_.ages(), steady_.frames())); }

std::optional<double> TimeScore::temporal_sd() const {
  const double pixels = steady_count();
  if (pixels == 0) return std::nullopt;
  double squares = 0;
  for (std::size_t i = 0; i < std::size(moments_); ++i)
    if (steady_.ages()[i] == steady_.frames()) squares += moments_[i].squares;
  return std::sqrt(squares / (pixels * static_cast<double>(steady_.frames())));
}

std::optional<double> TimeScore::steady_share() const {
  if (follows_camera()) {
    const Flicker& shortest = flicker_.front();
    if (shortest.tested == 0) return std::nullopt;
    return static_cast<double>(shortest.count) / static_cast<double>(shortest.tested);
  }
  if (steady_.tested_at_first() == 0) return std::nullopt;
  return steady_count() / static_cast<double>(steady_.tested_at_first());
}

Metrics TimeScore::mean_of_channels() const {
  Metrics metrics = no_metrics_over_time();
  std::vector<Metrics> channels;
  for (const TimeScore& channel : channels_) channels.push_back(channel.metrics());
  for (auto& [metric, mean] : metrics) {
    mean = 0;
    for (const Metrics& channel : channels)
      mean = mean && channel.at(metric) ? std::optional(*mean + *channel.at(metric)) : std::nullopt;
    if (mean) *mean /= static_cast<double>(std::size(channels));
  }
  return metrics;
}

Metrics TimeScore::metrics() const {
  if (!channels_.empty()) return mean_of_channels();
  Metrics metrics = no_metrics_over_time();
  if (added_ == 0) return metrics;
  const auto put = [&](std::string_view metric, std::optional<double> value) { metrics.find(metric)->second = value; };
  for (const Flicker& flicker : flicker_)
    if (flicker.count > 0) put(flicker.metric, std::sqrt(flicker.squares / static_cast<double>(flicker.count)));
  put("steady_share", steady_share());
  if (follows_camera()) return metrics;
  put("temporal_sd", temporal_sd());
  const Flips::Counts flips =
      flips_.count(static_cast<std::size_t>(std::min<double>(frame_rate_ / matches_per_second, frames_)));
  if (flips.pairs > 0) {
    const double pixel_seconds = static_cast<double>(flips.pairs) / frame_rate_;
    put("false_flips", static_cast<double>(flips.unmatched) / pixel_seconds);
    put("late_flips", static_cast<double>(flips.late) / pixel_seconds);
  }
  return metrics;
}

Metrics no_metrics_over_time() {
  Metrics metrics;
  for (const MetricInfo& info : metric_infos())
    if (info.of == MetricInfo::Of::row) metrics[std::string(info.name)] = std::nullopt;
  return metrics;
}

std::string flicker_obstacle(double frame_rate) {
  if (std::fmod(frame_rate, lags_per_second) == 0) return {};
  return fmt::format("{} frames a second is no multiple of {}", frame_rate, lags_per_second);
}

}  // namespace gnomon
