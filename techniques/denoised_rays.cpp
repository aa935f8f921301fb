// Denoised rays: 1 to 4 shadow rays from every visible point, a filter over pixels and a memory over frames.
#include <gnomon/kit/bytes.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/rays/ray_casters.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "denoised_rays/layers.h"
#include "denoised_rays/pixel_rays.h"
#include "denoised_rays/twin.h"
#include "denoised_rays/widths.h"

namespace {
using namespace gnomon;
using namespace denoised_rays;

constexpr About about{
    .title = "Denoised rays",
    .summary = "One to four shadow rays from every visible point, averaged over pixels around it and over frames before.",
    .source =
        "Schied et al. 2017 (variance-guided filter); Dammertz et al. 2010 (a-trous levels); Mehta et al. 2012 (width from "
        "the casters' distance); Heitz, Hill and McGuire 2018 (ratio of sums); Roberts 2018 (R2); Ulichney 1993 (void and "
        "cluster); AMD 2021 (tiles, clamped history).",
    .error =
        "A mean over sigma pixels blurs a penumbra of as many; one ray's noise falls with the number of pixels averaged. With "
        "memory a share of (1 - alpha)^n of what was n frames ago is left where light or casters moved. It estimates the "
        "share of the irradiance; division=pixel with one ray that of the area. The error terms are exact.",
    .fails =
        "Penumbrae of several widths at one pixel, behind one another; contacts narrower than a pixel; light or casters that "
        "move, with memory.",
    .promise = Promise::sampled,
    .sees = Truth::shape,
    .estimates = LightShareKind::irradiance,
    .handles = with_gray_transmission,
    .causes = own_causes,
    .remembers = true,
    .named_only = true};

/// Whether two lights shine alike from the same places.
bool is_same(const Light& a, const Light& b) {
  if (a.kind.index() != b.kind.index()) return false;
  const auto has_same_bits = [&](const auto& kind) {
    using Kind = std::decay_t<decltype(kind)>;
    static_assert(std::is_trivially_copyable_v<Kind>);
    return std::memcmp(&kind, &std::get<Kind>(b.kind), sizeof kind) == 0;
  };
  return std::visit(has_same_bits, a.kind);
}

class DenoisedRays final : public Technique {
  Number<int> rays{this, "rays", 1, {"ray", 1, 4}, Stage::setup, "Rays from a point to the light in every frame."};
  Choice pattern = Choice(this, "pattern", "blue",
                          std::vector<std::string_view>(ray_pattern_names.begin(), ray_pattern_names.end()), Stage::setup,
                          "Where they go: a blue-noise mask over pixels, shifted from ray to ray and frame to frame; R2 "
                          "over rays and frames, shifted over pixels; scrambled Sobol; or anywhere.");
  Choice filter = Choice(this, "filter", "width", {"width", "svgf", "tiles", "none"}, Stage::resolve,
                         "The mean over pixels: as wide as the casters' distances make the penumbra; by variance; by three "
                         "small passes where a tile is not all lit or all dark; none.");
  Choice division = Choice(this, "division", "sums", {"sums", "pixel"}, Stage::resolve,
                           "When the irradiance that arrives is divided by all of it: after the filter, or pixel by pixel "
                           "before it, which is biased.");
  // A picture alone, as suites score it, is the first frame of a sequence: there memory is cost without effect.
  Choice memory = Choice(this, "memory", "off", {"off", "accumulate", "clamp"}, Stage::resolve,
                         "Where frames follow one another: their mean is none; exponential; the same with the history held "
                         "to the shares around the pixel.");
  Number<double> alpha = Number<double>(this, "alpha", 0.05, {.min = 0.01, .max = 1, .log = true}, Stage::resolve,
                                        "The newest frame's part in a long memory; for memory=accumulate and clamp.");
  Number<int> longest = Number<int>(this, "longest", 64, {.unit = "frame", .min = 1, .max = 4096, .log = true}, Stage::resolve,
                                    "Frames that a history counts as at most; for memory=accumulate and clamp.");
  Choice on_change = Choice(this, "on_change", "clamp", {"keep", "drop", "clamp"}, Stage::resolve,
                            "The history in a frame whose light or casters moved: kept, dropped, or held to the shares around "
                            "the pixel; for memory=accumulate and clamp.");
  Number<int> seed{this, "seed", 1, {"", 0, 1000000}, Stage::setup, "Other random numbers."};
  Number<double> pick_x = Number<double>(this, "pick_x", 0.5, {.min = 0, .max = 1}, Stage::resolve,
                                         "Place in the picture, from its left border, of the pixel of layer weights.");
  Number<double> pick_y{this, "pick_y", 0.5, {.min = 0, .max = 1}, Stage::resolve, "The same from the upper border."};

 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    if (!has_area(light)) return Support::unsupported("the light has no area: its shadows are hard, see embree_rays");
    return Support::full();
  }
  void setup() override {
    made_->places.emplace(static_cast<RayPattern>(pattern.index()), rays.value(), static_cast<std::uint64_t>(seed.value()));
  }
  void build(const Scene& scene) override {
    made_->casters.build(scene);
    made_->pose = std::make_shared<const Pose>(scene);
    ++made_->build_count;
  }
  void update(const Scene& scene, const Changes& changes) override {
    made_->casters.update(scene, changes);
    if (!changes.empty()) made_->pose = std::make_shared<const Pose>(made_->pose->after(scene, changes));
  }
  void relight(const Light& light) override { light_ = light; }
  void forget() override {
    begins_ = true;
    reprojection_.forget();
    for (Denoiser* denoiser : {&denoiser_, &by_sums_}) denoiser->forget();
    twin_.forget();
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    // Another scene or other settings: nothing of the frames before has a place in it.
    const Settings now = settings_now();
    if (known_build_ != made_->build_count || !(now == settings_)) forget();
    known_build_ = made_->build_count;
    frame_ = begins_ ? 0 : frame_ + 1;
    begins_ = false;
    terms_.clear();
    for (Denoiser* denoiser : {&denoiser_, &by_sums_}) denoiser->advance();
    twin_.advance();
    gbuffer_ = &gbuffer;
    settings_ = now;
    look(gbuffer);

    const std::span<float> pixels = mask.pixels();
    mask_.resize(pixels.size());
    for_blocks(pixels.size(), 4096, [&](std::size_t begin, std::size_t end) {
      std::fill(mask_.begin() + static_cast<std::ptrdiff_t>(begin), mask_.begin() + static_cast<std::ptrdiff_t>(end), 1.0f);
    });
    denoiser_.step(input(), settings_, filter_, mask_);
    for_blocks(pixels.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) pixels[i] = mask_[i];
    });
    if (settings_.remembers())
      reprojection_.keep(gbuffer, made_->pose);
    else
      reprojection_.forget();
    last_light_ = light_;
  }
  Counts counts() const override {
    const double shared = made_->casters.bytes() + static_cast<double>((made_->pose ? made_->pose->bytes() : 0) +
                                                                       (made_->places ? made_->places->bytes() : 0));
    // What error_terms keeps is no part of an answer.
    const std::size_t own = rays_.bytes() + guides_.bytes() + widths_.bytes() + reprojection_.bytes() + denoiser_.bytes() +
                            filter_.bytes() + bytes_of(mask_, divided_, asked_once_);
    return {{"rays", static_cast<double>(rays_.ray_count), ""},
            {"bytes", made_.own(shared) + static_cast<double>(own), "byte"}};
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &DenoisedRays::made_); }
  std::vector<ErrorTerm> error_terms(std::span<const float> exact) override;
  std::optional<Explanation> explain(std::size_t index) const override;
  std::vector<DebugLayer> debug_layers() const override { return layers(); }
  std::vector<float> draw_debug(std::string_view layer) const override;

 private:
  struct Made {
    RayCasters casters;
    std::optional<RayPlaces> places;
    std::shared_ptr<const Pose> pose;  ///< where the scene's vertices are
    std::uint64_t build_count = 0;
  };

  Settings settings_now() const {
    return {.filter = static_cast<Filter>(filter.index()),
            .memory = static_cast<Memory>(memory.index()),
            .on_change = static_cast<OnChange>(on_change.index()),
            .by_pixel = division.is("pixel"),
            .alpha = static_cast<float>(alpha.value()),
            .longest = static_cast<float>(longest.value())};
  }
  FrameRays frame_rays() const { return {made_->casters.under(gbuffer_->truth), *gbuffer_, light_, *made_->places, frame_}; }
  /// All that the filters start from: rays, guides, widths, sources.
  void look(const GBuffer& gbuffer);
  FrameInput input() const {
    return {.guides = guides_,
            .faces = rays_.faces,
            .asked = settings_.by_pixel ? std::span<const float>(asked_once_) : std::span<const float>(rays_.asked),
            .seen = settings_.by_pixel ? std::span<const float>(divided_) : std::span<const float>(rays_.seen),
            .sigma = widths_.sigma(),
            .sources = reprojection_.sources(),
            .source_width = reprojection_.source_width(),
            .has_changed = has_changed_};
  }
  std::size_t picked() const {
    const auto at = [](double share, int size) { return std::min(static_cast<int>(share * size), size - 1); };
    return static_cast<std::size_t>(at(pick_y, gbuffer_->height)) * gbuffer_->width + at(pick_x, gbuffer_->width);
  }

  Shared<Made> made_;
  Light light_, last_light_;
  const GBuffer* gbuffer_ = nullptr;
  Settings settings_;
  std::uint32_t frame_ = 0;                   ///< of the last resolve, counted from the last forget
  bool begins_ = true, has_changed_ = false;  ///< begins: the next resolve is the first of a sequence
  std::uint64_t known_build_ = 0;

  RayPlanes rays_;
  FilterGuides guides_;
  Widths widths_;
  Reprojection reprojection_;
  GuidedFilter filter_;
  Denoiser denoiser_;
  UnsetVector<float> mask_, divided_, asked_once_;

  Denoiser by_sums_;  ///< with division=pixel what division=sums would answer, for the bias
  GuidedFilter untimed_filter_;
  Twin twin_;
  std::vector<ErrorTerm> terms_;  ///< of the last resolve
};

