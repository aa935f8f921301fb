#pragma once
#include <functional>

#include "measure/frame/frame.h"

namespace gnomon {

/// Why a pixel is wrong: ordered, exhaustive, first match decides. `unexplained` is meant to be 0. docs/causes.md derives each.
/// Under a light with area, every pixel that is off at all has one; those from `reference_error` on come before the ones that
/// a mask alone shows. Numbers behind the last are causes of a technique's own (own_causes.h).
enum class Cause : std::uint8_t {
  none,  ///< right, or not tested
  mask_shift,
  mask_gamma,
  mask_blur,
  tessellation,
  beyond_coverage,
  formula,
  missing_caster,
  edge_resolution,
  filter_width,
  lookup_shift,
  acne,
  over_dark,
  peter_panning,
  leak_layered,
  leak_representation,
  crack,
  edge_raster,
  edge,
  region,
  reference_error,
  false_sample,
  horizon,
  hard_shadow,
  banding,
  noise,
  caster_fusion,
  lost_umbra,
  too_wide,
  too_narrow,
  shifted,
  unexplained,
};

/// One cause is one row; the order is the order of matching.
struct CauseInfo {
  Cause cause;
  std::string_view name;                ///< "acne"
  std::string_view sentence;            ///< what it means, for people
  std::array<std::uint8_t, 3> color{};  ///< sRGB, in every picture
};
/// All that every technique may have, but `none`, in order.
std::span<const CauseInfo> cause_infos();
/// Of one of those, or of `none`.
std::string_view name(Cause cause);

struct WholeMask;  // whole_mask.h

/// A mask and all that its causes are found from.
struct Attribution {
  const Scene& scene;
  const RayScene& casters;  ///< under the truth of the G-buffer
  const GBuffer& gbuffer;
  const Light& light;
  const Reference& reference;
  std::span<const float> mask;
  /// 1 where the same technique is right on the mesh G-buffer against mesh truth, under a light with area within four standard
  /// errors; empty where there is no second truth, and for a technique that sees shapes.
  std::span<const std::uint8_t> right_on_mesh;
  /// The technique's own account of each of these pixels of this mask, in their order; nothing where it has none.
  std::function<std::vector<std::optional<Explanation>>(std::span<const std::uint32_t> pixels)> explain;
  LightShareKind estimates = LightShareKind::area;  ///< what the mask is compared with under a light with area
  std::span<const CauseInfo> own_causes = {};       ///< that an explanation may name
  bool rasterizes = false;                          ///< see About
  const WholeMask* whole = nullptr;                 ///< a change of the whole mask by the program that made it; null: none

  /// The cause of a wrong pixel that a change of the whole mask or the triangles in place of shapes give; else `none`.
  Cause found_without_technique(std::size_t i) const;
  /// What `explain` answers. Throws Error where it is not one answer for each pixel.
  std::vector<std::optional<Explanation>> explanations(std::span<const std::uint32_t> pixels) const;
  /// The cause that an explanation names: beyond_coverage, formula or one of the technique's own; else `none`.
  Cause named_cause(const Explanation& why) const;
};

/// The cause of every wrong pixel of class T, under a light with area of every one that is off at all; `none` elsewhere;
/// width * height. Throws Error on an explanation that names a cause which is not among the technique's own.
std::vector<Cause> find_causes(const Attribution& attribution);

/// By name, every cause, common and `own`; zeros too.
std::map<std::string, std::uint64_t> count_causes(std::span<const Cause> causes, std::span<const CauseInfo> own = {});

/// The causes of a picture that holds each as a number: 0 is none, k the k-th of those that its record counts (`counts`, as
/// count_causes wrote them); the `own` ones of its record follow. An older program with fewer causes numbered fewer. Without
/// counts the numbers are today's. Throws Error on a number that is none of these.
std::vector<Cause> causes_from_numbers(std::span<const float> numbers,
                                       const std::optional<std::map<std::string, std::uint64_t>>& counts,
                                       std::span<const CauseInfo> own = {});

/// Explanations as bytes, between a worker and its owner. Throws Error on an explanation that cannot be traced: a number that
/// is not finite (but a stored distance may be infinite), or a tap's direction that has not length 1.
std::vector<std::byte> explanation_bytes(std::span<const std::optional<Explanation>> explanations);
/// The inverse. Throws Error on bytes of another layout.
std::vector<std::optional<Explanation>> explanations_from_bytes(std::span<const std::byte> bytes);

}  // namespace gnomon
