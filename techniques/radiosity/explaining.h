#pragma once
#include <gnomon/technique.h>

#include <string>

#include "layers.h"
#include "lighting.h"

namespace gnomon::radiosity {

inline constexpr OwnCause own_causes[] = {
    {"interpolated", "Light is not linear between the points where it was computed: the element is too large.", {32, 144, 255}},
    {"crossed_patch",
     "A surface touches or cuts the element: light or shadow leaks from a point on the other side.",
     {252, 0, 132}},
    {"few_rays", "Too few rays sampled the lamp at the points where light was computed.", {188, 88, 48}},
    {"hemicube_aliasing",
     "The lamp's hemicube has too few texels for the element, which got one too many or too few.",
     {20, 255, 148}},
};

/// Why a pixel's answer differs from what its own point would get.
class Explainer {
 public:
  Explainer(const Surfaces& surfaces, const Lighting& lighting, bool uses_corners, bool uses_hemicube)
      : surfaces_(surfaces), lighting_(lighting), uses_corners_(uses_corners), uses_hemicube_(uses_hemicube) {}

  /// One of `own_causes`, or nothing where the point, asked by itself with many rays, would get the same.
  ///
  ///   answer - point = (answer - exact) + (exact - point)
  ///                     few_rays,           interpolated,
  ///                     hemicube_aliasing   crossed_patch
  ///
  /// `exact` is interpolated between the same points, each asked with as many rays as the pixel's own point. The larger term
  /// decides; it is `crossed_patch` where one of the points does not see the pixel's.
  std::string cause(const glm::dvec3& point, const Found& found, double answer) const;

 private:
  Factor lamp_at(const Receiving& at) const;
  const Surfaces& surfaces_;
  const Lighting& lighting_;
  bool uses_corners_, uses_hemicube_;
};

}  // namespace gnomon::radiosity