void DenoisedRays::look(const GBuffer& gbuffer) {
  const std::size_t size = gbuffer.size();
  const bool is_by_width = settings_.filter == Filter::width;
  frame_rays().trace(is_by_width, rays_);
  if (settings_.filter != Filter::none || settings_.remembers()) guides_.make(gbuffer, rays_.faces);
  if (is_by_width) widths_.make(guides_, gbuffer, light_, made_->places->ray_count(), filter_, rays_);
  has_changed_ = reprojection_.has_last() && (reprojection_.last_pose() != made_->pose.get() || !is_same(light_, last_light_));
  if (settings_.remembers())
    reprojection_.follow(made_->casters.scene(), made_->pose, gbuffer, guides_, rays_.faces, denoiser_.last_lengths(),
                         has_changed_ && settings_.on_change == OnChange::drop);
  divided_.resize(settings_.by_pixel ? size : 0);
  asked_once_.resize(settings_.by_pixel ? size : 0);
  if (!settings_.by_pixel) return;
  for_blocks(size, 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      asked_once_[i] = rays_.asked[i] > 0 ? 1.0f : 0.0f;
      divided_[i] = rays_.asked[i] > 0 ? rays_.seen[i] / rays_.asked[i] : 0;
    }
  });
}

std::vector<ErrorTerm> DenoisedRays::error_terms(std::span<const float> exact) {
  if (begins_) return {};
  // With memory, whoever did not see all frames cannot tell what is stale.
  if (settings_.remembers() && !twin_.has_seen(frame_)) return {};
  FrameInput in = input();
  const Denoiser* denoiser = &denoiser_;
  std::vector<float> of_sums(mask_.begin(), mask_.end());
  if (settings_.by_pixel) {
    in.asked = rays_.asked;
    in.seen = rays_.seen;
    by_sums_.step(in, settings_, untimed_filter_, of_sums);
    denoiser = &by_sums_;
  }
  const std::vector<ErrorParts> parts = twin_.part(*denoiser, in, settings_, exact, of_sums);
  terms_.clear();
  for (const OwnCause& cause : own_causes) terms_.push_back({cause.id, std::vector<float>(exact.size())});
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (!rays_.faces[i]) continue;
    const bool is_new = settings_.remembers() && reprojection_.began_refused(i) && denoiser->lengths()[i] < short_history;
    terms_[is_new ? disocclusion : residual_noise].values[i] = static_cast<float>(parts[i].residual_noise);
    terms_[stale_history].values[i] = static_cast<float>(parts[i].stale_history);
    terms_[over_blur].values[i] = static_cast<float>(parts[i].over_blur);
    terms_[bias].values[i] = mask_[i] - of_sums[i];
  }
  return terms_;
}

