// Requests about techniques and scenes before any of them is opened.
#include <gnomon/kit/bases/inner_technique.h>
#include <gnomon/plugins.h>
#include <gnomon/registry.h>

#include "measure/program/described_technique.h"
#include "measure/scene/channels.h"
#include "measure/worker/requested_frame.h"
#include "measure/worker/roll_protocol.h"
#include "measure/worker/worker_server.h"

namespace gnomon {

namespace {

LoadRequest::Reply load(const LoadRequest& request) {
  try {
    load_plugin(request.plugin);
  } catch (const Error& error) {
    return {.refused = error.what(), .techniques = {}, .scenes = {}};
  }
  LoadRequest::Reply reply{.techniques = {}, .scenes = {}, .facts = loaded_plugins().back()};
  for (const TechniqueEntry& entry : registry().techniques())
    if (entry.origin == request.plugin) reply.techniques.push_back(sheet_json(entry));
  for (const SceneEntry& entry : registry().scenes())
    if (entry.origin == request.plugin) reply.scenes.push_back(sheet_json(entry));
  return reply;
}

const SceneEntry& scene_named(const std::string& id) {
  if (const SceneEntry* const entry = registry().find_scene(id)) return *entry;
  throw Error("there is no scene {}", id);
}

DescribeRequest::Reply describe(const DescribeRequest& request) {
  return {request.scene ? object_json(scene_named(*request.scene))
                        : object_json(registry().technique(request.technique.value_or("")))};
}

Done make_scene(const MakeSceneRequest& request) {
  const auto generator = scene_named(request.scene).make();
  generator->apply(request.settings);
  Scene scene = generator->make();
  write_file(request.out, scene_bytes(scene));
  return {};
}

SupportsRequest::Reply supports(const SupportsRequest& request) {
  static std::string file;  // requests come scene by scene
  static Scene scene;
  static std::optional<ChannelScenes> channels;
  if (request.scene != file) {
    scene = scene_in(request.scene);
    channels.emplace(scene);
  }
  file = request.scene;
  const TechniqueEntry& entry = registry().technique(request.technique);
  const auto technique = entry.make();
  technique->apply(request.settings);
  SupportsRequest::Reply reply;
  for (const Light& light : scene.lights)
    reply.lights.push_back(reply_of(support_of(entry.about, *technique, channels->of(light), light, scene.views.front())));
  return reply;
}

}  // namespace

void answer_roll(Answers& answers) {
  answers.on<LoadRequest>(load);
  answers.on<DescribeRequest>(describe);
  answers.on<KnownLightsRequest>([](const KnownLightsRequest& request) {
    const std::vector<std::string_view> known = known_lights(registry().technique(request.technique));
    return KnownLightsRequest::Reply{{known.begin(), known.end()}};
  });
  answers.on<MakeSceneRequest>(make_scene);
  answers.on<SupportsRequest>(supports);
}

}  // namespace gnomon
