#include "measure/frame/moved_rays.h"

#include <gnomon/kit/geometry/exact.h>
#include <gnomon/kit/geometry/holes.h>

#include <algorithm>
#include <bit>

#include "measure/frame/classify.h"
#include "measure/frame/light_rays.h"
#include "measure/frame/ray_packets.h"

namespace gnomon {

struct MovedRays::Pixels {
  std::span<const std::size_t> indices;
  std::uint32_t all = 0, lit = 0;
  std::uint32_t mesh[16] = {}, triangle[16] = {};
  std::array<glm::dvec3, 2> tangents[16], beside[16];  ///< across the normal, and across the way to the light

  Receivers receivers() const { return {mesh, triangle}; }
  std::uint32_t dark() const { return all & ~lit; }
  /// Lanes that no pixel has repeat the last one.
  std::size_t operator[](int k) const { return indices[std::min<std::size_t>(k, indices.size() - 1)]; }
};

namespace {

/// In rho: how far along the way a caster is met rho beside it, down to one that the way grazes by 1/32.
constexpr double beside_reach = 32;

/// The lanes for which decide(k) says so.
template <class Decide>
std::uint32_t those_of(std::uint32_t lanes, const Decide& decide) {
  std::uint32_t result = 0;
  for (; lanes; lanes &= lanes - 1)
    if (const int k = std::countr_zero(lanes); decide(k)) result |= 1u << k;
  return result;
}

std::vector<RayScene::Met> casters_near(const Scene& scene, Truth truth, const glm::dvec3& point, double reach) {
  std::vector<RayScene::Met> near;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (!mesh.casts || mesh.transmission || (truth == Truth::shape && mesh.has_curved_shape())) continue;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      Bounds box;
      box.add(mesh.corners(t).points);
      if (glm::all(glm::lessThanEqual(glm::dvec3(box.min) - reach, point)) &&
          glm::all(glm::lessThanEqual(point, glm::dvec3(box.max) + reach)))
        near.push_back({m, t});
    }
  }
  return near;
}

}  // namespace

MovedRays::MovedRays(const Scene& scene, const RayScene& casters, const GBuffer& gbuffer, const glm::dvec4& light,
                     double extent, std::span<const float> reference)
    : scene_(scene), casters_(casters), gbuffer_(gbuffer), light_(light), extent_(extent), reference_(reference) {
  if (light.w != 0) at_light_ = casters_near(scene, gbuffer.truth, glm::dvec3(light), rho());
}

std::uint32_t MovedRays::unstable(std::span<const std::size_t> indices) const {
  Pixels pixels;
  pixels.indices = indices;
  for (std::size_t k = 0; k < indices.size(); ++k) {
    pixels.all |= 1u << k;
    pixels.lit |= static_cast<std::uint32_t>(is_lit(reference_[indices[k]])) << k;
    pixels.mesh[k] = gbuffer_.mesh[indices[k]];
    pixels.triangle[k] = gbuffer_.triangle[indices[k]];
    pixels.tangents[k] = across(glm::normalize(glm::dvec3(gbuffer_.normal(indices[k]))));
    pixels.beside[k] = across(toward(indices[k]));
  }
  std::uint32_t changed = 0;
  // The point moves along its two tangents, the light across the ray, both ways.
  for (int shift = 0; shift < 8 && changed != pixels.all; ++shift) {
    ShadowPacket packet;
    for (int k = 0; k < 16; ++k) aim(packet, k, pixels, shift);
    changed |= casters_.occluded(pixels.all, packet, pixels.receivers()) ^ pixels.dark();
  }
  if (changed != pixels.all) changed |= unstable_from_the_point(pixels);
  const std::uint32_t touches = touching(pixels);
  changed |= those_of(~changed & touches & pixels.dark(), [&](int k) { return is_in_plane_at_start(indices[k]); });
  const std::uint32_t beside = touching_beside(pixels, ~changed & pixels.lit);
  changed |= those_of(~changed & pixels.lit,
                      [&](int k) { return is_shaded_at_an_end(indices[k], touches >> k & 1, beside >> k & 1); });
  if (casters_.has_alpha_masks())
    changed |= those_of(~changed & pixels.all, [&](int k) { return is_at_hole_border(indices[k]); });
  return changed;
}

glm::dvec3 MovedRays::aim(ShadowPacket& packet, int k, const Pixels& pixels, int shift) const {
  const std::size_t i = pixels[k], lane = std::min<std::size_t>(k, pixels.indices.size() - 1);
  const glm::dvec3 p = gbuffer_.position(i), n = gbuffer_.normal(i);
  // An exact shape has no neighbors, and a point rounded into it would only see it from inside.
  glm::dvec3 origin = shift >= 8 && !is_on_shape(i) ? p : p + ray_offset(gbuffer_.position(i)) * n;
  glm::dvec3 light(light_);
  const double rho = this->rho(), sign = shift & 1 ? 1 : -1;
  if (shift < 4) {
    origin += sign * rho * pixels.tangents[lane][shift / 2];
  } else if (shift < 8) {
    // A directional light turns by rho / extent radians.
    const double step = light_.w != 0 ? rho : rho / extent_ * glm::length(light);
    light += sign * step * pixels.beside[lane][shift / 2 - 2];
  }
  const glm::dvec3 direction = light_.w != 0 ? light - origin : light;
  set_ray(packet, k, origin, direction, end_of(light_));
  return direction;
}

