#include "gathering.h"

#include <gnomon/kit/area/area_rays.h>
#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/random.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "form_factor.h"

namespace gnomon::radiosity {

namespace {

constexpr double full_sampling = 0.01;  ///< form factor from which on a sender gets all its rays
/// Where a sender is nearer than twice its own size, a few of the rays to it outweigh all others, by the inverse square of
/// their length, and their mean is ruled by chance.
constexpr double near = 2;
/// Numbers in 0 .. 1 of a receiver, begun anew for each of millions: cheaper to begin than Random.
class Mixed {
 public:
  Mixed(std::uint64_t seed, std::uint64_t index) : counter_(seed * mixed_step + index * 0xd1342543de82ef95u) {}
  double next() {
    const std::uint64_t word = mixed(counter_);
    counter_ += mixed_step;
    return static_cast<double>(word >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t counter_;
};

/// Rays on their way into packets of sixteen, and what they were for.
class Packets {
 public:
  Packets(const RayScene& hiding, std::span<double> arrived) : hiding_(hiding), arrived_(arrived) {}

  void add(const glm::vec3& origin, const glm::vec3& way, const Receiving& from, std::size_t point, double weight) {
    set_ray(packet_, static_cast<int>(count_), origin, way, 1);
    mesh_[count_] = from.mesh;
    triangle_[count_] = from.triangle;
    point_[count_] = point;
    weight_[count_] = weight;
    if (++count_ == 16) trace();
  }
  void trace() {
    if (count_ == 0) return;
    const std::uint32_t blocked = hiding_.occluded((1u << count_) - 1, packet_, {mesh_.data(), triangle_.data()});
    for (std::uint32_t k = 0; k < count_; ++k)
      if (!(blocked >> k & 1)) arrived_[point_[k]] += weight_[k];
    rays_ += count_;
    count_ = 0;
  }
  std::size_t rays() const { return rays_; }

 private:
  const RayScene& hiding_;
  std::span<double> arrived_;  // weights, by point
  ShadowPacket packet_;
  std::array<std::uint32_t, 16> mesh_, triangle_;
  std::array<std::size_t, 16> point_;
  std::array<double, 16> weight_;
  std::uint32_t count_ = 0;
  std::size_t rays_ = 0;
};

}  // namespace

std::size_t Gathering::factors(const Sender& sender, bool ends_at_lamp, std::span<const Receiving> points, std::uint64_t seed,
                               std::span<Factor> result) const {
  std::vector<double> arrived(points.size()), sent(points.size());
  Packets packets(hiding_, arrived);
  const glm::dvec3 center = sender.center();
  // Nodes may lie on the border between two triangles of a plane, and near the origin, where their own coordinates would lift
  // rays by nothing: then the other triangle hides all.
  double largest = 0;
  for (const glm::dvec3& corner : sender.polygon()) largest = std::max(largest, extent(corner));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Receiving& at = points[i];
    result[i] = {};
    if (glm::dot(sender.normal, at.point - center) <= 0) continue;
    const double whole = factor_at(at.point, at.normal, sender.polygon());
    if (!(whole > 0)) continue;
    const double wanted = samples_ * at.ray_share * std::min(whole / full_sampling, 1.0);
    const bool is_by_rays = way_ == Way::rays && glm::length(at.point - center) > near * std::sqrt(sender.area);
    const int rays = std::max(static_cast<int>(std::ceil(wanted)), 1);
    const int columns = static_cast<int>(std::sqrt(rays)), rows = rays / columns;
    const glm::vec3 coordinates(static_cast<float>(std::max(largest, extent(at.point))));
    const glm::vec3 lift(at.normal * area_ray_offset(coordinates));
    const glm::vec3 origin = glm::vec3(at.point) + lift;
    // Rays to surfaces end a little before them, so that they do not meet what they go to.
    const glm::dvec3 before = ends_at_lamp ? glm::dvec3(0) : ray_offset(coordinates) * sender.normal;
    Mixed random(seed, at.number);
    for (int k = 0; k < columns * rows; ++k) {
      const double x = (k % columns + random.next()) / columns, y = (k / columns + random.next()) / rows;
      const Sender::Spot spot = sender.at({x, y});
      const glm::dvec3 to = spot.point - at.point;
      const double square = glm::dot(to, to), rise = glm::dot(at.normal, to), front = -glm::dot(sender.normal, to);
      if (rise <= 0 || front <= 0) continue;
      const double weight = spot.weight * rise * front / (square * square);
      sent[i] += weight;
      packets.add(origin, glm::vec3(to + before) - lift, at, i, weight);
    }
    result[i].whole = static_cast<float>(is_by_rays ? sent[i] * sender.area / (std::numbers::pi * columns * rows) : whole);
  }
  packets.trace();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (sent[i] > 0)
      result[i].seen = static_cast<float>(result[i].whole * (arrived[i] / sent[i]));
    else
      result[i].whole = 0;  // none of its rays goes to what is above the horizon: so little counts neither way
  }
  return packets.rays();
}

double escaped_share(const RayScene& surfaces, const Sender& sender, bool is_lamp, int packets, std::uint64_t seed) {
  Random random(seed, 17);
  std::array<std::uint32_t, 16> mesh, triangle{};
  mesh.fill(no_mesh);
  double largest = 0;
  for (const glm::dvec3& corner : sender.polygon()) largest = std::max(largest, extent(corner));
  const double lift = ray_offset(glm::vec3(static_cast<float>(largest)));
  int met = 0;
  for (int packet_index = 0; packet_index < packets; ++packet_index) {
    ShadowPacket packet;
    for (std::uint32_t k = 0; k < 16; ++k) {
      const double x = (k % 4 + random.uniform(0, 1)) / 4, y = (k / 4 + random.uniform(0, 1)) / 4;
      const double s = random.uniform(0, 1), t = random.uniform(0, 1);
      const glm::vec3 way(cosine_direction(sender.normal, x, y));
      const glm::dvec3 from = sender.at({s, t}).point;
      set_ray(packet, static_cast<int>(k), glm::vec3(from + (is_lamp ? 0 : lift) * sender.normal), way, INFINITY);
    }
    met += std::popcount(surfaces.occluded(0xffffu, packet, {mesh.data(), triangle.data()}));
  }
  return 1 - met / (16.0 * packets);
}

}  // namespace gnomon::radiosity
