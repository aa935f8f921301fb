#include "measure/worker/outside.h"

#include <gnomon/plugins.h>
#include <gnomon/registry.h>

#include "measure/program/described_technique.h"
#include "measure/scene/blob.h"
#include "measure/worker/roll_protocol.h"

namespace gnomon {

namespace {

constexpr double patience = 10;  ///< seconds for what takes no time
constexpr double scene_patience = 600;

/// A worker that has loaded one plugin's library; a new one after each failure.
class PluginWorker {
 public:
  explicit PluginWorker(std::string path) : path_(std::move(path)) {}

  /// The plugin's roll. Throws Error, also where loading it ends or hangs the worker.
  LoadRequest::Reply load() {
    process_ = std::make_unique<WorkerProcess>(WorkerOptions{});
    LoadRequest::Reply roll;
    try {
      roll = process_->ask(LoadRequest{path_}, patience);
    } catch (const WorkerFailure& failure) {
      throw Error("plugin {} cannot be loaded: a worker that tried {}", path_, failure.what());
    }
    if (roll.refused) throw Error("{}", *roll.refused);
    return roll;
  }

  /// Its answer about an entry with ""; or an empty answer with the reason.
  template <class Request>
  std::pair<typename Request::Reply, std::string> ask(const Request& request) {
    try {
      if (!process_) load();
      return {process_->ask(request, patience), ""};
    } catch (const WorkerFailure& failure) {
      process_.reset();
      return {{}, failure.what()};
    }
  }

 private:
  std::string path_;
  std::unique_ptr<WorkerProcess> process_;
};

/// Made by a worker with the plugin.
MakeScene maker_of(const std::string& plugin) {
  return [plugin](const std::string& id, const std::string& settings) {
    const ScratchFolder folder = ScratchFolder::temporary("gnomon-scene");
    const std::filesystem::path file = folder.path() / "scene";
    WorkerProcess process(WorkerOptions{.plugins = {plugin}});
    try {
      process.ask(MakeSceneRequest{id, settings, file.string()}, scene_patience);
    } catch (const WorkerFailure& failure) {
      throw Error("scene {} of plugin {} {}", id, plugin, failure.what());
    }
    return scene_from_bytes(MappedFile::copy(file)->bytes());
  };
}

bool is_known(const std::string& path) {
  std::error_code ignored;
  const std::string file = path.find('/') == path.npos ? "./" + path : path;
  return std::ranges::any_of(loaded_plugins(),
                             [&](const PluginFacts& known) { return std::filesystem::equivalent(known.file, file, ignored); });
}

}  // namespace

void register_plugin(const std::string& path) {
  if (is_known(path)) return;  // the same file, also by another way to it
  PluginWorker worker(path);
  const LoadRequest::Reply roll = worker.load();
  registry().set_origin(path);
  try {
    for (const Json& sheet : roll.techniques) {
      const std::string id = sheet.at("id");
      const auto [described, broken] = worker.ask(DescribeRequest{.technique = id, .scene = {}});
      std::vector<std::string> lights;
      if (broken.empty()) lights = worker.ask(KnownLightsRequest{id}).first.lights;
      registry().add(described_technique(sheet, described.object, lights, broken));
    }
    for (const Json& sheet : roll.scenes) {
      const auto [described, broken] = worker.ask(DescribeRequest{.technique = {}, .scene = sheet.at("id")});
      registry().add(described_scene(sheet, described.object, broken, maker_of(path)));
    }
  } catch (const Json::exception& problem) {
    throw Error("plugin {} describes itself by nonsense: {}", path, complaint(problem));
  }
  PluginFacts facts = roll.facts.value_or(PluginFacts());
  facts.path = path;
  note_plugin(std::move(facts));
  registry().set_origin("");
}

const std::vector<Support>& SupportQuestions::ask(const std::string& reference, const Scene& scene,
                                                  const std::string& technique) {
  std::string& file = files_[reference];
  if (file.empty()) {
    if (!folder_) folder_.emplace(ScratchFolder::in_memory("gnomon-support"));
    file = (folder_->path() / std::to_string(files_.size())).string();
    write_file(file, scene_bytes(scene));
  }
  const auto [found, is_new] = answers_.try_emplace({reference, technique});
  auto& [supports, failure] = found->second;
  if (is_new) try {
      if (!process_) process_ = std::make_unique<WorkerProcess>(worker_);
      const SupportsRequest::Reply reply = process_->ask(SupportsRequest{file, technique, ""}, timeout_seconds_);
      for (const SupportReply& light : reply.lights) supports.push_back(support_of(light));
      if (supports.size() != scene.lights.size())
        throw WorkerFailure("answered supports for other lights than those of the request");
    } catch (const std::exception& problem) {
      process_.reset();
      failure = problem.what();
    }
  if (failure) throw WorkerFailure(*failure);
  return supports;
}

}  // namespace gnomon
