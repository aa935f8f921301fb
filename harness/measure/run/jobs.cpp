#include "measure/run/jobs.h"

#include <gnomon/registry.h>

#include "measure/program/plugin_facts.h"
#include "measure/record/title.h"
#include "measure/run/light_selection.h"
#include "measure/run/row_paths.h"
#include "measure/scene/channels.h"
#include "measure/scene/load.h"
#include "measure/scene/names.h"
#include "measure/worker/build.h"
#include "measure/worker/outside.h"

namespace gnomon {

std::string Job::title() const { return title_of_place(scene, light, view, path) + contender.name(); }

std::string Job::motion() const {
  if (!times) return {};
  const auto told = [](const auto& number) { return number ? fmt::format("{}", *number) : "-"; };
  return fmt::format("frames {} rate {} start {}", told(times->frames), told(times->frame_rate), told(times->start));
}

namespace {

std::size_t geometry_bytes(const Scene& scene) {
  std::size_t bytes = 0;
  for (const Mesh& mesh : scene.meshes)
    bytes += std::span(mesh.positions).size_bytes() + std::span(mesh.triangles).size_bytes();
  return bytes;
}

}  // namespace

const SceneLibrary::Entry& SceneLibrary::get(const std::string& reference) {
  if (const auto known = entries_.find(reference); known != entries_.end()) return *known->second;
  if (bytes_ > most_bytes_) {
    entries_.clear();
    bytes_ = 0;
  }
  auto fresh = std::make_unique<Entry>();
  try {
    fresh->scene = load_scene(place_of(reference));
    bytes_ += geometry_bytes(*fresh->scene);
  } catch (const SceneNotFetched& missing) {
    fresh->missing = missing.what();
  }
  return *entries_.emplace(reference, std::move(fresh)).first->second;
}

void SceneLibrary::forget(const std::string& reference) {
  const auto known = entries_.find(reference);
  if (known == entries_.end()) return;
  if (known->second->scene) bytes_ -= geometry_bytes(*known->second->scene);
  entries_.erase(known);
}

const std::string& SceneLibrary::place_of(const std::string& reference) const {
  const auto place = places_.find(reference);
  return place == places_.end() ? reference : place->second;
}

namespace {

bool is_pattern(const std::string& word) { return word.find('*') != word.npos; }

/// The views of a scene that words select, each once: names, or patterns in which `*` matches any letters. The first where
/// there are no words.
std::vector<std::string> views_of(const std::vector<std::string>& words, const std::string& reference, const Scene& scene) {
  const std::vector<std::string> there = names_of(scene.views);
  if (words.empty()) return {there.front()};
  std::vector<std::string> views;
  for (const std::string& word : words) {
    if (!is_pattern(word)) require_words({word}, there, "view", reference);
    const auto is_wanted = [&](const std::string& name) { return is_like(name, word); };
    if (std::ranges::none_of(there, is_wanted))
      throw Error("{} has no view whose name is like {}; it has: {}", scene_in_words(reference), word, joined(there, ", "));
    for (const std::string& name : there)
      if (is_wanted(name) && std::ranges::find(views, name) == views.end()) views.push_back(name);
  }
  return views;
}

/// Why a technique supports nothing of a group; nothing where it supports something. A scene that is not fetched says nothing:
/// rows on the other scenes are those of a machine that has it.
std::optional<std::string> objection(const SuiteGroup& group, const std::string& technique, SceneLibrary& library,
                                     SupportQuestions& questions) {
  std::optional<std::string> why;
  for (const std::string& reference : group.scenes) {
    const SceneLibrary::Entry& entry = library.get(reference);
    if (!entry.scene) continue;
    const std::vector<RowLights> rows = row_lights(group.lights, reference, *entry.scene);
    const std::vector<Support>& supports = questions.ask(reference, *entry.scene, technique);
    for (std::size_t k = 0; k < supports.size(); ++k) {
      const std::string& light = entry.scene->lights[k].name;
      const auto has_it = [&](const RowLights& row) { return std::ranges::find(row.lights, light) != row.lights.end(); };
      if (std::ranges::none_of(rows, has_it)) continue;
      if (supports[k]) return std::nullopt;
      if (!why) why = supports[k].why();
    }
  }
  return why;
}

/// The contenders of a group, without those of `*` that support nothing of it.
std::vector<Contender> contenders_of(const SuiteGroup& group, SceneLibrary& library, SupportQuestions& questions,
                                     std::vector<std::string>& left_out) {
  std::vector<Contender> kept;
  for (const Contender& contender : group.contenders) {
    std::optional<std::string> why;
    if (contender.is_from_wildcard) try {
        why = objection(group, contender.technique, library, questions);
      } catch (const WorkerFailure&) {  // its rows will report it
      }
    if (why)
      left_out.push_back(fmt::format("{}: {}", contender.technique, *why));
    else
      kept.push_back(contender);
  }
  return kept;
}

/// What is usual is left out: rows keep their hashes when there is one more thing that may be unusual.
std::string hash_of(const Job& job, const Suite& suite) {
  std::string asked = fmt::format("{}|{}|{}|{}|{}x{}|{}{}", job.scene, joined(job.lights, "+"), job.view, job.contender.name(),
                                  job.width, job.height, name(suite.truth), job.path.empty() ? "" : "|" + job.path);
  if (const AreaTarget usual; suite.target.error != usual.error || suite.target.cap != usual.cap)
    asked += fmt::format("|{}|{}", suite.target.error, suite.target.cap);
  if (suite.truth_over != TruthOver::center) asked += fmt::format("|over {}", name(suite.truth_over));
  if (job.global_samples > 0) asked += fmt::format("|global {}", job.global_samples);
  if (job.times) asked += "|" + job.motion();
  return content_hash(asked).substr(0, 16);
}

template <class Item>
std::size_t index_of(const std::vector<Item>& items, const std::string& name) {
  const Item* found = find_named(items, name);
  if (!found) throw Error("there is no {}", name);
  return static_cast<std::size_t>(found - items.data());
}

}  // namespace

Job with_contender(Job job, Contender contender, const Suite& suite) {
  job.contender = std::move(contender);
  job.hash = hash_of(job, suite);
  return job;
}

RowFrame first_frame(const Job& job, const Scene& scene) {
  RowFrame frame{.lights = {}, .view = index_of(scene.views, job.view), .width = job.width, .height = job.height, .path = {}};
  for (const std::string& light : job.lights) frame.lights.push_back(index_of(scene.lights, light));
  frame.global_samples = job.global_samples;
  if (!job.path.empty())
    frame.path = followed_path(scene, job.path, scene.lights[frame.lights.front()], scene.views[frame.view],
                               job.times.value_or(FrameTimes{}));
  return frame;
}

SuiteJobs expand_jobs(const Suite& suite, SceneLibrary& library, const WorkerOptions& worker) {
  SuiteJobs result;
  std::vector<Job>& jobs = result.jobs;
  SupportQuestions questions(worker, suite.timeout);
  std::map<std::string, std::size_t> places;  // by hash
  for (const SuiteGroup& group : suite.groups) {
    const std::vector<Contender> contenders = contenders_of(group, library, questions, result.left_out);
    for (const std::string& reference : group.scenes) {
      const SceneLibrary::Entry& entry = library.get(reference);
      std::vector<RowLights> lights;
      std::vector<std::string> views = group.views;
      if (entry.scene) {
        lights = row_lights(group.lights, reference, *entry.scene);
        views = views_of(group.views, reference, *entry.scene);
      } else {
        // Not fetched, so its lights are unknown: one row per technique reports that.
        if (std::ranges::all_of(group.lights, is_light_name))
          for (const std::string& light : group.lights) lights.push_back({light, {light}});
        if (lights.empty()) lights = {{"-", {"-"}}};
        if (views.empty() || std::ranges::any_of(views, is_pattern)) views = {"-"};
      }
      const std::vector<RowPath> paths = row_paths(group, reference, entry.scene ? &*entry.scene : nullptr, lights, views);
      const auto sizes = group.sizes.empty() ? std::vector{std::pair(suite.width, suite.height)} : group.sizes;
      for (const auto& [light, light_names] : lights)
        for (const std::string& view : views)
          for (const RowPath& path : paths)
            for (const auto& [width, height] : sizes)
              for (const Contender& contender : contenders) {
                Job job{"",          reference,  light,           view,      light_names,
                        contender,   width,      height,          path.name, group.global_samples,
                        jobs.size(), path.times, path.frame_count};
                job.hash = hash_of(job, suite);
                const auto [known, is_new] = places.try_emplace(job.hash, jobs.size());
                if (is_new)
                  jobs.push_back(std::move(job));
                else if (std::string& label = jobs[known->second].contender.label; label.empty())
                  label = contender.label;
              }
    }
  }
  std::ranges::sort(result.left_out);
  result.left_out.erase(std::unique(result.left_out.begin(), result.left_out.end()), result.left_out.end());
  return result;
}

Json parameters_of(const Contender& contender) {
  const auto technique = registry().technique(contender.technique).make();
  technique->apply(contender.settings);
  Json parameters = json_object();
  for (const Parameter* row : technique->parameters()) {
    const Json number = parse_if_json(row->text());
    parameters[std::string(row->name())] = number.is_number() ? number : Json(row->text());
  }
  return parameters;
}

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
  for (const OwnCause& cause : entry.about.causes)
    record.own_causes.push_back({std::string(cause.id), std::string(cause.sentence), cause.color});
  record.parameters = parameters_of(job.contender);
  record.width = job.width;
  record.height = job.height;
  record.path = job.path;
  if (job.times) {
    record.start = job.times->start;
    record.frame_rate = job.times->frame_rate;
    record.frame_count = job.times->frames;
  }
  record.place = job.place;
  record.truth = suite.truth;
  if (suite.truth_over != TruthOver::center) record.truth_over = suite.truth_over;
  record.context = context;
  const Json plugin = plugin_facts(job.contender.technique, job.contender.settings);
  if (!plugin.is_null()) record.context["plugin"] = plugin;
  // Another program's row has what that was built of.
  const std::string source = context.contains("technique_sources") ? context["technique_sources"].value(record.technique, "")
                                                                   : technique_source(record.technique, record.settings);
  record.context.erase("technique_sources");
  if (!source.empty()) record.context["technique_source"] = source;
  if (scene) {
    std::vector<const Light*> lights;
    for (const std::string& name : job.lights)
      if (const Light* const light = find_named(scene->lights, name)) lights.push_back(light);
    describe_lights(record, *scene, lights);
    describe_scene(record, *scene);
    if (job.times)
      if (std::string note = start_note(*scene, job.path, *job.times); !note.empty()) record.notes.push_back(std::move(note));
  } else {
    for (const std::string& name : job.lights) record.lights.emplace_back().name = name;
  }
  if (plugin.is_object() && !plugin.value("optimized", true))
    record.notes.push_back(fmt::format("{} comes from a plugin that was compiled without optimization", record.technique));
  return record;
}

}  // namespace gnomon
