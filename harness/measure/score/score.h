#pragma once
#include "measure/record/record.h"
#include "measure/score/metrics.h"

namespace gnomon {

/// What one technique answered for one frame and light, and what counts.
struct Answer {
  GBuffer gbuffer;
  Reference reference;
  std::vector<float> mask;
  std::vector<Cause> causes;                        ///< empty until they are looked for
  LightShareKind estimates = LightShareKind::area;  ///< what the mask is compared with under a light with area
  std::vector<CauseInfo> own_causes = {};           ///< of the technique; the texts they refer to outlive the answer
  std::vector<std::uint32_t> parts = {};            ///< Technique::image_parts
  PixelTruth pixel_truth = {};                      ///< empty where the row does not ask for it

  /// Scene and light must outlive it, as this must.
  Evidence evidence(const Scene& scene, const Light& light) const { return evidence(&scene, &light); }
  /// For what needs neither scene nor light.
  Evidence evidence(const Scene* scene = nullptr, const Light* light = nullptr) const {
    const bool is_irradiance = estimates == LightShareKind::irradiance && !reference.irradiance.empty();
    return {.width = gbuffer.width,
            .height = gbuffer.height,
            .classes = reference.classes,
            .reference = is_irradiance ? reference.irradiance : reference.mask,
            .mask = mask,
            .causes = causes,
            .scene = scene,
            .gbuffer = &gbuffer,
            .light = light,
            .snapping = reference.snapping,
            .reference_error = is_irradiance ? reference.irradiance_error : reference.error,
            .reference_half = is_irradiance ? reference.irradiance_half : reference.half,
            .other_reference = is_irradiance ? reference.mask : reference.irradiance,
            .caster_distance = reference.caster_distance,
            .surfaces = reference.surfaces,
            .pixel_mean = pixel_truth.mean,
            .pixel_half = pixel_truth.half,
            .pixel_kept = pixel_truth.kept,
            .own_causes = own_causes,
            .parts = parts,
            .kind = reference.kind};
  }
};

/// What each cause holds of the mean error over T, by name, every cause; zeros too. They add up to it. Of several channels the
/// mean over them.
std::map<std::string, double> cause_errors(const Evidence& evidence);
/// Why a record's causes do not belong to today's frames: they were found on frames of another version. Empty where they do.
std::string causes_obstacle(const Record& record);

/// All metrics but those that only all frames of a row have (TimeScore); of several channels the means over them.
Metrics measure_metrics(const Scoring& scoring);
/// One of them; the name is that of such a metric.
std::optional<double> measure_metric(const Scoring& scoring, std::string_view name);

/// "B": n, ...
std::map<std::string, std::uint64_t> class_counts(std::span<const PixelClass> classes);

/// Raw floats that a worker wrote, the masks of so many lights of `pixels` each; throws Error when the size is wrong or a value
/// is not in 0 .. 1, with the pixel and of several lights the number of the light, from 1.
std::vector<float> read_mask_file(const std::filesystem::path& file, std::size_t pixels, std::size_t lights = 1);

}  // namespace gnomon
