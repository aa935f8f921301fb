#pragma once
#include <gnomon/kit/area/area_rays.h>
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/technique.h>

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "fields.h"
#include "ways.h"

namespace gnomon::distance_field {

inline constexpr OwnCause causes[] = {
    {"field_resolution", "A finer field of the same casters would answer right.", {32, 144, 255}},
    {"contact_gap",
     "A caster within a voxel of the point counts only where the way to the light comes nearer to it again.",
     {248, 255, 0}},
    {"near_light",
     "The caster is so close to the light that distances do not tell it from what is behind the light.",
     {240, 172, 240}},
    {"nearest_caster", "Several casters hide parts of the light, and the nearest one alone counted.", {192, 72, 152}},
    {"thin_caster",
     "The way to the light's middle is blocked, but the way out of the caster is shorter than that to its outline.",
     {0, 136, 92}},
    {"one_edge", "What the caster hides of the light does not end in one straight line, as the formula has it.", {188, 88, 48}},
};

/// Their places in that order.
enum class Own : std::uint8_t { field_resolution, contact_gap, near_light, nearest_caster, thin_caster, one_edge };
constexpr std::string_view id_of(Own own) { return causes[static_cast<std::size_t>(own)].id; }
static_assert(id_of(Own::one_edge) == "one_edge");

/// Fields of twice the resolution, whose samples are computed where they are first asked. Not for many threads.
class DoubledFields {
 public:
  DoubledFields(const Fields& fields, const std::vector<MeshDistances>& meshes);
  const BoxTree& tree() const { return fields_.tree(); }
  const Bounds& box(std::uint32_t caster) const { return fields_.box(caster); }
  double voxel(std::uint32_t caster) const { return frames_[caster].voxel; }
  double distance(std::uint32_t caster, const glm::dvec3& p) const;

 private:
  /// Samples in cubes of 8 x 8 x 8, each made where one of them is asked.
  struct Samples {
    using Cube = std::array<std::uint16_t, 512>;
    glm::ivec3 cubes{0};  ///< along each axis
    std::vector<std::unique_ptr<Cube>> made;
    std::uint32_t near = 0;  ///< the triangle nearest to the last sample that was computed
  };
  double sample(std::uint32_t caster, const glm::ivec3& sample) const;

  const Fields& fields_;
  const std::vector<MeshDistances>& meshes_;
  std::vector<Frame> frames_;
  mutable std::vector<Samples> samples_;  ///< of each caster
};

/// Exact distances, with the steps and the thickness of open meshes of a field of eight times the resolution. Not for many
/// threads.
class ExactDistances {
 public:
  ExactDistances(const Fields& fields, const std::vector<MeshDistances>& meshes)
      : fields_(fields), meshes_(meshes), near_(meshes.size()) {}
  const BoxTree& tree() const { return fields_.tree(); }
  const Bounds& box(std::uint32_t caster) const { return fields_.box(caster); }
  double voxel(std::uint32_t caster) const { return fields_.voxel(caster) / 8; }
  double distance(std::uint32_t caster, const glm::dvec3& p) const;

 private:
  const Fields& fields_;
  const std::vector<MeshDistances>& meshes_;
  mutable std::vector<std::uint32_t> near_;  ///< of each caster, the triangle nearest to the last point
};

/// What is true of pixels, and which step of the technique answers otherwise. Not for many threads.
class Judge {
 public:
  Judge(const Fields& fields, const Light& light);

  /// A pixel that faces the light.
  struct Question {
    const GBuffer& gbuffer;
    std::size_t pixel;
    const Way& way;
    Formula formula;
    double answer;  ///< of the mask
  };
  /// Whether the formula is to blame: another one is set, and that of the disc would leave less than half of the error.
  bool is_of_formula(const Question& question) const;
  /// The id of the cause that holds; empty where the answer is right, and where the technique cannot tell.
  std::string_view cause(const Question& question) const;

 private:
  /// One caster as a scene of its own, or all of the scene, behind what answers for the light: rays with a standard error of
  /// `area_error`, or the exact one.
  struct Witness {
    std::unique_ptr<Scene> alone;  ///< null: the whole scene
    std::optional<RayScene> area;
    std::optional<ExactScene> hard;
    void prepare(const Scene& scene, bool has_area);
  };
  static constexpr double area_error = 0.005;
  double seen(const Witness& witness, const Question& question, const Receiver& receiver) const;
  double truth(const Question& question) const;
  /// What a caster alone hides of the light.
  double hidden(const Question& question, std::uint32_t caster) const;
  template <class Casters>
  double answer(const Trace<Casters>& trace, const Question& question) const;
  std::string_view cause_of_lit(const Question& question, double truth, const Trace<ExactDistances>& trace) const;

  const Fields& fields_;
  const Light& light_;
  std::vector<MeshDistances> meshes_;
  DoubledFields doubled_;
  ExactDistances exact_;
  Witness whole_;
  std::vector<Witness> alone_;  ///< of each caster
};

}  // namespace gnomon::distance_field
