// Whether this program gives an edition.
#include <gnomon/registry.h>

#include "measure/edition/edition_text.h"
#include "measure/frame/frame.h"
#include "measure/scene/blob.h"
#include "measure/score/metrics.h"

namespace gnomon {

namespace {

std::string key_of(const std::string& scene, const std::string& light, bool moves) {
  return scene + ' ' + light + (moves ? " moving" : "");
}

void compare_scenes(const Edition& edition, SceneLibrary& library, std::vector<std::string>& lines) {
  const auto add = [&](const std::string& line) {
    if (std::ranges::find(lines, line) == lines.end()) lines.push_back(line);
  };
  std::set<std::string> seen;
  for (const SuiteGroup& group : edition.suite.groups) {
    std::vector<EditionScene> scenes;
    try {
      scenes = scenes_of_group(edition.suite, group, library);
    } catch (const Error& error) {  // a light, a view or an animation is gone
      add(fmt::format("{}: {}", joined(group.scenes, ", "), error.what()));
      for (const std::string& scene : group.scenes)
        for (const auto& [key, hash] : edition.scenes)
          if (key.starts_with(scene + ' ')) seen.insert(key);
      continue;
    }
    for (const EditionScene& scene : scenes) {
      seen.insert(scene.key);
      const auto known = edition.scenes.find(scene.key);
      if (!scene.missing.empty())
        add(scene.missing);
      else if (known == edition.scenes.end())
        add(fmt::format("scene {}: the edition has no hash of it", scene.key));
      else if (known->second != scene.hash)
        add(fmt::format("scene {} has hash {}, and the edition {}", scene.key, scene.hash, known->second));
    }
  }
  for (const auto& [key, hash] : edition.scenes)
    if (!seen.contains(key)) add(fmt::format("scene {}: the edition has a hash of it and no row", key));
}

void compare_metrics(const Edition& edition, std::vector<std::string>& lines) {
  for (const auto& [name, version] : edition.metrics) {
    const auto info = std::ranges::find(metric_infos(), name, &MetricInfo::name);
    if (info == metric_infos().end())
      lines.push_back(fmt::format("metric {} is not there; the edition has its version {}", name, version));
    else if (info->version != version)
      lines.push_back(fmt::format("metric {} has version {}, and the edition {}", name, info->version, version));
  }
  if (frame_version() != edition.frames)
    lines.push_back(fmt::format("frames (G-buffers, references and pixel classes) have version {}, and the edition {}",
                                frame_version(), edition.frames));
}

/// A parameter that came later is no difference: at its default the rows are those that they were, or an erratum says why not.
void compare_techniques(const Edition& edition, std::vector<std::string>& lines) {
  const std::map<std::string, Json> now = parameters_of_contenders(edition.suite);
  for (const auto& [name, parameters] : now)
    if (!edition.techniques.contains(name))
      lines.push_back(fmt::format("technique {}: the edition has no parameters of it", name));
  for (const auto& [name, parameters] : edition.techniques) {
    const auto found = now.find(name);
    if (found == now.end()) {
      lines.push_back(fmt::format("technique {}: the edition has its parameters and no row", name));
      continue;
    }
    for (const auto& [parameter, value] : parameters.items()) {
      const auto there = found->second.find(parameter);
      if (there == found->second.end())
        lines.push_back(
            fmt::format("technique {} has no parameter {}; the edition has {}", name, parameter, plain_text(value)));
      else if (*there != value)
        lines.push_back(fmt::format("technique {} has {} = {}, and the edition {}", name, parameter, plain_text(*there),
                                    plain_text(value)));
    }
  }
}

}  // namespace

std::string scene_key(const Job& job) { return key_of(job.scene, job.light, job.times.has_value()); }
std::string scene_key(const Record& record) { return key_of(record.scene, record.light, record.start.has_value()); }

std::vector<EditionScene> scenes_of_group(const Suite& suite, const SuiteGroup& group, SceneLibrary& library) {
  Suite of_group = suite;
  of_group.groups = {group};
  of_group.groups.front().contenders = {group.contenders.front()};  // places alone
  std::vector<EditionScene> scenes;
  for (const Job& job : expand_jobs(of_group, library, {}).jobs) {
    const std::string key = scene_key(job);
    if (std::ranges::find(scenes, key, &EditionScene::key) != scenes.end()) continue;
    const SceneLibrary::Entry& entry = library.get(job.scene);
    EditionScene& scene = scenes.emplace_back(EditionScene{key, "", entry.missing});
    if (entry.scene) scene.hash = scene_hash(*entry.scene, job.lights, job.times ? WithMotion::yes : WithMotion::no);
  }
  return scenes;
}

std::map<std::string, Json> parameters_of_contenders(const Suite& suite) {
  std::map<std::string, Json> all;
  for (const SuiteGroup& group : suite.groups)
    for (const Contender& contender : group.contenders)
      for (const Contender& one : {Contender{contender.technique, "", ""}, contender})
        if (!all.contains(one.name())) all[one.name()] = parameters_of(one);
  return all;
}

std::vector<std::string> edition_differences(const Edition& edition, SceneLibrary& library) {
  std::vector<std::string> lines;
  compare_scenes(edition, library, lines);
  compare_metrics(edition, lines);
  compare_techniques(edition, lines);
  return lines;
}

}  // namespace gnomon
