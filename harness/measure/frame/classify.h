#pragma once
#include <gnomon/kit/rays/rays.h>

#include <array>
#include <cmath>

#include "measure/answer_kind.h"

namespace gnomon {

/// First match decides; every class is reported, only T is scored in the headline. Classes depend on scene, light, view and
/// truth alone, never on a technique.
enum class PixelClass : std::uint8_t {
  B,  ///< background
  F,  ///< faces away from the light, outside the spot cone, or on a mesh that does not receive
  G,  ///< grazing: 0 < N.l < 0.035 (2 degrees)
  S,  ///< primary silhouette: what the pixel shows is in doubt, see find_silhouettes
  U,  ///< uncertain: the reference changes when the point or the light moves by rho = 16 * 2^-24 * extent, or when the ray
      ///< starts at the point itself instead of a ray offset above it; the light is no farther than rho; a lit point's way
      ///< passes the outline of casters by less than rho / 2; exact signs contradict it at the point or the light, or confirm
      ///< no hit of a dark one's ray; or the scene is not resolved
  T,  ///< tested
};

/// A color of a table's row, sRGB.
constexpr std::array<std::uint8_t, 3> rgb(std::uint8_t r, std::uint8_t g, std::uint8_t b) { return {r, g, b}; }

/// One class is one row, in the order of PixelClass: what records, tables and pictures call it. The colors differ by 26 in CIE
/// Lab, also for people without one kind of cone.
struct ClassInfo {
  std::string_view letter, word, sentence;  ///< "T", "tested", ...
  std::array<std::uint8_t, 3> color;        ///< sRGB
};
std::span<const ClassInfo> class_infos();

/// Whether a visibility counts as light where there is only light and shadow: more than one half.
constexpr bool is_lit(float visibility) { return visibility > 0.5f; }

/// Whether a pixel of this visibility is wrong: it is off by more than one half, or by one half and dark where the reference is
/// lit. Against 0 and 1 that is what `is_lit` says.
constexpr bool is_wrong(float visibility, float reference) {
  return is_lit(reference) ? reference - visibility >= 0.5f : visibility - reference > 0.5f;
}
/// Behind casters that let a part of the light through a pixel is wrong that is off by more than this: half of what one sheet
/// takes is wrong, too.
inline constexpr float most_off_behind_glass = 1.0f / 20;
constexpr bool is_wrong(float visibility, float reference, AnswerKind kind) {
  if (kind != AnswerKind::transmitted) return is_wrong(visibility, reference);
  return visibility - reference > most_off_behind_glass || reference - visibility > most_off_behind_glass;
}

/// Whether float32 resolves a scene where it is: its longest side is at least 2^-12 of the largest coordinate of scene, finite
/// light and eye, which is 256 rho. Where it does not, all that would be tested is uncertain.
bool is_resolved(const Scene& scene, const Light& light, const View& view);

/// Of most rasterizers: they round vertices to the grid of 2^-8 px.
inline constexpr int usual_subpixel_bits = 8;
/// The side of a square of such a grid, in pixels; half of it is the most that a vertex is moved along x and along y.
inline double snapping_grid(int subpixel_bits) { return std::ldexp(1.0, -subpixel_bits); }

/// Of every pixel: 1 where what it shows is in doubt, which makes it of class S, if of none before: an eye ray through a corner
/// of the square of +- half a usual snapping_grid around its center meets nothing, another mesh, or a surface more than 2 % of
/// the distance nearer or farther; else 0. `everything` holds all meshes under the truth of the G-buffer.
std::vector<std::uint8_t> find_silhouettes(const RayScene& everything, const GBuffer& gbuffer);

/// Class of every pixel. `reference` is the mask of trace_shadows for the same casters, `silhouettes` is that of
/// find_silhouettes; where it is empty, no pixel is of class S.
std::vector<PixelClass> classify(const Scene& scene, const RayScene& casters, const GBuffer& gbuffer, const Light& light,
                                 std::span<const float> reference, std::span<const std::uint8_t> silhouettes);

/// Of every pixel: 1 where it is of class T and its exact answer is another one when its sample point lies at a corner of the
/// square of +- half a snapping_grid around the center, else 0. An edge between two rounded vertices moves by up to that along
/// x and along y, and a straight boundary that such a move takes across the center leaves one of the four corners on its other
/// side.
///
/// The point at a corner is the one that a G-buffer would hold there, and its shadow ray goes by the recipe of the reference. A
/// point that does not face the light has no answer, and none differs from it. `everything` holds all meshes under the truth of
/// the G-buffer; `reference` and `classes` are those of `casters`.
std::vector<std::uint8_t> find_snapping(const Scene& scene, const RayScene& everything, const RayScene& casters,
                                        const GBuffer& gbuffer, const Light& light, std::span<const float> reference,
                                        std::span<const PixelClass> classes, int subpixel_bits = usual_subpixel_bits);

std::array<std::size_t, 6> count_classes(std::span<const PixelClass> classes);

}  // namespace gnomon
