#include "measure/frame/soft_reference.h"

#include <gnomon/kit/parallel.h>

#include <bit>

#include "measure/frame/light_rays.h"

namespace gnomon {

namespace {

/// The rays of one pixel.
class SoftPixel {
 public:
  SoftPixel(const Scene& scene, const RayScene& casters, const GBuffer& gbuffer, const Light& light, std::size_t index)
      : scene_(scene), casters_(casters), gbuffer_(gbuffer), light_(light), index_(index) {}

  const LightFigure& figure() const { return figure_; }
  SampledShares shares(const AreaTarget& target) const { return sample_shares(rays(figure_, {}, true), index_, target); }

  /// Mean over those of sixteen ways to the light that a caster keeps light off; 0 where none does.
  double caster_distance() const {
    const Squares squares = Scramble(~std::uint64_t{index_}).of_each(0);
    const LightFigure::Box& box = figure_.box();
    double sum = 0;
    int count = 0;
    for (std::size_t k = 0; k < squares.x.size(); ++k) {
      const glm::dvec2 place = box.low + glm::dvec2(squares.x[k], squares.y[k]) * (box.high - box.low);
      if (!figure_.holds(place)) continue;
      const glm::dvec3 way = figure_.at(place);
      const std::optional<double> t = first_caster(way);
      if (!t) continue;
      sum += *t * glm::length(way);
      ++count;
    }
    return count > 0 ? sum / count : 0;
  }

  /// Whether a share changes by more than `most` when point or light move by rho. One ray of sixteen that changes calls for
  /// 512.
  bool moves(double rho, double most) const {
    Rest rest(rays(figure_, {}, true), index_);
    for (int shift = 0; shift < shift_count; ++shift) {
      const FaceRays moved = moved_rays(rho, shift);
      if (change(rest, moved, 1) > most && change(rest, moved, Rest::most_rounds) > most) return true;
    }
    return false;
  }

 private:
  static constexpr int shift_count = 11;

  /// What rays find where nothing has moved, sixteen at a time, each traced once.
  class Rest {
   public:
    static constexpr int most_rounds = 32;
    struct Round {
      Squares squares;
      FaceHits hits;
    };
    Rest(const FaceRays& rays, std::uint64_t seed) : rays_(rays), scramble_(~seed) {}
    const Round& find(int round) {
      for (; known_ <= round; ++known_) {
        rounds_[known_].squares = scramble_.of_each(static_cast<std::uint32_t>(known_));
        rounds_[known_].hits = rays_.ask(rounds_[known_].squares);
      }
      return rounds_[round];
    }

   private:
    FaceRays rays_;
    Scramble scramble_;
    std::array<Round, most_rounds> rounds_;
    int known_ = 0;
  };

  /// Where the first caster on a way to the light is that keeps light off, in lengths of the way; nothing where none does.
  std::optional<double> first_caster(const glm::dvec3& way) const {
    const glm::dvec3 origin = point_ + static_cast<float>(area_ray_offset(point_)) * normal_;
    const double t = casters_.closest_caster(origin, way).t;
    return t < 1 ? std::optional(t) : std::nullopt;
  }

  FaceRays rays(const LightFigure& figure, const glm::vec3& moved, bool is_lifted) const {
    const glm::vec3 lift = is_lifted || is_on_shape_ ? static_cast<float>(area_ray_offset(point_)) * normal_ : glm::vec3(0);
    return {casters_, point_ + moved + lift, lift, mesh_, gbuffer_.triangle[index_], figure};
  }

  /// The point moves along its two tangents, the light across the way to its center and along it, each both ways; then rays
  /// start at the point without the lift of the recipe.
  FaceRays moved_rays(double rho, int shift) const {
    if (shift == shift_count - 1) return rays(figure_, {}, false);
    const double step = shift & 1 ? rho : -rho;
    const glm::dvec3 point(point_), to_center = glm::normalize(glm::dvec3(homogeneous_of_center(light_)) - point);
    const glm::dvec3 axis = shift < 4 ? glm::dvec3(normal_) : to_center;
    const glm::dvec3 way = step * (shift < 8 ? across(axis)[shift / 2 % 2] : axis);
    // A light that moves one way is a point that moves the other way, below casters that come along.
    if (shift < 4) return rays(LightFigure(light_, point + way, normal_), glm::vec3(way), true);
    return rays(LightFigure(light_, point - way, normal_), {}, true);
  }

