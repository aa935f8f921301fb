#include <gnomon/kit/maps/light_map.h>

namespace gnomon {

namespace {

/// Of a camera, at most.
int image_count(bool is_cube, LightImages images) { return is_cube ? 6 : images == LightImages::slices ? ViewSlices::most : 1; }

}  // namespace

LightProjection projection_of(const LightCamera& camera) {
  if (camera.is_cube()) return LightProjection::cube;
  return camera.space.is_parallel() ? LightProjection::parallel : LightProjection::centered;
}

std::string light_map_head(LightProjection projection, LightImages images) {
  constexpr std::string_view heads[] = {"", "#define SLICED\n", "#define WARPED\n"};
  return fmt::format("#define PROJECTION {}\n{}", static_cast<int>(projection), heads[static_cast<int>(images)]);
}

Support light_map_support(const Light& light, int resolution, int margin, int more_constants, LightImages images) {
  if (has_area(light)) return Support::unsupported("a shadow map has one center: lights with area have none");
  const bool is_cube = looks_through_cube(light);
  if (images != LightImages::faces && is_cube)
    return Support::unsupported(fmt::format("{} of one image: a point light and a spot wider than {} degrees have six",
                                            images == LightImages::slices ? "slices are" : "a warp is", widest_spot_degrees));
  if (4 * margin > resolution)
    return Support::unsupported(
        fmt::format("filter and offset reach {} texels beyond what an image of {} is fitted to: it needs {} or more", margin,
                    resolution, 4 * margin));
  // Of faces a cube has most: the origin, two vectors for each image, spot. Of slices: the origin, two vectors for each, two
  // for the division, the axes, spot. Of a warp: the origin, two vectors for its image, the warp, the axes, spot.
  constexpr int constants[] = {1 + 12 + 1, 1 + 2 * ViewSlices::most + 2 + 3 + 1, 1 + 2 + 1 + 3 + 1};
  const int components = 4 * (constants[static_cast<int>(images)] + more_constants), layers = image_count(is_cube, images);
  return within_limits({.varying_components = components, .texture_size = resolution, .texture_layers = layers});
}

std::string light_map_constants(LightProjection projection, LightImages images) {
  const int count = image_count(projection == LightProjection::cube, images);
  // A cube has no axes of its own, its faces only exchange those of the world. Slices and warps have theirs in meters.
  constexpr std::string_view axes[] = {"mat3 light_axes; mat3 light_steps;",
                                       "mat3 light_axes; vec4 light_depth; vec3 light_ends;",
                                       "mat3 light_axes; vec3 light_warp;"};
  const char* const cone = projection == LightProjection::parallel ? "" : "vec4 spot;";
  return fmt::format("vec3 light_origin; vec4 light_windows[{0}]; vec4 light_images[{0}]; {1} {2}", count,
                     projection == LightProjection::cube ? "" : axes[static_cast<int>(images)], cone);
}

// llvmpipe executes both sides of every branch and gathers what is indexed by a variable: so the face is found by selecting
// among the six.
const std::string_view light_map_snippet = R"(
layout(binding = 3) uniform sampler2DArray light_map;
#if PROJECTION == 2
bool light_is_x, light_is_y, light_is_against;
vec4 light_window, light_facts;
// The face is the major axis; its neighbors in cyclic order span it.
void choose_image(vec3 v) {
  vec3 a = abs(v);
  light_is_x = a.x >= a.y && a.x >= a.z, light_is_y = !light_is_x && a.y >= a.z;
  bool against = light_is_against = (light_is_x ? v.x : light_is_y ? v.y : v.z) < 0;
  light_window = against ? (light_is_x ? light_windows[1] : light_is_y ? light_windows[3] : light_windows[5])
                         : (light_is_x ? light_windows[0] : light_is_y ? light_windows[2] : light_windows[4]);
  light_facts = against ? (light_is_x ? light_images[1] : light_is_y ? light_images[3] : light_images[5])
                        : (light_is_x ? light_images[0] : light_is_y ? light_images[2] : light_images[4]);
}
vec3 in_image(vec3 v) {
  vec3 q = light_is_x ? v.yzx : light_is_y ? v.zxy : v;
  float z = abs(q.z);
  return vec3(q.xy * light_window.xy + z * light_window.zw, z);
}
vec3 along_image(vec3 step) {
  vec3 q = light_is_x ? step.yzx : light_is_y ? step.zxy : step;
  float z = light_is_against ? -q.z : q.z;
  return vec3(q.xy * light_window.xy + z * light_window.zw, z);
}
vec2 across_image(vec3 n) { return (light_is_x ? n.yz : light_is_y ? n.zx : n.xy) / light_window.xy; }
#elif defined(SLICED)
vec4 light_window, light_facts;
// A point is looked up in the slice of a depth that is so much larger.
float light_ahead = 0;
float depth_along_view(vec3 v) { return dot(v, light_depth.xyz) + light_depth.w; }
void choose_image(vec3 v) {
  float depth = depth_along_view(v) + light_ahead;
  bool is_second = depth > light_ends.x, is_third = depth > light_ends.y, is_fourth = depth > light_ends.z;
  light_window = is_third ? (is_fourth ? light_windows[3] : light_windows[2])
                          : (is_second ? light_windows[1] : light_windows[0]);
  light_facts = is_third ? (is_fourth ? light_images[3] : light_images[2]) : (is_second ? light_images[1] : light_images[0]);
}
vec3 in_image(vec3 v) {
  vec3 q = light_axes * v;
#if PROJECTION == 0
  return vec3(q.xy * light_window.xy + light_window.zw, q.z);
#else
  return vec3(q.xy * light_window.xy + q.z * light_window.zw, q.z);
#endif
}
vec2 across_image(vec3 n) { return (light_axes * n).xy / light_window.xy; }
#elif defined(WARPED)
#define light_window light_windows[0]
vec4 light_facts;
vec2 light_stretch;
void choose_image(vec3 v) {}
vec3 in_image(vec3 v) {
  vec3 q = light_axes * v;
#if PROJECTION != 0
  q.xy /= q.z;
#endif
  vec2 from_pivot = q.xy - light_warp.xy;
  float divisor = 1 + light_warp.z * from_pivot.y;
  float aside = divisor * abs(light_warp.z * from_pivot.x) * (light_window.x / light_window.y);
  light_stretch = vec2(divisor + aside, divisor * divisor), light_facts = light_images[0];
  light_facts.y = max(light_stretch.x / light_window.x, light_stretch.y / light_window.y);
  // Behind the center of the warp nothing is seen.
  vec2 texel = divisor > 0 ? from_pivot / divisor * light_window.xy + light_window.zw : vec2(-1e6);
#if PROJECTION != 0
  texel *= q.z;
#endif
  return vec3(texel, q.z);
}
vec2 across_image(vec3 n) { return (light_axes * n).xy / light_window.xy; }
// What texel coordinates are without the warp, but for where they begin.
vec2 unwarped(vec2 texel) {
  vec2 q = texel - light_window.zw;
  return q / (1 - light_warp.z / light_window.y * q.y);
}
vec2 way_in_image(vec2 a, vec2 b) { return unwarped(b) - unwarped(a); }
#else
#define light_window light_windows[0]
#define light_facts light_images[0]
void choose_image(vec3 v) {}
vec3 in_image(vec3 v) {
  vec3 place = light_axes * v;
#if PROJECTION == 0
  place.xy += light_window.zw;
#endif
  return place;
}
vec3 along_image(vec3 step) { return light_axes * step; }
vec2 across_image(vec3 n) { return vec2(dot(n, light_steps[0]), dot(n, light_steps[1])); }
#endif
#ifndef WARPED
vec2 way_in_image(vec2 a, vec2 b) { return b - a; }
#endif
#if PROJECTION == 0
#if defined(SLICED) || defined(WARPED)
float height_over_light(vec3 normal) { return -(light_axes * normal).z; }
#else
float height_over_light(vec3 normal) { return -dot(normal, light_steps[2]); }
#endif
#endif
bool faces_light_at(vec4 position, vec4 normal, vec3 v) {
#if PROJECTION == 0
  float height = height_over_light(normal.xyz), squared = 1;
  const bool is_in_cone = true;
#else
  float height = -dot(normal.xyz, v), squared = dot(v, v), along = dot(v, spot.xyz);
  bool is_in_cone = along >= 0 && along * along >= spot.w * squared;
#endif
  return position.w * normal.w * height > 0 && height * height > squared * 2.2737368e-13 && is_in_cone;
}
float stored_depth(vec2 texel) {
  ivec2 size = textureSize(light_map, 0).xy;
  bool inside = all(lessThan(uvec2(ivec2(texel)), uvec2(size)));
  float depth = inside ? textureLod(light_map, vec3((texel + 0.5) / vec2(size), light_facts.x), 0).r : 0;
#ifdef FORWARD_DEPTH
  depth = inside ? 1 - depth : 0;
#endif
#ifdef WARPED
  depth /= 1 - light_warp.z / light_window.y * (texel.y + 0.5 - light_window.w);
#endif
  return depth;
}
)";

