#pragma once
// What a technique says of its work beside the mask: counts, why a pixel got its answer, pictures, shadows as polygons.
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace gnomon {

/// Machine-independent work and memory of the last stages: nodes, fragments, texels, rays, bytes.
struct Count {
  /// How the counts of several objects, one for each light, become one.
  enum class Together { sum, largest, mean };
  std::string name;  ///< "bytes" is all it holds for scene, light and picture after resolve: sizes, not room; GL included, but
                     ///< for what kit/gl/gl hands out
  double value = 0;
  std::string unit;
  Together together = Together::sum;  ///< a depth is the `largest`, what is counted for each of something a `mean`
  /// It says what queries met in a tree whose shape an update may keep: then it is not what a build leads to.
  bool is_by_tree = false;
};
using Counts = std::vector<Count>;

/// One sample that took part in the decision about a pixel, as a ray from the light through the sample's center.
struct Tap {
  glm::dvec3 origin{0};     ///< the light, or a point of the near plane for a directional light
  glm::dvec3 direction{0};  ///< unit, away from the light
  double weight = 1;        ///< weights of a pixel sum to 1
  double stored = 0;        ///< meters along `direction` to the stored surface; infinity when nothing is stored
};

/// One place of a light with area that was sampled for a pixel.
struct LightSample {
  glm::dvec3 place{0};    ///< world space; of a sphere any point on the way to it that was sampled
  double weight = 1;      ///< weights of a pixel sum to 1
  double visibility = 1;  ///< what the technique found there: 1 seen, 0 hidden
};

/// Why a pixel got its answer. Techniques with light-space samples give taps, those that sample places of a light with area
/// give samples; geometric ones the element that decided.
struct Explanation {
  bool covered = true;  ///< false: outside the light frustum, cascade, receiver set or caster set
  std::vector<Tap> taps;
  double bias = 0;  ///< total bias as meters along the light ray; also what a shifted look-up point is nearer to the light by
  double texel_width = 0;                ///< world width of a texel at the pixel's point, meters; 0 without taps
  std::optional<glm::dvec3> shifted;     ///< the look-up point, when it is not the pixel's point
  std::optional<std::uint64_t> element;  ///< fragment, volume or plane that decided
  /// Where polygons stand for a curve that the technique sees: how far their outline may be off at the point, meters across the
  /// light's ray.
  double outline_error = 0;
  /// The formula or setting that answered is known to be wrong here: the technique's own exact one answers otherwise.
  bool formula_differs = false;
  std::vector<LightSample> samples = {};  ///< of a light with area
  std::string cause = {};                 ///< id of the one of About::causes that holds here; empty: none of them
};

/// What part of a light is left along a ray: a point of a curve for each depth, in their order.
struct SharesAlong {
  std::vector<double> depth;  ///< meters along the ray, as Tap::stored
  std::vector<double> share;  ///< as many, 0 .. 1
};

/// What a technique holds for the ray of the texel in which a pixel was looked up, from the near end of its image to the far
/// one, and what is true of that ray. Of casters that let light through alone.
struct DepthCurve {
  SharesAlong held;     ///< as a look-up at each depth answers
  SharesAlong exact;    ///< corners of a staircase: the product of the surfaces so far
  double receiver = 0;  ///< depth at which the pixel was looked up, bias included
};

/// A color of a debug layer and its meaning, as its legend shows them.
struct Swatch {
  std::string name;  ///< "5-8"
  glm::dvec3 color;  ///< linear RGB in 0 .. 1
};

/// A surface-detail polygon: a convex part of a triangle that is lit, or in cast shadow, throughout. Under a light with area it
/// is lit where all of the light is seen, in shadow where nothing is, and else in the penumbra.
struct DetailPolygon {
  std::uint32_t mesh, triangle;
  bool is_lit;
  std::uint32_t first, count;  ///< its corners, of SurfaceDetail::corners
  bool is_penumbra = false;    ///< then it is not lit
};

/// Shadows as geometry: the receiving triangles that are not edge-on to the light, in polygons that do not overlap. It is about
/// the side of a triangle that is turned to the light; the other one is in attached shadow.
struct SurfaceDetail {
  std::vector<glm::dvec3> corners;      ///< world space, in the plane of their triangle but for rounding in double
  std::vector<DetailPolygon> polygons;  ///< mesh after mesh, triangle after triangle; wound as their triangle is
};

/// A picture of what a technique holds or did.
struct DebugLayer {
  std::string name;                 ///< "volumes"
  std::string sentence;             ///< what it shows, and what its colors mean
  std::vector<Swatch> legend = {};  ///< shown below the picture, in this order
};

}  // namespace gnomon
