#pragma once
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/gl/image_passes.h>
#include <gnomon/kit/maps/light_camera.h>

namespace gnomon {

// Means over texels of a light's images, for maps that are filtered before they are read: made when the images are drawn, and
// looked up at each pixel's place. A pixel's footprint is the parallelogram that it covers on the image, over the plane of its
// point.

struct Prefilter {
  enum class Kind {
    blur,  ///< every texel is blurred; the four around a place are weighted as graphics cards do
    mips,  ///< levels of halved images; between eight texels of the two levels nearest to the footprint's longer side
    table  ///< a summed-area table; the mean of the box around the footprint, texels at its border by the share it holds
  };
  Kind kind = Kind::blur;
  Blur::Weights weights = Blur::Weights::box;  ///< of a blur
  int radius = 0;                              ///< texels; means spread no less than those of a box of 2 radius + 1
  int widest_footprint = 1;                    ///< texels; those of mips and table follow footprints up to this

  /// The least footprint that is looked up. Between texels of a level k that weigh as graphics cards do, squares of distances
  /// are 4^k / 4 in the mean over places, three times those in a box of 2^k.
  double narrowest() const;
  int widest() const;
  /// Of mips, the last that is looked at.
  int last_level() const;
  /// Texels beside a place that a look-up may reach, and one for rounding. Level k reaches 3/2 of its texels, 3 * 2^(k-1).
  int margin() const;
  /// How often a texel is stored, and rounded where it has 16 bits, before its mean is read.
  int stores() const;
  /// What a table holds in place of 1: sums over the widest box stay below 2^32 then, and differences of any are exact.
  double whole() const;
  /// What storing takes off a mean: in a table half of 1 / whole(), of 16 bits that of every store.
  StoredRounding rounding(GLenum format) const;
  /// Unsupported where levels would not lie on each other, and where a table would end at the edge of a cube's face.
  Support supports(const Light& light, int resolution) const;
  /// Which texels count for a place on an image of `resolution` texels, with weights that add up to 1. Columns of `pixel` are
  /// `pixel_on_image`. Some may lie beside the image.
  std::vector<WeightedTexel> texels(const glm::dvec2& place, const glm::dmat2& pixel, int resolution) const;
};

/// Texels by which the image's place moves from pixel to pixel, along rows and down columns, over the plane of a pixel's point:
/// the exact derivative.
glm::dmat2 pixel_on_image(const LightImage& image, const Camera& camera, const glm::dvec3& point, const glm::dvec3& normal);
/// Squares of its singular values: of the longest and the shortest way across the pixel's footprint.
glm::dvec2 squared_ways(const glm::dmat2& pixel);

/// GLSL after light_map_snippet: `vec4 mean_at(vec3 place, vec3 position, vec3 normal)`, the mean at a place of the image in
/// texels (with z, the axis distance). Constants; samplers: light_map, and of a table light_sums at unit 4 in its place.
std::string prefilter_snippet(Prefilter::Kind kind);
std::string prefilter_constants(Prefilter::Kind kind);
/// How many they are.
int prefilter_constant_count(Prefilter::Kind kind);
/// Sets them. `one` is what a table holds for 1, of each channel, over whole().
void set_prefilter(const Program& program, const Prefilter& prefilter, const View& view, int width, int height,
                   const glm::vec4& one);

}  // namespace gnomon
