#pragma once
#include <gnomon/kit/rays/rays.h>

#include <cstdint>
#include <span>

#include "division.h"
#include "lamps.h"

namespace gnomon::radiosity {

/// How the form factor of a point is found: as the mean over rays to the sender (Wallace, Elmquist and Haines 1989), or in
/// closed form times the share of such rays that arrive, weighted alike; the latter always where the sender is near.
enum class Way { rays, contour };

/// A point on one side of a surface that receives light of a sender.
struct Receiving {
  glm::dvec3 point;
  glm::dvec3 normal;  ///< unit, of that side
  std::uint32_t mesh = 0, triangle = 0;
  std::uint64_t number = 0;  ///< chooses its rays
  double ray_share = 1;      ///< of the rays that it would get
};

/// What it gets: form factors from the point to the sender, of the whole and of what is seen of it.
struct Factor {
  float whole = 0, seen = 0;
};

/// Finds form factors by rays through what may hide the sender.
class Gathering {
 public:
  /// `samples`: rays from a point to a sender that fills a hundredth of what it sees or more; to smaller ones fewer, at least
  /// one.
  Gathering(const RayScene& hiding, Way way, int samples) : hiding_(hiding), way_(way), samples_(samples) {}

  /// Of each point; `seed` and its number choose the rays. `ends_at_lamp`: the sender is no surface, so rays go all the way.
  /// Returns the number of rays.
  std::size_t factors(const Sender& sender, bool ends_at_lamp, std::span<const Receiving> points, std::uint64_t seed,
                      std::span<Factor> result) const;

 private:
  const RayScene& hiding_;
  Way way_;
  int samples_;
};

/// What share of the light that a sender sends meets none of the surfaces, by so many packets of sixteen rays, cosine-weighted.
double escaped_share(const RayScene& surfaces, const Sender& sender, bool is_lamp, int packets, std::uint64_t seed);

}  // namespace gnomon::radiosity