std::optional<Explanation> DenoisedRays::explain(std::size_t index) const {
  Explanation why;
  const FrameRays rays_of_frame = frame_rays();
  const std::optional<LightFigure> figure = rays_of_frame.figure(index);
  if (!figure) return why;
  const Squares squares = rays_of_frame.squares(*figure, index);
  const FaceHits hits =
      FaceRays(made_->casters.under(gbuffer_->truth), *gbuffer_, index, *figure).ask(squares, rays_of_frame.wanted());
  double sum = 0;
  for (std::uint32_t left = hits.asked; left; left &= left - 1) {
    const int k = std::countr_zero(left);
    const glm::dvec2 place = figure->box().at({squares.x[k], squares.y[k]});
    why.samples.push_back({glm::dvec3(gbuffer_->position(index)) + figure->at(place), hits.weight[k], hits.seen(k)});
    sum += hits.weight[k];
  }
  for (LightSample& sample : why.samples) sample.weight = sum > 0 ? sample.weight / sum : 1.0 / double(why.samples.size());

  double difference = 0, largest = 0;
  for (const ErrorTerm& term : terms_) difference += term.values[index];
  for (const ErrorTerm& term : terms_)
    if (const double along = difference < 0 ? -term.values[index] : term.values[index]; difference != 0 && along > largest) {
      largest = along;
      why.cause = term.cause;
    }
  return why;
}

