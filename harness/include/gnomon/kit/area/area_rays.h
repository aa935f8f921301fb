#pragma once
#include <gnomon/kit/area/light_figure.h>
#include <gnomon/kit/rays/rays.h>

#include <bit>

namespace gnomon {

/// Independent scrambles of one sequence of places, whose spread is the standard error of what they find together.
inline constexpr int ray_replicas = 8;

/// Sixteen places of the unit square, for sixteen rays at once.
struct Squares {
  alignas(64) std::array<float, 16> x, y;
};

/// What sixteen rays to a light found.
struct FaceHits {
  std::uint32_t asked = 0;                     ///< bit k: place k is on the light and above the horizon
  std::uint32_t blocked = 0;                   ///< of those: nothing of the light passes
  std::uint32_t dimmed = 0;                    ///< of those: a part passes, through transmission
  alignas(64) std::array<float, 16> weight{};  ///< irradiance of each of those places, as LightFigure::weight but for a factor
  alignas(64) std::array<float, 16> passed{};  ///< that part (red of three), of the rays in `dimmed` alone

  /// What part of the light passes along ray k, which is in `asked`.
  double seen(int k) const {
    if (dimmed >> k & 1) return passed[k];
    return blocked >> k & 1 ? 0 : 1;
  }
  /// How many places in `asked` are hidden: one that a part of the light comes from counts as what is missing.
  double hidden_count() const {
    double sum = std::popcount(blocked);
    for (std::uint32_t left = dimmed; left; left &= left - 1) sum += 1.0 - passed[std::countr_zero(left)];
    return sum;
  }
};

/// How far a ray to a light with area starts off its surface: a quarter of what a ray to a point does. The higher a ray starts,
/// the less of the light is hidden by casters beside the point, and that error adds up where many rays are averaged. The error
/// of one ray that meets a neighbor of the surface by rounding does not.
double area_ray_offset(const glm::vec3& point);

/// What sends rays from one point to the places of a figure: where they start, lifted off the point, and the figure from there.
class FaceAim {
 public:
  /// From a pixel of a G-buffer. `figure` is that of the light from its point.
  FaceAim(const GBuffer& gbuffer, std::size_t pixel, const LightFigure& figure);
  /// `origin` is where rays start: lifted off the point that `figure` was made for, by `lift`, in world space.
  FaceAim(const glm::vec3& origin, const glm::vec3& lift, const LightFigure& figure);

  /// center, half_u, half_v, normal and the figure's axis, then the ray's start and its lift: x, y, z each; then the horizon,
  /// the box's corner and size, 1 for a disc, and one over the unit of weights.
  const float* numbers() const { return numbers_.data(); }

 private:
  std::array<float, 30> numbers_;
};

/// Shadow rays from one point to places of a light with area, by the recipe of all shadow rays (docs/method.md) but for the
/// start: the receiver left out, the end at the light. Behind transmission the product of what the triangles let through, each
/// looked up along the ray as it is traced.
class FaceRays {
 public:
  /// From a pixel of a G-buffer. `figure` is that of the light from its point.
  FaceRays(const RayScene& casters, const GBuffer& gbuffer, std::size_t pixel, const LightFigure& figure);
  /// `origin` is where rays start: lifted off the point that `figure` was made for, by `lift`, in world space.
  FaceRays(const RayScene& casters, const glm::vec3& origin, const glm::vec3& lift, std::uint32_t mesh, std::uint32_t triangle,
           const LightFigure& figure);

  /// A square's (x, y) is the place that far along the box of the figure, both ways; where the figure has none there, no ray
  /// is traced. `wanted`: bit k, whether square k counts.
  FaceHits ask(const Squares& squares, std::uint32_t wanted = 0xffffu) const;
  /// The rays that `ask` would trace, for a bare loop beside which it is measured. Bit k: whether ray k is one of them.
  std::uint32_t aim_at(const Squares& squares, ShadowPacket& packet) const;
  /// Whether rays may be dimmed: of a caster that is traced.
  bool has_transmission() const { return has_transmission_; }

 private:
  const RayScene& casters_;
  const bool has_transmission_ = casters_.has_transmission();
  std::array<std::uint32_t, 16> mesh_, triangle_;
  FaceAim aim_;
};

/// The same where each of up to sixteen rays comes from a point of its own: few rays from each of many points, which one packet
/// takes together.
class GatheredRays {
 public:
  explicit GatheredRays(const RayScene& casters) : casters_(casters) {}

