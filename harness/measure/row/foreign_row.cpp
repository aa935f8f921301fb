#include "measure/row/foreign_row.h"

#include <gnomon/registry.h>

#include <cctype>

#include "measure/paths.h"
#include "measure/record/scene_place.h"
#include "measure/worker/machine_context.h"

namespace gnomon {

namespace {

/// The same frame with a mask of the same name has the same hash in every folder.
std::string hash_of(const Record& r) {
  const std::string asked = fmt::format("foreign|{}|{}|{}|{}|{}|{}x{}|{}", r.scene, r.light, r.view, r.technique, *r.label,
                                        r.width, r.height, name(r.truth));
  return content_hash(asked).substr(0, 16);
}

std::string called(const Record& record) { return record.label.value_or(record.technique); }

/// The told times, and a note that they were not measured.
void tell_times(Record& record, const std::map<Stage, double>& told_ms) {
  std::vector<std::string> stages;
  for (const auto& [stage, ms] : told_ms) {
    record.times(stage) = {{ms}};
    stages.emplace_back(name(stage));
  }
  if (!stages.empty())
    record.notes.push_back(fmt::format("{}: times told, not measured: {}", called(record), joined(stages, ", ")));
}

/// Why one table cannot have a row of the folder and this one; empty where it can.
std::string objection(const Record& kept, const Record& fresh) {
  const std::string then = context_text(kept, "commit"), now = context_text(fresh, "commit");
  if (!then.empty() && then != now) return fmt::format("it holds rows of commit {}, and this program is {}", then, now);
  const std::string scene = context_text(kept, "scene_hash");
  if (kept.scene == fresh.scene && kept.light == fresh.light && !scene.empty() && scene != context_text(fresh, "scene_hash"))
    return fmt::format("scene {} has changed since {} was run", fresh.scene, title(kept));
  if (kept.truth != fresh.truth) return fmt::format("its rows have the truth {}, not {}", name(kept.truth), name(fresh.truth));
  return {};
}

}  // namespace

std::string id_of_label(const std::string& label) {
  std::string id;
  for (const char c : label)
    if (std::isalnum(static_cast<unsigned char>(c)))
      id += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (!id.empty() && id.back() != '_')
      id += '_';
  while (id.ends_with('_')) id.pop_back();
  return id;
}

void check_foreign_id(const std::string& id) {
  constexpr std::size_t most = 60;
  if (id.empty() || id.size() > most || id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") != id.npos)
    throw Error("--technique '{}' is no id of 1 .. {} small letters, digits and _", id, most);
  if (registry().find_technique(id))
    throw Error("technique {} is one that runs here: give the mask's another id with --technique", id);
}

std::string ScoredMask::words() const {
  if (!whole) return {};
  return fmt::format("the whole mask is {}, which makes {:.0f} % of its error", whole->words(), 100 * whole->explained);
}

ScoredMask scored_mask(const Scene& scene, FrameStore& frames, const FrameKey& key, const Light& light,
                       std::vector<float> values) {
  ScoredMask scored;
  MeasuredLight& measured = scored.measured.lights.emplace_back(MeasuredLight{light, {}});
  Answer& answer = measured.answer;
  answer.gbuffer = frames.gbuffer(key);
  answer.reference = frames.reference(key, light);
  answer.mask = std::move(values);
  Attribution asked{scene, frames.casters(key.truth), answer.gbuffer, light, answer.reference, answer.mask, {}, nullptr};
  scored.whole = find_whole_mask(asked);
  if (scored.whole) asked.whole = &*scored.whole;
  answer.causes = find_causes(asked);
  scored.score = score(scored.measured, scene);
  return scored;
}

ForeignRow foreign_row(const Scene& scene, const std::string& reference, FrameStore& frames, const FrameKey& key,
                       const Light& light, ForeignMask mask) {
  FrameKey seen = key;
  if (!scene.has_curved_shapes()) seen.truth = Truth::shape;
  const Json facts = json_object(
      {{"file", mask.file.string()}, {"channel", mask.channel}, {"hash", content_hash(std::as_bytes(std::span(mask.values)))}});
  auto other_mask = scene.has_curved_shapes() ? std::optional(mask.values) : std::nullopt;
  ForeignRow row{.record = {}, .scored = scored_mask(scene, frames, seen, light, std::move(mask.values))};
  Record& record = row.record;
  record.scene = reference;
  record.light = light.name;
  record.view = key.view.name;
  record.technique = mask.technique;
  record.label = mask.label;
  record.width = key.width;
  record.height = key.height;
  record.truth = key.truth;
  record.job = hash_of(record);
  record.context = machine_context(0);
  record.context["scene_hash"] = frames.scene_hash({light.name});
  record.context["frames"] = frame_version();
  record.context["foreign"] = facts;
  describe_scene(record, scene);
  const Light* const lights[] = {&light};
  describe_lights(record, scene, lights);
  tell_times(record, mask.told_ms);
  if (row.scored.whole) record.notes.push_back(fmt::format("{}: {}", called(record), row.scored.words()));

  MeasuredLight& measured = row.scored.measured.lights.front();
  record.lights.front().reference = reference_facts(measured.answer, {});
  put_score(record, row.scored.score);
  const Truth other = key.truth == Truth::shape ? Truth::mesh : Truth::shape;
  record.metrics[other] = record.metrics[key.truth];
  if (other_mask) {
    FrameKey second = key;
    second.truth = other;
    const Answer answer{frames.gbuffer(second), frames.reference(second, light), *other_mask, {}};
    record.metrics[other] = measure_metrics(Scoring(answer.evidence(scene, light)));
    measured.other_mask = std::move(other_mask);
  }
  record.status = Status::ok;
  return row;
}

void add_foreign_rows(const std::filesystem::path& out, const Scene& scene, std::vector<ForeignRow>& rows) {
  make_folder(out, "output folder");
  RecordWriter writer(out);  // from here on the folder is ours
  std::vector<Record> records;
  if (std::filesystem::exists(records_file(out))) records = read_records(out);
  for (const ForeignRow& row : rows)
    for (const Record& kept : records)
      if (const std::string why = objection(kept, row.record); !why.empty())
        throw Error("{} cannot take the row: {}; name another --out", out.string(), why);
  std::uint64_t place = 0;
  for (const Record& kept : records) place = std::max(place, kept.place + 1);
  const std::string suite = records.empty() ? "score" : records.back().suite;
  for (ForeignRow& row : rows) {
    const auto known = std::ranges::find(records, row.record.job, &Record::job);
    row.record.suite = known == records.end() ? suite : known->suite;
    row.record.place = known == records.end() ? place++ : known->place;
    if (const auto path = path_to_scene(out, row.record.scene)) row.record.context["scene_file"] = *path;
    write_mask(row.record, row.scored.measured, out);
    write_pictures(row.record, scene, row.scored.measured, out);
    if (known == records.end())
      records.push_back(row.record);
    else
      *known = row.record;
  }
  writer.replace(records);
  writer.close();
}

}  // namespace gnomon