/// The ray starts at the point without the lift of the recipe, because rounding may have put it below a neighbor of its own
/// triangle. A lit point must be lit so, also up to rho behind a light at a place, and its way pass the outline by rho / 2. A
/// dark one must be dark where the ray starts rho later and ends rho before the light, clearly or by exact signs.
std::uint32_t MovedRays::unstable_from_the_point(const Pixels& pixels) const {
  ShadowPacket inner;  // without the first and the last rho
  std::uint32_t changed = 0;
  for (int k = 0; k < 16; ++k) {
    const double share = rho() / glm::length(aim(inner, k, pixels, 8));
    inner.tnear[k] = static_cast<float>(share);
    changed |= static_cast<std::uint32_t>(light_.w != 0 && share >= 1) << k & pixels.all;  // the light is no farther than rho
    if (light_.w != 0) inner.tfar[k] = static_cast<float>(std::max(1 - share, 0.0));
  }
  ShadowPacket packet = inner;
  for (int k = 0; k < 16; ++k) {
    if (!(pixels.lit >> k & 1)) continue;
    packet.tnear[k] = 0;
    if (light_.w != 0) packet.tfar[k] = static_cast<float>(1.0 + inner.tnear[k]);
  }
  const RayScene::Blocked blocked = casters_.blocked(pixels.all, packet, pixels.receivers(), rho());
  changed |= blocked.at_all ^ pixels.dark();
  changed |= those_of(pixels.dark() & ~changed & ~blocked.clearly, [&](int k) { return !is_shaded_on_the_way(pixels[k]); });
  return changed | outline_.met(pixels.lit & ~changed, inner);
}

/// Short rays through the points of pixels, `aside` in rho along the two directions across the way, `reach` rho both ways.
ShadowPacket MovedRays::short_rays(const Pixels& pixels, const glm::dvec2& aside, double reach) const {
  ShadowPacket packet;
  for (int k = 0; k < 16; ++k) {
    const auto& [u, v] = pixels.beside[std::min<std::size_t>(k, pixels.indices.size() - 1)];
    const glm::dvec3 way = reach * rho() * toward(pixels[k]);
    set_ray(packet, k, glm::dvec3(gbuffer_.position(pixels[k])) + rho() * (aside.x * u + aside.y * v) - way, 2.0 * way, 1);
  }
  return packet;
}

/// Bit k: a caster is met within rho of the point of pixel k.
std::uint32_t MovedRays::touching(const Pixels& pixels) const {
  const std::uint32_t valid = those_of(pixels.all, [&](int k) { return !is_on_shape(pixels[k]); });
  ShadowPacket packet = short_rays(pixels, {0, 0}, 1);
  return valid ? casters_.occluded(valid, packet, pixels.receivers()) : 0;
}

