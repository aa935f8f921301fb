#pragma once
#include <gnomon/kit/area/area_rays.h>
#include <gnomon/kit/denoise/ray_places.h>
#include <gnomon/kit/unset_vector.h>

#include <optional>

namespace gnomon::denoised_rays {

/// What the rays of one frame found: a number for each pixel, row-major, 0 where it does not face the light.
struct RayPlanes {
  UnsetVector<float> asked;         ///< irradiance of the places that were asked, in a unit of the pixel's own
  UnsetVector<float> seen;          ///< the part of it that arrives
  UnsetVector<float> distance;      ///< meters to what stops or dims rays, summed over such rays; empty unless wanted
  UnsetVector<float> dark;          ///< how many they are; empty unless wanted
  UnsetVector<std::uint8_t> faces;  ///< 1 where the pixel faces the light (see faces_light)
  std::size_t ray_count = 0;        ///< of the whole picture, those for distances included

  std::size_t bytes() const;
};

/// The rays of one frame: 1 to 4 from each pixel that faces the light, to places that depend on pixel and frame alone.
class FrameRays {
 public:
  FrameRays(const RayScene& casters, const GBuffer& gbuffer, const Light& light, const RayPlaces& places, std::uint32_t frame)
      : casters_(casters), gbuffer_(gbuffer), shape_(light), places_(places), frame_(frame) {}

  /// The figure of the light from a pixel that faces it; else nothing.
  std::optional<LightFigure> figure(std::size_t pixel) const;
  /// The places of a pixel's rays, as places of the figure's box; those from the number of rays on have no meaning.
  Squares squares(const LightFigure& figure, std::size_t pixel) const;
  std::uint32_t wanted() const { return (1u << places_.ray_count()) - 1; }
  /// Traces all of them, on all threads. With `wants_distances` every ray that something stops or dims is traced once more, to
  /// the first thing that does: any hit is not the nearest one.
  void trace(bool wants_distances, RayPlanes& planes) const;

 private:
  /// Sixteen rays with the pixel of each.
  struct Packet {
    GatheredRays rays;
    std::array<std::size_t, ray_lanes> pixel{};
    std::size_t traced = 0;  ///< rays so far
  };
  /// Adds a pixel's rays, and traces the packet whenever it is full.
  void add(std::size_t pixel, Packet& packet, RayPlanes& planes) const;
  void trace_packet(Packet& packet, RayPlanes& planes) const;
  void add_distance(const Packet& packet, int ray, RayPlanes& planes) const;

  const RayScene& casters_;
  const GBuffer& gbuffer_;
  const LightShape shape_;
  const RayPlaces& places_;
  std::uint32_t frame_;
};

}  // namespace gnomon::denoised_rays