  /// The larger change of the two shares, from the same places.
  static double change(Rest& rest, const FaceRays& to, int rounds) {
    double traced = 0, weight = 0, more_seen = 0, more_weight = 0;
    for (int k = 0; k < rounds; ++k) {
      const Rest::Round& round = rest.find(k);
      const FaceHits &a = round.hits, b = to.ask(round.squares);
      traced += std::popcount(a.asked);
      for (std::uint32_t left = a.asked; left; left &= left - 1) weight += a.weight[std::countr_zero(left)];
      for (std::uint32_t left = (a.blocked ^ b.blocked) | a.dimmed | b.dimmed; left; left &= left - 1) {
        const int k = std::countr_zero(left);
        const double more = b.seen(k) - a.seen(k);
        more_seen += more;
        more_weight += more * a.weight[k];
      }
    }
    return traced > 0 ? std::max(std::abs(more_seen) / traced, std::abs(more_weight) / weight) : 0;
  }

  const Scene& scene_;
  const RayScene& casters_;
  const GBuffer& gbuffer_;
  const Light& light_;
  const std::size_t index_;  ///< also the seed
  const glm::vec3 point_ = gbuffer_.position(index_), normal_ = gbuffer_.normal(index_);
  const std::uint32_t mesh_ = gbuffer_.mesh[index_];
  const bool is_on_shape_ = gbuffer_.truth == Truth::shape && scene_.meshes[mesh_].has_curved_shape();
  const LightFigure figure_{light_, point_, normal_};
};

}  // namespace

SoftReference trace_soft(const Scene& scene, const RayScene& casters, const GBuffer& gbuffer, const Light& light,
                         std::span<const std::uint8_t> silhouettes, const AreaTarget& target, std::atomic<std::size_t>* done) {
  const std::size_t size = gbuffer.size();
  SoftReference result;
  for (auto* shares : {&result.area, &result.irradiance, &result.area_half, &result.irradiance_half}) shares->assign(size, 1);
  for (auto* floats : {&result.area_error, &result.irradiance_error, &result.caster_distance}) floats->assign(size, 0);
  result.rays.assign(size, 0);
  result.classes.assign(size, PixelClass::B);
  const bool has_room = is_resolved(scene, light, gbuffer.view);
  const double rho = 16 * 0x1p-24 * extent(scene, light, gbuffer.view), grazing = 0.035;
  const auto decide = [&](std::size_t i) {
    PixelClass& of = result.classes[i];
    if (gbuffer.is_background(i)) return;
    of = PixelClass::F;
    if (!scene.meshes[gbuffer.mesh[i]].receives) return;
    const SoftPixel pixel(scene, casters, gbuffer, light, i);
    if (!pixel.figure().is_seen()) return;
    const SampledShares shares = pixel.shares(target);
    result.area[i] = static_cast<float>(shares.area);
    result.irradiance[i] = static_cast<float>(shares.irradiance);
    result.area_half[i] = static_cast<float>(shares.area_half);
    result.irradiance_half[i] = static_cast<float>(shares.irradiance_half);
    result.area_error[i] = static_cast<float>(shares.area_error);
    result.irradiance_error[i] = static_cast<float>(shares.irradiance_error);
    result.rays[i] = shares.rays;
    if (shares.area > 0 && shares.area < 1) result.caster_distance[i] = static_cast<float>(pixel.caster_distance());
    of = PixelClass::G;
    if (pixel.figure().highest() < grazing) return;
    of = PixelClass::S;
    if (!silhouettes.empty() && silhouettes[i]) return;
    const bool has_error = std::max(shares.area_error, shares.irradiance_error) > target.error;
    of = !has_room || has_error || pixel.moves(rho, 4 * target.error) ? PixelClass::U : PixelClass::T;
  };
  for_blocks(size, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) decide(i);
    if (done) *done += end - begin;
  });
  return result;
}

}  // namespace gnomon