/// Bit k of `lanes`: a caster, or a hole of one, is met beside the point of pixel k.
std::uint32_t MovedRays::touching_beside(const Pixels& pixels, std::uint32_t lanes) const {
  std::uint32_t valid = those_of(lanes, [&](int k) { return !is_on_shape(pixels[k]); }), touches = 0;
  for (const glm::dvec2& aside : {glm::dvec2(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
    if (!valid) break;
    ShadowPacket packet = short_rays(pixels, aside, beside_reach);
    touches |= casters_.met(valid, packet, pixels.receivers());
    valid &= ~touches;
  }
  return touches;
}

/// Whether a caster within rho of a dark point, closer than float32 resolves, holds the point in its plane, and so shades it
/// never.
bool MovedRays::is_in_plane_at_start(std::size_t i) const {
  const Receiver receiver = receiver_at(scene_, gbuffer_, i);
  const glm::dvec3 reach = rho() * toward(i);
  return std::ranges::any_of(casters_.met(glm::dvec3(receiver.point) - reach, 2.0 * reach), [&](const RayScene::Met& met) {
    const Triangle caster = scene_.meshes[met.mesh].corners(met.triangle);
    const glm::vec3* p = caster.points;
    return !receiver.is_own(met.mesh, met.triangle) && coplanar(p[0], p[1], p[2], receiver.point) &&
           !receiver.is_coplanar(scene_, p);
  });
}

/// Whether a caster that the ray meets shades the point.
bool MovedRays::is_shaded_on_the_way(std::size_t i) const {
  const glm::dvec3 point = gbuffer_.position(i);
  const double beyond_everything = 4 * extent_;
  return is_shaded_by_any(i, casters_.met(point, light_.w != 0 ? to_light(light_, point) : beyond_everything * toward(i)));
}

/// Whether a caster at the point or the light, closer than float32 resolves, shades a lit point. The ray may slip through at
/// the edge of a caster that holds the point, and where the point is at the border of its own triangle, which does not count,
/// between that and its neighbors.
bool MovedRays::is_shaded_at_an_end(std::size_t i, bool is_touching, bool is_touching_beside) const {
  if (is_shaded_by_any(i, at_light_)) return true;
  const glm::dvec3 point = gbuffer_.position(i);
  const auto is_shaded_beside = [&](const glm::dvec3& aside, double reach) {
    const glm::dvec3 way = reach * toward(i);
    return is_shaded_by_any(i, casters_.met(point + aside - way, 2.0 * way));
  };
  if (is_touching && is_shaded_beside(glm::dvec3(0), rho())) return true;
  if (!is_touching_beside && !is_at_own_border(i)) return false;
  const auto [u, v] = across(toward(i));
  for (const glm::dvec3& aside : {u, v, -u, -v, u + v, u - v, v - u, -u - v})
    if (is_shaded_beside(rho() * aside, beside_reach * rho())) return true;
  return false;
}

/// Whether the point is within rho of an edge of its own triangle.
bool MovedRays::is_at_own_border(std::size_t i) const {
  if (is_on_shape(i)) return false;
  const Triangle own = scene_.meshes[gbuffer_.mesh[i]].corners(gbuffer_.triangle[i]);
  const glm::dvec3 point = gbuffer_.position(i);
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 a = own.points[k], edge = glm::dvec3(own.points[(k + 1) % 3]) - a, twice = glm::cross(edge, point - a);
    if (glm::dot(twice, twice) < rho() * rho() * glm::dot(edge, edge)) return true;
  }
  return false;
}

/// Whether one of these casters shades the point, by exact signs.
bool MovedRays::is_shaded_by_any(std::size_t i, std::span<const RayScene::Met> casters) const {
  if (casters.empty()) return false;
  const Receiver receiver = receiver_at(scene_, gbuffer_, i);
  return std::ranges::any_of(casters, [&](const RayScene::Met& met) {
    const Triangle caster = scene_.meshes[met.mesh].corners(met.triangle);
    const Segment segment{receiver.point, light_};
    return !receiver.is_own(met.mesh, met.triangle) && crosses(segment, caster) != Crossing::none &&
           !receiver.is_coplanar(scene_, caster.points) && is_solid_at(scene_.meshes[met.mesh], met.triangle, segment);
  });
}

/// Whether the way of pixel i meets an alpha mask where rounding may take a hole for solid or the other way round, and nothing
/// that is solid beyond doubt decides it.
bool MovedRays::is_at_hole_border(std::size_t i) const {
  const Receiver receiver = receiver_at(scene_, gbuffer_, i);
  const glm::dvec3 point = receiver.point, way = to_light(light_, point);
  bool is_doubtful = false;
  for (const RayScene::Met& met : casters_.met(point, light_.w != 0 ? way : 4 * extent_ * glm::normalize(way))) {
    const Mesh& mesh = scene_.meshes[met.mesh];
    const Triangle caster = mesh.corners(met.triangle);
    if (receiver.is_own(met.mesh, met.triangle) || receiver.is_coplanar(scene_, caster.points)) continue;
    const Around found = mesh.alpha_mask ? around(*mesh.alpha_mask, texel_place(mesh, met.triangle, point, light_),
                                                  texel_rounding(mesh, met.triangle, way, extent_))
                                         : Around::solid;
    is_doubtful |= found == Around::both;
    if (found == Around::solid && is_clearly_inside(caster, point, way)) return false;
  }
  return is_doubtful;
}

/// Whether a way meets a triangle with all its edges, and both ends of the way, farther than rho.
bool MovedRays::is_clearly_inside(const Triangle& triangle, const glm::dvec3& point, const glm::dvec3& way) const {
  double turn[3];
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 from = glm::dvec3(triangle.points[k]) - point, to = glm::dvec3(triangle.points[(k + 1) % 3]) - point;
    turn[k] = glm::dot(glm::cross(from, to), way);
    if (!(std::abs(turn[k]) > rho() * glm::length(glm::cross(to - from, way)))) return false;
  }
  if ((turn[0] > 0) != (turn[1] > 0) || (turn[0] > 0) != (turn[2] > 0)) return false;
  const glm::dvec3 normal = triangle.normal(), first = glm::dvec3(triangle.points[0]) - point;
  const double t = glm::dot(normal, first) / glm::dot(normal, way), room = rho() / glm::length(way);
  return t > 4 * room && (light_.w == 0 || t < 1 - room);
}

}  // namespace gnomon
