#pragma once
#include <gnomon/kit/area/area_rays.h>

#include <atomic>
#include <optional>
#include <string>

namespace gnomon {

/// What light meets in a scene, under one truth.
struct LightSurfaces {
  const Scene& scene;
  const RayScene& all;      ///< what light that goes on from a surface meets: the first of all meshes
  const RayScene& casters;  ///< what keeps light of a lamp from a point
};

struct PathOptions {
  int samples = 64;  ///< light paths of a pixel, 16 or more
  /// How often light is sent on by a surface before it comes to the one that is seen; 0: light of the lamp alone. Nothing: as
  /// often as it may be, by chance (see trace_paths).
  std::optional<int> bounces = {};
  std::uint64_t seed = 1;  ///< below 2^31
};

/// The light of a scene, pixel by pixel, estimated. Background is 0, its visibility 1.
struct PathPicture {
  std::vector<float> radiance;  ///< toward the eye, RGB, W/(m2 sr)
  std::vector<float> error;     ///< standard error of each of these numbers
  /// The share of the light's irradiance that no caster keeps off; 1 where nothing of it is seen.
  std::vector<float> visibility;
  std::size_t rays = 0;
};

/// No light path has more surfaces than this beside the one that is seen. With a reflectance of 0.99 throughout, 1 in 23 000
/// of the light that goes so far is missed.
inline constexpr int most_bounces = 1000;

/// Why all bounces in a scene would add up without end: "mesh M has an albedo of 1.2, ...". Nothing where they do not.
std::optional<std::string> endless_bounces(const Scene& scene);
/// Why all light of a scene cannot be traced: for its endless bounces, or for casters with transmission, which no light path
/// goes through. Nothing where it can.
std::optional<std::string> untraceable_light(const Scene& scene);

/// All light that a lamp with area sends to the eye by way of surfaces that reflect diffusely, on both of their sides, with
/// the albedo of their mesh (rendering equation, Kajiya 1986): the lamp has the radiance `intensity`, is no surface, and the
/// background sends nothing.
///
/// A path starts at the pixel's point. At each of its points a shadow ray goes to a place of the lamp (FaceRays), then a ray
/// whose directions are as dense as their cosines to the next surface. Without a number of bounces paths end by chance
/// (Russian roulette, Arvo and Kirk 1990): from the third surface on each goes on with the probability of its surface's
/// strongest albedo, and counts the more. Paths of a pixel are eight independent estimates, each by a sequence of Sobol of its
/// own for the first shadow ray and the first way; what these differ by gives the standard error, of seven degrees of freedom.
///
/// All threads; same arguments, same answer. `done` counts pixels as they are finished. Throws Error on casters with
/// transmission.
PathPicture trace_paths(const LightSurfaces& surfaces, const GBuffer& gbuffer, const Light& light, const PathOptions& options,
                        std::atomic<std::size_t>* done = nullptr);

/// Seeds of a pixel's sequences: of the first shadow rays, and of the first ways.
inline std::uint64_t path_seed(const PathOptions& options, std::size_t pixel, bool is_way) {
  return (options.seed << 33) + 2 * pixel + (is_way ? 1 : 0);
}
/// Lanes of a round that are paths: all sixteen but in the last one.
inline std::uint32_t path_lanes(const PathOptions& options, int round) {
  const int left = options.samples - 16 * round;
  return left >= 16 ? 0xffffu : (1u << left) - 1;
}

/// The first shadow rays of a pixel's paths, sixteen at a time, as trace_paths traces them: `use(figure, squares, hits)`.
/// Nothing of background, nor where the lamp is not seen.
template <class Use>
void ask_first(const RayScene& casters, const GBuffer& gbuffer, std::size_t pixel, const Light& light,
               const PathOptions& options, const Use& use) {
  if (gbuffer.is_background(pixel)) return;
  const LightFigure figure(light, gbuffer.position(pixel), gbuffer.normal(pixel));
  if (!figure.is_seen()) return;
  const FaceRays rays(casters, gbuffer, pixel, figure);
  const Scramble scramble(path_seed(options, pixel, false));
  for (int round = 0; 16 * round < options.samples; ++round) {
    const Squares squares = scramble.of_each(static_cast<std::uint32_t>(round));
    use(figure, squares, rays.ask(squares, path_lanes(options, round)));
  }
}

}  // namespace gnomon