void set_light_camera(const Program& program, const Light& light, const LightCamera& camera,
                      const std::function<double(const LightImage&)>& fourth) {
  set_light(program, light);
  std::array<glm::vec4, 6> windows{}, facts{};
  const bool is_sliced = camera.slices.axis != glm::dvec3(0), is_warped = program.uses("light_warp");
  for (std::size_t i = 0; i < camera.images.size(); ++i) {
    LightImage image = camera.images[i];
    // Where nothing casts, every look-up falls far off the image.
    if (image.layer < 0) image = {image, glm::dvec2(1), glm::dvec2(-1e6), glm::dvec2(0), 0, 0.5, 1};
    windows[i] = glm::vec4(image.scale, image.offset);
    facts[i] = glm::vec4(std::max(image.layer, 0), 1 / std::min(image.scale.x, image.scale.y), image.near,
                         fourth ? fourth(image) : image.far);
    if (camera.is_cube() || i > 0) continue;
    const glm::dvec3 axes[] = {image.axis(0), image.axis(1), image.axis(2)};  // right, down, axis
    if (is_sliced || is_warped) {
      program.set_if_used("light_warp", glm::vec3(image.pivot, image.lean));
      program.set_if_used("light_axes", glm::mat3(glm::transpose(glm::dmat3(axes[0], axes[1], axes[2]))));
      continue;
    }
    const glm::dvec2 along_axis = image.is_perspective ? image.offset : glm::dvec2(0);
    const glm::dmat3 rows(axes[0] * image.scale.x + axes[2] * along_axis.x, axes[1] * image.scale.y + axes[2] * along_axis.y,
                          axes[2]);
    program.set_if_used("light_axes", glm::mat3(glm::transpose(rows)));
    program.set_if_used("light_steps", glm::mat3(axes[0] / image.scale.x, axes[1] / image.scale.y, axes[2]));
  }
  if (is_sliced) {
    const ViewSlices& slices = camera.slices;
    program.set_if_used("light_depth", glm::vec4(slices.axis, glm::dot(slices.axis, camera.images[0].origin - slices.eye)));
    glm::vec3 ends(std::numeric_limits<float>::max());
    for (std::size_t i = 0; i < slices.ends.size(); ++i) ends[static_cast<int>(i)] = static_cast<float>(slices.ends[i]);
    program.set_if_used("light_ends", ends);
  }
  const std::size_t count = is_sliced ? ViewSlices::most : camera.images.size();
  program.set_if_used("light_windows", std::span<const glm::vec4>(windows).first(count));
  program.set_if_used("light_images", std::span<const glm::vec4>(facts).first(count));
  program.set_if_used("light_origin", glm::vec3(camera.images[0].origin));
}

}  // namespace gnomon
