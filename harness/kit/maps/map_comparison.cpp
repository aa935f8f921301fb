#include <gnomon/kit/maps/map_comparison.h>

namespace gnomon {

int MapComparison::margin() const {
  const int offset = form.normal == BiasForm::Normal::none ? 0 : static_cast<int>(std::ceil(normal_offset));
  return filter.margin() + offset + 1;
}

namespace {

/// The light ray at a point, in the image's frame.
struct RayThere {
  glm::dvec3 normal, ray;  ///< the ray goes 1 along the axis
  double facing = -glm::dot(normal, ray), length = glm::length(ray), cosine = facing / length;
  double sine = glm::length(glm::cross(normal, ray)) / length;
};

/// What a preset adds along the axis beside its texels; `width` is that of a texel, along columns and rows.
double preset_bias(const MapComparison& comparison, const RayThere& there, const glm::dvec2& width) {
  using Slope = BiasForm::Slope;
  const double along = comparison.meters / there.length;
  if (comparison.form.slope == Slope::raster)
    return along + comparison.slope_bias * std::max(std::abs(there.normal.x) * width.x, std::abs(there.normal.y) * width.y) /
                       there.facing;
  if (comparison.form.slope == Slope::tangent)
    return along + comparison.slope_bias * std::max(width.x, width.y) * std::min(there.sine / there.cosine, 1.0);
  return along;
}

/// Where a normal offset of 1 m moves a point.
glm::dvec3 way_of_offset(BiasForm::Normal form, const RayThere& there) {
  using enum BiasForm::Normal;
  if (form == sine) return there.normal * there.sine;
  if (form == one_less_cosine) return there.normal * (1 - there.cosine);
  if (form == across) return there.normal + there.ray * (there.cosine / there.length);
  return there.normal;
}

}  // namespace

Explanation explain_comparison(const DepthTexels& texels, const MapComparison& comparison, const ExplainedPoint& point) {
  const LightImage& image = texels.image;
  Explanation why;
  glm::dvec3 q = image.seen(point.position);
  const RayThere there{image.turned(point.normal), image.is_perspective ? q / q.z : glm::dvec3(0, 0, 1)};
  const glm::dvec2 width = image.texel_width(q);
  why.texel_width = std::max(width.x, width.y);
  double axis_bias = comparison.depth_bias * why.texel_width;
  if (comparison.bias == MapComparison::Bias::slope)
    axis_bias += comparison.slope_bias * glm::length(width) / 2 * there.sine / there.facing;
  if (comparison.bias == MapComparison::Bias::receiver_plane) {
    const double error = texels.camera.rounding * (image.is_perspective ? 1 + q.z * q.z / (image.near * image.far) : 1);
    axis_bias += (error + why.texel_width / 128) / there.facing;
  }
  if (comparison.bias == MapComparison::Bias::adaptive)
    axis_bias += comparison.meters * std::min(1 / (there.cosine * there.cosine), most_adaptive);
  if (comparison.bias == MapComparison::Bias::preset) axis_bias += preset_bias(comparison, there, width);
  if (comparison.form.normal != BiasForm::Normal::none) {
    const double z = q.z;
    q += way_of_offset(comparison.form.normal, there) * (comparison.normal_offset * why.texel_width);
    why.shifted = image.to_world(q);
    axis_bias += z - q.z;  // what the look-up point is nearer to the light by
  }
  why.bias = axis_bias * there.length;
  // A point that nothing shadows may be looked up beside the image; where something does, its shadow is not in there.
  why.covered = texels.camera.holds(glm::ivec2(glm::floor(point.place)));
  const MapFilter& filter = comparison.filter;
  for (const auto& [texel, weight] :
       point.is_decided_early ? filter.first_texels(point.place) : filter.texels(point.place, point.pixel))
    if (weight > 0) why.taps.push_back(texels.camera.tap(image, texels.depths, texel, weight));
  return why;
}

// --- The same in the shader ------------------------------------------------------------------------------------------------

std::string comparison_head(const MapComparison& comparison) {
  // Adaptive is a receiver plane with another epsilon.
  using enum MapComparison::Bias;
  const bool adapts = comparison.bias == adaptive;
  return fmt::format("#define BIAS {}\n{}#define ADAPTS {:d}\n#define SLOPE_FORM {}\n#define NORMAL_FORM {}\n",
                     comparison.bias == preset ? 4 : static_cast<int>(adapts ? receiver_plane : comparison.bias),
                     filter_head(comparison.filter), adapts, static_cast<int>(comparison.form.slope),
                     static_cast<int>(comparison.form.normal));
}

// depth_bias, slope_bias (half of it for a half diagonal) and normal_offset, each times the filter's reach; rounding, or the
// meters of adaptive and of a preset. The diagonal of a texel in window coordinates, under parallel rays.
std::string comparison_constants(LightProjection projection, LightImages images) {
  const bool has_diagonal = projection == LightProjection::parallel && images == LightImages::faces;
  return light_map_constants(projection, images) + (has_diagonal ? "vec4 biases; float diagonal;" : "vec4 biases;");
}

void set_comparison(const Program& program, const Light& light, const LightCamera& camera, const MapComparison& comparison) {
  using Bias = MapComparison::Bias;
  set_light_camera(program, light, camera, [&](const LightImage& image) {
    if (!image.is_perspective) return image.far;
    return comparison.bias == Bias::slope ? glm::length(1.0 / image.scale) : camera.rounding / (image.near * image.far);
  });
  set_filter(program, comparison.filter);
  const bool has_meters = comparison.bias == Bias::adaptive || comparison.bias == Bias::preset;
  program.set_if_used("biases",
                      glm::vec4(comparison.depth_bias, comparison.slope_bias * (comparison.bias == Bias::preset ? 1 : 0.5),
                                comparison.normal_offset, has_meters ? comparison.meters : camera.rounding));
  program.set_if_used("diagonal", static_cast<float>(glm::length(1.0 / camera.images[0].scale)));
}

// Mirrors explain_comparison; see there for the meaning of each quantity. A branch on a uniform would be paid in full on
// llvmpipe, which executes both sides of every branch: so bias and filter are the head's. The last of an image's facts is far
// (parallel rays), the texel's diagonal in window coordinates (slope bias) or the rounding error of the depth per squared axis
// distance (receiver plane).
const std::string_view comparison_snippet = R"(
// Of a texel, in window coordinates.
#ifdef WARPED
#define diagonal length(light_stretch / light_window.xy)
#elif PROJECTION != 0
#define diagonal light_facts.w
#elif defined(SLICED)
#define diagonal length(1 / light_window.xy)
#endif

/// A point as it is compared with texels.
struct ComparedPoint {
  bool is_compared;
  vec2 position;
  float scale, depth, bias;  // all comparisons are multiplied by the scale
#if BIAS == 3
  vec2 step_height;
#endif
};

// Dark: something is stored, and before the receiver by more than the bias. No quotient of depths is formed: with a center,
// near / d < q_z / m - bias; where m <= 0 the texel's ray meets the receiver's plane at infinity.
float lit_at(ComparedPoint point, vec2 tap) {
  float d = stored_depth(tap), near = light_facts.z;
  // How much the receiver's plane rises toward the light between the point and the texel's center.
#if BIAS == 3
  float rise = dot(point.step_height, way_in_image(point.position, tap + 0.5));
#else
  const float rise = 0;
#endif
#if PROJECTION == 0
  float far = light_facts.w;
  bool dark = d > 0 && d * (far - near) * point.scale > far * point.scale - point.depth - rise + point.bias * point.scale;
#else
  float m = max(point.scale - rise, 0);
  bool dark = near * m < (point.depth - point.bias * m) * d;
#endif
  return dark ? 0 : 1;
}

ComparedPoint ask(vec4 surface, vec4 facet) {
  vec3 v = surface.xyz - light_origin, normal = facet.xyz;

  // What faces_light says, from the products that the look-up needs anyway.
#if PROJECTION == 0
  float height = height_over_light(normal), squared = 1;
#else
  float height = -dot(normal, v), squared = dot(v, v);
#endif
  bool faces = surface.w * facet.w * height > 0 && height * height > squared * 2.2737368e-13;

  choose_image(v);
#if BIAS == 4
  float cosine = height * inversesqrt(squared);
#endif
#if NORMAL_FORM == 1
  vec3 way = normal;
#elif NORMAL_FORM == 2
  vec3 way = normal * sqrt(max(1 - cosine * cosine, 0));
#elif NORMAL_FORM == 3
  vec3 way = normal * (1 - cosine);
#elif NORMAL_FORM == 4 && PROJECTION == 0
  vec3 way = normal + cosine * vec3(light_axes[0].z, light_axes[1].z, light_axes[2].z);
#elif NORMAL_FORM == 4
  vec3 way = normal + v * (cosine * inversesqrt(squared));
#endif
#if PROJECTION == 2
  float along = dot(v, spot.xyz);
#if NORMAL_FORM != 0
  vec3 a = abs(v);
  float before = max(max(a.x, a.y), a.z);
  v += way * (biases.z * light_facts.y * before);
#endif
  vec3 h = in_image(v);
#elif NORMAL_FORM != 0
#ifdef WARPED
  in_image(v);  // for the width of a texel there
#endif
  float along = (light_axes * v).z, before = along;
  v += way * (biases.z * light_facts.y * (PROJECTION == 0 ? 1 : along));
  vec3 h = in_image(v);
#else
  vec3 h = in_image(v);
  float along = h.z;
#endif
#if NORMAL_FORM == 0
  float before = h.z;  // along the axis, where the point lies
#endif
#if PROJECTION != 0
  faces = faces && along >= 0 && along * along >= spot.w * squared;
#endif

  // Texel coordinates; the axis distance; how fast the light ray, per unit of the axis, sinks into the receiver's plane.
  float q_z = h.z, fourth = light_facts.w;
#if PROJECTION == 0
  vec2 position = h.xy;
  float texel_width = light_facts.y, facing = height;
#else
  float per_z = 1 / q_z;
  vec2 position = h.xy * per_z;
  float texel_width = q_z * light_facts.y, facing = height * per_z;
#endif

  // All comparisons are multiplied by `scale`: the facing where a quotient by it would be needed, else 1.
  float scale = 1, bias = biases.x * texel_width, error = 0;
#if BIAS == 1
  // Half the diagonal times the tangent of the angle between normal and ray, times the facing: its sine over the axis.
#if PROJECTION == 0
  error = biases.y * diagonal * sqrt(max(1 - height * height, 0));
#else
  error = biases.y * diagonal * q_z * sqrt(max(1 - height * height / squared, 0));
#endif
  scale = facing;
#elif BIAS == 3
  scale = facing;
#if ADAPTS
  error = biases.w * facing * min(squared / (height * height), 100);
#else
  error = biases.w + texel_width * 0.0078125;
#if PROJECTION != 0
  error += fourth * q_z * q_z;
#endif
#endif
  vec2 step_height = across_image(normal);
#elif BIAS == 4
#if PROJECTION == 0
  bias += biases.w;
#else
  bias += biases.w * before * inversesqrt(squared);
#endif
#if SLOPE_FORM == 1
  // What depth changes by from texel to texel, times the facing.
  vec2 steps = abs(across_image(normal));
#ifdef WARPED
  steps *= light_stretch;
#endif
#if PROJECTION == 0
  scale = height;
  error = biases.y * max(steps.x, steps.y);
#else
  scale = height / before;
  error = biases.y * max(steps.x, steps.y) * before;
#endif
#elif SLOPE_FORM == 2
  bias += biases.y * texel_width * min(sqrt(max(1 - cosine * cosine, 0)) / cosine, 1);
#endif
#endif
  float depth = q_z * scale - error;

#if BIAS == 3
  return ComparedPoint(faces, position, scale, depth, bias, step_height);
#else
  return ComparedPoint(faces, position, scale, depth, bias);
#endif
}
)";

}  // namespace gnomon