std::vector<float> DenoisedRays::draw_debug(std::string_view layer) const {
  const std::size_t size = gbuffer_->size();
  const std::span<const std::uint8_t> faces = rays_.faces;
  std::vector<float> values(size);
  const auto fill = [&](const auto& value) {
    for (std::size_t i = 0; i < size; ++i) values[i] = faces[i] ? static_cast<float>(value(i)) : 0;
  };
  if (const std::optional<std::size_t> term = term_of_layer(layer))
    return paint_signed(*gbuffer_, faces, terms_.empty() ? std::span<const float>() : terms_[*term].values);
  if (layer == "raw") {
    fill([&](std::size_t i) { return rays_.asked[i] > 0 ? rays_.seen[i] / rays_.asked[i] : 1; });
    return paint_gray(*gbuffer_, faces, values);
  }
  if (layer == "widths") {
    if (settings_.filter == Filter::width)
      fill([&](std::size_t i) { return std::min(width_of_sigma(widths_.sigma()[i]), 1e6); });
    return heat_layer(*gbuffer_, values);
  }
  if (layer == "variance") {
    if (settings_.looks_at_values()) fill([&](std::size_t i) { return 2 * std::sqrt(denoiser_.variance()[i]); });
    return paint_gray(*gbuffer_, faces, values);
  }
  if (layer == "length") {
    fill([&](std::size_t i) { return settings_.remembers() ? denoiser_.lengths()[i] : 1; });
    return heat_layer(*gbuffer_, values);
  }
  if (layer == "refused") {
    if (settings_.remembers()) fill([&](std::size_t i) { return reprojection_.is_refused(i) ? 1 : 0; });
    return paint_gray(*gbuffer_, faces, values);
  }
  if (layer != "weights") return Technique::draw_debug(layer);
  values = denoiser_.reach_of(input(), settings_, picked());
  const float most = *std::ranges::max_element(values);
  for (float& value : values) value = most > 0 ? value / most : 0;
  return paint_gray(*gbuffer_, faces, values);
}

}  // namespace

GNOMON_TECHNIQUE(denoised_rays, DenoisedRays, about)
