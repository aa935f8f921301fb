#include "measure/score/together.h"

#include <algorithm>
#include <cassert>
#include <map>

#include "measure/picture/shading.h"

namespace gnomon {

namespace {

/// Sums over the lights at one pixel, in double: the order of the lights then does not show in a float.
struct ShareSums {
  double mask = 0, shown = 0, reference = 0, half = 0, variance = 0, pixel_mean = 0, pixel_half = 0;
  double worst = 0;  ///< the largest error of one light that has a cause, as light received
};

void add(const Evidence& e, const std::vector<double>& received, Together& whole, std::vector<ShareSums>& sums) {
  for (std::size_t i = 0; i < received.size(); ++i) {
    ShareSums& sum = sums[i];
    whole.received[i] += received[i];
    whole.classes[i] = std::max(whole.classes[i], e.classes[i]);  // from B to T
    const double reference = received[i] * e.reference[i];
    const double mask = e.classes[i] == PixelClass::T ? received[i] * e.mask[i] : reference;
    sum.reference += reference;
    const bool has_half = e.classes[i] == PixelClass::T && !e.reference_half.empty();
    sum.half += has_half ? received[i] * e.reference_half[i] : reference;
    sum.mask += mask;
    const bool is_over_pixel = e.classes[i] == PixelClass::T && !e.pixel_mean.empty();
    sum.pixel_mean += is_over_pixel ? received[i] * e.pixel_mean[i] : reference;
    sum.pixel_half += is_over_pixel ? received[i] * e.pixel_half[i] : reference;
    if (is_over_pixel) whole.pixel_kept[i] = std::min(whole.pixel_kept[i], e.pixel_kept[i]);
    sum.shown += received[i] * e.mask[i];
    const double deviation = e.reference_error.empty() ? 0 : received[i] * e.reference_error[i];
    sum.variance += deviation * deviation;
    const double error = std::abs(mask - reference);
    if (e.causes.empty() || e.causes[i] == Cause::none || !(error > sum.worst)) continue;
    sum.worst = error;
    whole.causes[i] = e.causes[i];
  }
}

/// Lights of one channel or of none. `row` is all lights of the row: what one of them has, every channel has.
Together sum_of(std::span<const Evidence> lights, std::span<const Evidence> row) {
  const GBuffer& gbuffer = *lights.front().gbuffer;
  const std::size_t pixels = gbuffer.size();
  Together whole{.scene = lights.front().scene,
                 .gbuffer = &gbuffer,
                 .received = std::vector<double>(pixels),
                 .classes = std::vector<PixelClass>(pixels, PixelClass::B),
                 .own_causes = {lights.front().own_causes.begin(), lights.front().own_causes.end()}};
  const auto any_has = [&](auto member) {
    return std::ranges::any_of(row, [&](const Evidence& e) { return !(e.*member).empty(); });
  };
  if (any_has(&Evidence::causes)) whole.causes.assign(pixels, Cause::none);
  if (any_has(&Evidence::pixel_kept)) whole.pixel_kept.assign(pixels, pixel_rays);
  std::vector<ShareSums> sums(pixels);
  for (const Evidence& e : lights) add(e, received_light(gbuffer, *e.light), whole, sums);

  whole.mask.assign(pixels, 1.0f);
  whole.reference = whole.shown = whole.mask;
  if (any_has(&Evidence::reference_error)) whole.reference_error.assign(pixels, 0.0f);
  if (any_has(&Evidence::reference_half)) whole.reference_half.assign(pixels, 1.0f);
  if (!whole.pixel_kept.empty()) whole.pixel_mean = whole.pixel_half = whole.mask;
  for (std::size_t i = 0; i < pixels; ++i) {
    if (whole.received[i] == 0) continue;
    const auto share = [&](double sum) { return static_cast<float>(sum / whole.received[i]); };
    whole.mask[i] = share(sums[i].mask);
    whole.shown[i] = share(sums[i].shown);
    whole.reference[i] = share(sums[i].reference);
    if (!whole.pixel_mean.empty()) whole.pixel_mean[i] = share(sums[i].pixel_mean);
    if (!whole.pixel_half.empty()) whole.pixel_half[i] = share(sums[i].pixel_half);
    if (!whole.reference_half.empty()) whole.reference_half[i] = share(sums[i].half);
    if (!whole.reference_error.empty()) whole.reference_error[i] = share(std::sqrt(sums[i].variance));
  }
  return whole;
}

/// Takes pixel `i` of a channel.
void take(Together& whole, const Together& channel, std::size_t i) {
  const auto take = [&](auto member) {
    if (!(whole.*member).empty()) (whole.*member)[i] = (channel.*member)[i];
  };
  take(&Together::classes);
  take(&Together::causes);
  take(&Together::pixel_kept);
  for (const auto member : {&Together::mask, &Together::reference, &Together::reference_error, &Together::reference_half,
                            &Together::pixel_mean, &Together::pixel_half})
    take(member);
}

Together worst_of(std::vector<Together> channels) {
  Together whole = channels.front();
  whole.channel.reset();
  for (std::size_t i = 0; i < whole.mask.size(); ++i) {
    double shown = 0;
    for (const Together& channel : channels) {
      shown += channel.shown[i];
      const auto rank = [i](const Together& of) { return std::pair(of.classes[i], std::abs(of.mask[i] - of.reference[i])); };
      if (rank(channel) > rank(whole)) take(whole, channel, i);
    }
    whole.shown[i] = static_cast<float>(shown / static_cast<double>(channels.size()));
  }
  whole.channels = std::move(channels);
  return whole;
}

}  // namespace

Together together(std::span<const Evidence> lights) {
  assert(!lights.empty());
  std::map<std::optional<Channel>, std::vector<Evidence>> by_channel;
  std::vector<std::string> names;
  for (const Evidence& light : lights) {
    by_channel[channel_of(light.light->name)].push_back(light);
    names.push_back(light.light->name);
  }
  std::vector<Together> channels;
  for (const auto& [channel, of] : by_channel) {
    channels.push_back(sum_of(of, lights));
    channels.back().channel = channel;
    if (channel && whole_count(names) == 1) channels.back().kind = lights.front().kind;
  }
  return channels.size() > 1 ? worst_of(std::move(channels)) : std::move(channels.front());
}

Together together_in_gray(std::span<const Evidence> lights) { return sum_of(lights, lights); }

Evidence Together::evidence() const {
  std::vector<Evidence> each;
  for (const Together& one : channels) each.push_back(one.evidence());
  return {.width = gbuffer->width,
          .height = gbuffer->height,
          .classes = classes,
          .reference = reference,
          .mask = mask,
          .causes = causes,
          .scene = scene,
          .gbuffer = gbuffer,
          .reference_error = reference_error,
          .reference_half = reference_half,
          .pixel_mean = pixel_mean,
          .pixel_half = pixel_half,
          .pixel_kept = pixel_kept,
          .received = received,
          .own_causes = own_causes,
          .kind = kind,
          .channels = std::move(each)};
}

}  // namespace gnomon
