// The record of a row before anything runs.
#include <gnomon/registry.h>

#include "measure/program/plugin_facts.h"
#include "measure/run/jobs.h"
#include "measure/scene/names.h"
#include "measure/worker/build.h"

namespace gnomon {

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
    describe_lights(record, lights);
    describe_scene(record, *scene);
  } else {
    for (const std::string& name : job.lights) record.lights.emplace_back().name = name;
  }
  if (plugin.is_object() && !plugin.value("optimized", true))
    record.notes.push_back(fmt::format("{} comes from a plugin that was compiled without optimization", record.technique));
  return record;
}

}  // namespace gnomon
