#pragma once
#include "measure/picture/picture.h"
#include "measure/score/score.h"
#include "measure/score/together.h"

namespace gnomon {

/// One light of a row, and its answer: a mask beside the reference.
struct MeasuredLight {
  Light light;  ///< that counts, which on a path is not the scene's
  Answer answer;
  std::optional<std::vector<float>> other_mask = {};  ///< under the other truth, where there are two
  /// For causes: 1 where the technique is right on the mesh; empty where it does not see the mesh or that is the headline.
  std::vector<std::uint8_t> right_on_mesh = {};
};

/// All light toward the eye, three floats a pixel: the technique's, and the reference's with its standard errors.
struct GlobalAnswer {
  std::vector<float> picture, reference, error;
  /// By light of the row; nothing of those without area, which have no radiance.
  std::vector<std::optional<Record::ReferenceFacts::GlobalFacts>> facts;
};
/// Their channels in a row's mask file, where the run has pictures of all light: "global.R" and so on, linear radiance.
inline constexpr std::string_view global_channel = "global", global_reference_channel = "global_reference";

/// A row's lights with their masks, wherever these come from: a worker, or a file.
struct MeasuredRow {
  std::vector<MeasuredLight> lights;  ///< one at least
  std::optional<Together> together;   ///< of several lights; see put_together
  std::optional<GlobalAnswer> global;

  const GBuffer& gbuffer() const { return lights.front().answer.gbuffer; }
  /// Of the light, of several of the lights together, with its channels where these are of several. This and the scene must
  /// outlive it.
  Evidence evidence(const Scene& scene) const;
  /// Its visibility shown: of several lights the share of the light that they would give.
  std::span<const float> mask() const { return together ? together->shown : lights.front().answer.mask; }
};
/// Makes `together` of several lights that have their answers. In gray where the rows of one reference shall share it: a
/// pixel's worst channel is another one in each of them.
void put_together(MeasuredRow& row, const Scene& scene, bool in_gray = false);
/// The scene in the light that the row's masks let through, in color where lights are of several channels.
Picture shade(const Scene& scene, const MeasuredRow& row);

/// Sets the record's facts of the scene itself.
void describe_scene(Record& record, const Scene& scene);
/// Sets the names and kinds of a row's lights, and with them the kind of the row's answer. `light` stays.
void describe_lights(Record& record, const Scene& scene, std::span<const Light* const> lights);

/// Letters, digits, dots and dashes of the job's title, and its hash: readable, unique, and no longer than a file's name may
/// be.
std::string picture_stem(const Record& record);
/// Writes the mask below `out` and names it in the record.
void write_mask(Record& record, const MeasuredRow& measured, const std::filesystem::path& out);
/// The same of error picture and shaded picture.
void write_pictures(Record& record, const Scene& scene, const MeasuredRow& measured, const std::filesystem::path& out);
/// Removes those that the record names, and no other row.
void remove_pictures(const Record& record, const std::filesystem::path& out);

}  // namespace gnomon
