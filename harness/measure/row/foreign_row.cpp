#include "measure/row/foreign_row.h"

#include <gnomon/registry.h>

#include <cctype>

#include "measure/paths.h"
#include "measure/record/scene_place.h"
#include "measure/scene/channels.h"
#include "measure/scene/load.h"
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
  const bool is_alike =
      kept.scene == fresh.scene && kept.light == fresh.light && kept.start.has_value() == fresh.start.has_value();
  if (is_alike && !scene.empty() && scene != context_text(fresh, "scene_hash"))
    return fmt::format("{} has changed since {} was run", scene_in_words(fresh.scene), title(kept));
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

std::string light_of(std::span<const ForeignMask> masks) {
  const std::string& first = masks.front().light.name;
  return masks.size() == 1 ? first : std::string(whole_name(first));
}

std::string ScoredMask::words(std::size_t light) const {
  const std::optional<WholeMask>& change = whole[light];
  if (!change) return {};
  return fmt::format("the whole mask is {}, which makes {:.0f} % of its error", change->words(), 100 * change->explained);
}

std::string ScoredMask::words() const {
  std::vector<std::string> all;
  for (std::size_t k = 0; k < whole.size(); ++k)
    if (whole[k]) all.push_back((whole.size() > 1 ? measured.lights[k].light.name + ": " : "") + words(k));
  return joined(all, "; ");
}

ScoredMask scored_mask(const Scene& scene, FrameStore& frames, const FrameKey& key, std::span<const ForeignMask> masks) {
  ScoredMask scored;
  for (const ForeignMask& mask : masks) {
    Answer answer{frames.gbuffer(key), frames.reference(key, mask.light), mask.values, {}};
    Attribution asked{frames.scene(mask.light),
                      frames.casters(key.truth, mask.light),
                      answer.gbuffer,
                      mask.light,
                      answer.reference,
                      answer.mask,
                      {},
                      nullptr};
    const std::optional<WholeMask>& whole = scored.whole.emplace_back(find_whole_mask(asked));
    if (whole) asked.whole = &*whole;
    answer.causes = find_causes(asked);
    scored.measured.lights.push_back({mask.light, std::move(answer)});
  }
  put_together(scored.measured, scene);
  scored.score = score(scored.measured, scene);
  return scored;
}

namespace {

/// What the masks are, for a record.
Json facts_of(std::span<const ForeignMask> masks, const std::filesystem::path& file) {
  std::vector<std::string> channels;
  std::vector<float> values;
  for (const ForeignMask& mask : masks) {
    channels.push_back(mask.channel);
    values.insert(values.end(), mask.values.begin(), mask.values.end());
  }
  return json_object(
      {{"file", file.string()}, {"channel", joined(channels, ", ")}, {"hash", content_hash(std::as_bytes(std::span(values)))}});
}

/// The metrics of the same masks under the other truth, which become the row's other masks.
Metrics score_other(MeasuredRow& row, const Scene& scene, FrameStore& frames, const FrameKey& key) {
  MeasuredRow other;
  for (MeasuredLight& light : row.lights) {
    light.other_mask = light.answer.mask;
    other.lights.push_back(
        {light.light, Answer{frames.gbuffer(key), frames.reference(key, light.light), light.answer.mask, {}}});
  }
  put_together(other, scene);
  return score(other, scene).whole.metrics;
}

}  // namespace

ForeignRow foreign_row(const Scene& scene, const std::string& reference, FrameStore& frames, const FrameKey& key,
                       std::span<const ForeignMask> masks, const ForeignNames& names) {
  FrameKey seen = key;
  if (!scene.has_curved_shapes()) seen.truth = Truth::shape;
  ForeignRow row{.record = {}, .scored = scored_mask(scene, frames, seen, masks)};
  Record& record = row.record;
  record.scene = reference;
  record.light = light_of(masks);
  record.view = key.view.name;
  record.technique = names.technique;
  record.label = names.label;
  record.width = key.width;
  record.height = key.height;
  record.truth = key.truth;
  record.job = hash_of(record);
  std::vector<const Light*> lights;
  std::vector<std::string> light_names;
  for (const ForeignMask& mask : masks) {
    lights.push_back(&mask.light);
    light_names.push_back(mask.light.name);
  }
  record.context = machine_context(0);
  record.context["scene_hash"] = frames.scene_hash(light_names);
  record.context["frames"] = frame_version();
  record.context["foreign"] = facts_of(masks, names.file);
  describe_scene(record, scene);
  describe_lights(record, scene, lights);
  tell_times(record, names.told_ms);
  if (const std::string words = row.scored.words(); !words.empty())
    record.notes.push_back(fmt::format("{}: {}", called(record), words));

  MeasuredRow& measured = row.scored.measured;
  for (std::size_t k = 0; k < masks.size(); ++k) record.lights[k].reference = reference_facts(measured.lights[k].answer, {});
  put_score(record, row.scored.score);
  const Truth other = key.truth == Truth::shape ? Truth::mesh : Truth::shape;
  FrameKey second = key;
  second.truth = other;
  record.metrics[other] = scene.has_curved_shapes() ? score_other(measured, scene, frames, second) : record.metrics[key.truth];
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
