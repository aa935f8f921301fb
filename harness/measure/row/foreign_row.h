#pragma once
#include "measure/cause/whole_mask.h"
#include "measure/row/score_row.h"

namespace gnomon {

/// A mask that another program made of a view of a scene under one light.
struct ForeignMask {
  Light light;
  std::string channel;  ///< of its file
  std::vector<float> values;
};
/// The light of a row of masks: of those of a light's three channels the whole light.
std::string light_of(std::span<const ForeignMask> masks);

/// The names of a row of such masks, and what is told of it.
struct ForeignNames {
  std::string technique, label;  ///< id, see check_foreign_id; what tables write
  std::filesystem::path file;
  std::map<Stage, double> told_ms;  ///< times from outside, not measured here
};

/// A label as an id: "POV-Ray 3.7" is pov_ray_3_7. Empty where it has neither letters nor digits.
std::string id_of_label(const std::string& label);
/// Throws Error where it is no id, or that of a technique which runs here: their rows would look alike.
void check_foreign_id(const std::string& id);

struct ScoredMask {
  MeasuredRow measured;
  RowScore score;
  std::vector<std::optional<WholeMask>> whole;  ///< by light

  /// "the whole mask is shifted by 1 px right, which makes 98 % of its error"; empty where it is not changed as a
  /// whole.
  std::string words(std::size_t light) const;
  /// Those of all lights; of several each with the light's name.
  std::string words() const;
};
/// The mask of one light, or those of a light's three channels as one row. Their causes are a change of the mask as a whole,
/// and else the look and place of wrong pixels, because a file explains none.
ScoredMask scored_mask(const Scene& scene, FrameStore& frames, const FrameKey& key, std::span<const ForeignMask> masks);

struct ForeignRow {
  Record record;
  ScoredMask scored;
};
/// A row as of a run, without what only a run can measure: times (unless told), counts and memory. Under the other truth the
/// same masks are compared with that truth.
ForeignRow foreign_row(const Scene& scene, const std::string& reference, FrameStore& frames, const FrameKey& key,
                       std::span<const ForeignMask> masks, const ForeignNames& names);

/// Adds rows with their pictures to the folder of a run, or makes one. A row of the same job takes its predecessor's place.
/// Throws Error, and changes nothing, where one table cannot have the folder's rows and these: they are of another commit or
/// truth, or of the scene as it was.
void add_foreign_rows(const std::filesystem::path& out, const Scene& scene, std::vector<ForeignRow>& rows);

}  // namespace gnomon
