#include "measure/row/row.h"

#include <algorithm>
#include <deque>

#include "measure/picture/shading.h"
#include "measure/scene/time_reference.h"
#include "measure/score/error_picture.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

Record::SceneFacts facts_of(const Scene& scene) {
  Record::SceneFacts facts{.meshes = scene.meshes.size(), .triangles = scene.triangle_count(), .closed = true};
  for (const Mesh& mesh : scene.meshes) {
    facts.closed = facts.closed && mesh.is_closed();
    facts.boundary_edges += mesh.facts.boundary_edge_count;
    facts.nonmanifold_edges += mesh.facts.nonmanifold_edge_count;
    facts.misoriented_edges += mesh.facts.misoriented_edge_count;
    facts.degenerate += mesh.facts.degenerate_count;
  }
  return facts;
}

/// The channels of a row's mask file.
struct MaskChannels {
  std::vector<std::string> names;
  std::vector<std::span<const float>> values;
  std::deque<std::vector<float>> made;  ///< that `values` look at

  void add(std::string_view of, std::string_view what, std::span<const float> channel) {
    names.push_back(fmt::format("{}.{}", of, what));
    values.push_back(channel);
  }
  /// Three values a pixel as channels "OF.R", "OF.G", "OF.B".
  void add_colors(std::string_view of, std::span<const float> rgb) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      std::vector<float>& one = made.emplace_back();
      for (std::size_t i = channel; i < rgb.size(); i += 3) one.push_back(rgb[i]);
      add(of, std::string_view("RGB").substr(channel, 1), one);
    }
  }
};

MaskChannels mask_channels(const Record& record, const MeasuredRow& measured) {
  MaskChannels file;
  for (const auto& [light, answer, other_mask, right_on_mesh] : measured.lights) {
    file.add(light.name, "V", answer.mask);
    if (!answer.causes.empty()) {
      std::vector<float>& causes = file.made.emplace_back();
      for (const Cause cause : answer.causes) causes.push_back(static_cast<float>(cause));
      file.add(light.name, "cause", causes);
    }
    if (other_mask) file.add(light.name, name(record.truth == Truth::shape ? Truth::mesh : Truth::shape), *other_mask);
  }
  if (measured.global) {
    file.add_colors(global_channel, measured.global->picture);
    file.add_colors(global_reference_channel, measured.global->reference);
  }
  return file;
}

}  // namespace

void describe_scene(Record& record, const Scene& scene) {
  record.scene_facts = facts_of(scene);
  record.notes = scene.notes;
}

void describe_lights(Record& record, const Scene& scene, std::span<const Light* const> lights) {
  std::vector<std::string> kinds;
  record.lights.clear();
  for (const Light* const light : lights) {
    Record::LightFacts& facts = record.lights.emplace_back();
    facts.name = light->name;
    facts.kind = kind_name(*light);
    facts.answer = answer_kind(scene, *light);
    if (std::ranges::find(kinds, facts.kind) == kinds.end()) kinds.push_back(facts.kind);
  }
  record.light_kind = joined(kinds, "+");
  record.answer = row_answer(record);
}

void remove_pictures(const Record& record, const fs::path& out) {
  std::error_code ignored;
  for (const std::string& picture : pictures(record)) fs::remove(out / picture, ignored);
  if (record.kept_frames && !record.kept_frames->mask.empty()) fs::remove(out / record.kept_frames->mask, ignored);
}

Evidence MeasuredRow::evidence(const Scene& scene) const {
  Evidence evidence = together ? together->evidence() : lights.front().answer.evidence(scene, lights.front().light);
  for (std::size_t k = 0; k < evidence.channels.size(); ++k) {
    // The only light of a channel has more than what lights have together.
    const auto is_of_channel = [&](const MeasuredLight& light) {
      return channel_of(light.light.name) == together->channels[k].channel;
    };
    if (std::ranges::count_if(lights, is_of_channel) != 1) continue;
    const MeasuredLight& only = *std::ranges::find_if(lights, is_of_channel);
    evidence.channels[k] = only.answer.evidence(scene, only.light);
  }
  if (global) {
    evidence.global_picture = global->picture;
    evidence.global_reference = global->reference;
    evidence.global_error = global->error;
  }
  return evidence;
}

void put_together(MeasuredRow& row, const Scene& scene, bool in_gray) {
  if (&row.lights.front() == &row.lights.back()) return;  // one light is its row
  std::vector<Evidence> lights;
  for (const MeasuredLight& light : row.lights) lights.push_back(light.answer.evidence(scene, light.light));
  row.together = in_gray ? together_in_gray(lights) : together(lights);
}

Picture shade(const Scene& scene, const MeasuredRow& row) {
  if (!row.together) return shade(scene, row.gbuffer(), row.lights.front().light, row.mask());
  const Together& whole = *row.together;
  if (whole.channels.empty()) return shade(scene, row.gbuffer(), whole.received, whole.shown);
  std::array<ChannelLight, std::size(all_channels)> channels;
  for (const Together& one : whole.channels) channels[static_cast<std::size_t>(*one.channel)] = {one.received, one.shown};
  return shade(scene, row.gbuffer(), channels, exposure_of(scene, row.gbuffer(), whole.received));
}

std::string picture_stem(const Record& record) {
  std::string stem;
  const std::string scene = without_time(record.scene), time = record.scene.substr(scene.size());
  for (const char c : fmt::format("{}{}-{}-{}", fs::path(scene).stem().string(), time, record.light, record.technique))
    stem += std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '_' ? c : '-';
  constexpr std::size_t most = 180;
  return stem.substr(0, most) + "-" + record.job.substr(0, 8);
}

void write_mask(Record& record, const MeasuredRow& measured, const fs::path& out) {
  record.mask = "masks/" + picture_stem(record) + ".exr";
  // For `--rescore` and the report: the mask, the cause of each pixel, the mask under the other truth, and pictures of all
  // light.
  const MaskChannels file = mask_channels(record, measured);
  write_exr(out / *record.mask, record.width, record.height, file.names, file.values);
}

void write_pictures(Record& record, const Scene& scene, const MeasuredRow& measured, const fs::path& out) {
  const std::string stem = picture_stem(record);
  record.error_picture = "errors/" + stem + ".png";
  record.shaded_picture = "shaded/" + stem + ".png";
  write_png(out / *record.error_picture, draw_errors(measured.evidence(scene), setting_name(record)));
  write_png(out / *record.shaded_picture, shade(scene, measured));
}

}  // namespace gnomon
