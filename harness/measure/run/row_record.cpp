// What a row's record says before and after its measurement, and the pictures that it names.
#include <gnomon/registry.h>

#include "measure/run/row.h"
#include "measure/score/error_picture.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// Letters, digits, dots and dashes of the job's title, and its hash: readable and unique.
std::string file_stem(const Record& record) {
  std::string stem;
  for (const char c : fmt::format("{}-{}-{}", fs::path(record.scene).stem().string(), record.light, record.technique))
    stem += std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '_' ? c : '-';
  return stem + "-" + record.job.substr(0, 8);
}

Record::SceneFacts facts_of(const Scene& scene) {
  Record::SceneFacts facts;
  facts.meshes = scene.meshes.size();
  facts.triangles = scene.triangle_count();
  facts.closed = true;
  for (const Mesh& mesh : scene.meshes) {
    facts.closed = facts.closed && mesh.facts.closed();
    facts.boundary_edges += mesh.facts.boundary_edge_count;
    facts.nonmanifold_edges += mesh.facts.nonmanifold_edge_count;
    facts.misoriented_edges += mesh.facts.misoriented_edge_count;
    facts.degenerate += mesh.facts.degenerate_count;
  }
  return facts;
}

}  // namespace

Record start_record(const Job& job, const Suite& suite, const Scene* scene, const Json& context) {
  Record record;
  record.job = job.hash;
  record.suite = suite.name;
  record.scene = job.scene;
  record.light = job.light;
  record.view = job.view;
  record.technique = job.contender.technique;
  record.settings = job.contender.settings;
  if (!job.contender.label.empty()) record.label = job.contender.label;
  const TechniqueEntry& entry = registry().technique(job.contender.technique);
  record.role = entry.about.role;
  const auto technique = entry.make();
  technique->apply(job.contender.settings);
  for (const Parameter* row : technique->parameters()) {
    const Json number = parse_if_json(row->text());
    record.parameters[std::string(row->name())] = number.is_number() ? number : Json(row->text());
  }
  record.width = job.width;
  record.height = job.height;
  record.path = job.path;
  record.place = job.place;
  record.truth = suite.truth;
  record.context = context;
  if (scene) {
    if (const Light* light = find_named(scene->lights, job.light)) record.light_kind = kind_name(*light);
    record.scene_facts = facts_of(*scene);
    record.notes = scene->notes;
  }
  return record;
}

void remove_pictures(const Record& record, const fs::path& out) {
  std::error_code ignored;
  for (const std::string& picture : pictures(record)) fs::remove(out / picture, ignored);
}

void write_pictures(Record& record, const SceneRun& run, const MeasuredRow& measured, const fs::path& out) {
  const Answer& answer = measured.answer;
  const std::string stem = file_stem(record);
  // What `--rescore` and the report need: the mask, the cause of each pixel, and the mask under the other truth.
  std::vector<std::string> names = {record.light + ".V", record.light + ".cause"};
  std::vector<float> causes;
  for (const Cause cause : answer.causes) causes.push_back(static_cast<float>(cause));
  std::vector<std::span<const float>> channels = {answer.mask, causes};
  if (measured.other_mask) {
    names.push_back(fmt::format("{}.{}", record.light, name(record.truth == Truth::shape ? Truth::mesh : Truth::shape)));
    channels.push_back(*measured.other_mask);
  }
  record.mask = "masks/" + stem + ".exr";
  record.error_picture = "errors/" + stem + ".png";
  record.shaded_picture = "shaded/" + stem + ".png";
  write_exr(out / *record.mask, record.width, record.height, names, channels);
  const std::string title =
      record.label.value_or(record.settings.empty() ? record.technique : record.technique + ":" + record.settings);
  write_png(out / *record.error_picture, draw_errors(answer.evidence(run.scene, measured.light), title));
  write_png(out / *record.shaded_picture, shade(run.scene, answer.gbuffer, measured.light, answer.mask));
}

}  // namespace gnomon