  int count() const { return count_; }
  bool is_full() const { return count_ == ray_lanes; }
  /// Adds the ray to a square's place, of a receiver's triangle. Adds none and returns false where the figure has no place
  /// there. Not when it is full.
  bool add(const FaceAim& from, const glm::vec2& square, std::uint32_t mesh, std::uint32_t triangle);
  /// From where and along what ray k goes, 1 at the light.
  glm::dvec3 origin(int k) const { return {packet_.ox[k], packet_.oy[k], packet_.oz[k]}; }
  glm::dvec3 way(int k) const { return {packet_.dx[k], packet_.dy[k], packet_.dz[k]}; }
  /// What the rays found, in the order in which they were added.
  FaceHits trace() const;
  void clear() { count_ = 0; }

 private:
  const RayScene& casters_;
  const bool has_transmission_ = casters_.has_transmission();
  int count_ = 0;
  ShadowPacket packet_;
  std::array<std::uint32_t, ray_lanes> mesh_{}, triangle_{};
  std::array<float, ray_lanes> x_{}, y_{}, weight_{};
};

/// Squares whose places fill a figure, as the unit square fills itself: of a rectangle the places of its whole
/// square, of a disc by the concentric map (Shirley and Chiu 1997). No rays go to those below the horizon. Those from `count`
/// on are 0.
Squares places_on(const LightFigure& figure, const Squares& squares, int count = 16);

/// Places of the unit square in an order that fills it evenly: the first two dimensions of Sobol's sequence (Sobol 1967), a
/// (0, 2) sequence in base 2, with its digits scrambled (Owen 1995). Every place is then
/// equally likely to be anywhere, and the first 2^k are still spread evenly.
class Scramble {
 public:
  /// Eight scrambles that have nothing to do with each other nor with those of other seeds.
  explicit Scramble(std::uint64_t seed);
  /// Places 2 * round and 2 * round + 1 of each of the eight sequences: k and k + 8 are of sequence k.
  Squares of_each(std::uint32_t round) const;
  /// Places 16 * group .. 16 * group + 15 of the first.
  Squares of_first(std::uint32_t group) const;

 private:
  alignas(64) std::array<std::uint32_t, 16> x_, y_, factor_;
};

/// Rounds of each of the eight sequences of a scramble, in packets by where their places lie, not in the order of the sequence:
/// sixteen rays to them go nearly the same way, in penumbrae twice as fast. Square k of a packet is still one of sequence k
/// % 8.
class SortedRounds {
 public:
  static constexpr std::uint32_t most = 32;  ///< rounds at once, from a multiple of this on
  /// Rounds from .. to - 1, of which no other than the first is a multiple of `most`.
  void sort(const Scramble& scramble, std::uint32_t from, std::uint32_t to);
  std::uint32_t packet_count() const { return count_; }
  const Squares& squares(std::uint32_t packet) const { return packets_[packet]; }

 private:
  std::uint32_t count_ = 0;
  std::array<Squares, most> packets_;
};

/// How exact a share of the light must be.
struct AreaTarget {
  double error = 0.002;      ///< standard error of both shares
  std::uint32_t cap = 8192;  ///< rays of a point, a multiple of 16
};

/// How much of a light a point sees, by rays, with the standard error of both numbers.
struct SampledShares {
  double area = 1, irradiance = 1;
  double area_error = 0, irradiance_error = 0;  ///< never below what one ray more or less would make
  /// By half of the replicas alone, moved as far from the shares as the estimate of their error says: in the mean as far as
  /// these are from the truth. Not held to 0 .. 1.
  double area_half = 1, irradiance_half = 1;
  std::uint32_t rays = 0;        ///< that the shares are made of
  std::uint32_t pilot_rays = 0;  ///< that chose their number and are left out
};

/// The shares by eight replicas: as many independent scrambles of one sequence, whose spread is the standard error. A pilot
/// of 64 rays estimates how many are needed; where they turn out too few, more follow up to the cap. Same arguments, same
/// answer.
SampledShares sample_shares(const FaceRays& rays, std::uint64_t seed, const AreaTarget& target);

/// The share of the light's area for every pixel, on all threads; 1 where it does not face the light. Each pixel has its index
/// for seed. Returns the number of rays, pilots included.
std::size_t trace_shares(const RayScene& casters, const Scene& scene, const GBuffer& gbuffer, const Light& light,
                         const AreaTarget& target, std::span<float> visibility);

}  // namespace gnomon
