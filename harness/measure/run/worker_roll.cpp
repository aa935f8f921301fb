#include "measure/run/worker_roll.h"

#include <gnomon/kit/inner_technique.h>
#include <gnomon/plugins.h>
#include <gnomon/registry.h>

#include "measure/program/described_technique.h"
#include "measure/run/worker_frame.h"
#include "measure/run/worker_words.h"
#include "measure/scene/blob.h"

namespace gnomon {

namespace {

Json load(const std::string& plugin) {
  try {
    load_plugin(plugin);
  } catch (const Error& error) {
    return json_object({{"refused", error.what()}});
  }
  Json answer = json_object({{"techniques", Json::array()}, {"scenes", Json::array()}});
  for (const TechniqueEntry& entry : registry().techniques())
    if (entry.origin == plugin) answer["techniques"].push_back(sheet_json(entry));
  for (const SceneEntry& entry : registry().scenes())
    if (entry.origin == plugin) answer["scenes"].push_back(sheet_json(entry));
  const PluginFacts& facts = loaded_plugins().back();
  answer["facts"] = json_object({{"file", facts.file},
                                 {"build_type", facts.build_type},
                                 {"flags", facts.flags},
                                 {"compiler", facts.compiler},
                                 {"is_optimized", facts.is_optimized}});
  return answer;
}

const SceneEntry& scene_named(const std::string& id) {
  const SceneEntry* const entry = registry().find_scene(id);
  if (!entry) throw Error("there is no scene {}", id);
  return *entry;
}

Json describe(const Json& request) {
  if (request.contains("scene"))
    return json_object({{"object", object_json(scene_named(request.at("scene").get<std::string>()))}});
  return json_object({{"object", object_json(registry().technique(request.at("technique").get<std::string>()))}});
}

Json make_scene(const Json& request) {
  const auto generator = scene_named(request.at("scene").get<std::string>()).make();
  generator->apply(request.at("settings").get<std::string>());
  write_file(request.at("out").get<std::string>(), scene_bytes(generator->make()));
  return Json::object();
}

Json supports(const Json& request) {
  static std::string file;  // scenes are asked about one after the other
  static Scene scene;
  if (const std::string wanted = request.at("scene"); wanted != file) {
    scene = scene_in(wanted);
    file = wanted;
  }
  const auto technique = registry().technique(request.at("technique").get<std::string>()).make();
  technique->apply(request.at("settings").get<std::string>());
  Json lights = Json::array();
  for (const Light& light : scene.lights) {
    const Support support = technique->supports(scene, light, scene.views.front());
    lights.push_back(support_json(support));
  }
  return json_object({{"lights", lights}});
}

}  // namespace

std::optional<Json> answer_of_roll(const Json& request) {
  const std::string what = request.at("do");
  if (what == "load") return load(request.at("plugin"));
  if (what == "describe") return describe(request);
  if (what == "known_lights")
    return json_object({{"lights", known_lights(registry().technique(request.at("technique").get<std::string>()))}});
  if (what == "make_scene") return make_scene(request);
  if (what == "supports") return supports(request);
  return std::nullopt;
}

}  // namespace gnomon
