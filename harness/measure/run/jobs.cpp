#include "measure/run/jobs.h"

#include <gnomon/param.h>

#include <algorithm>

#include "measure/scene/blob.h"
#include "measure/scene/load.h"
#include "measure/scene/motion.h"

namespace gnomon {

const SceneLibrary::Entry& SceneLibrary::get(const std::string& reference) {
  std::unique_ptr<Entry>& entry = entries_[reference];
  if (!entry) {
    auto fresh = std::make_unique<Entry>();
    try {
      fresh->scene = load_scene(reference);
    } catch (const SceneNotFetched& missing) {
      fresh->missing = missing.what();
    }
    entry = std::move(fresh);
  }
  return *entry;
}

namespace {

template <class Item>
std::vector<std::string> names_of(const std::vector<Item>& items) {
  std::vector<std::string> names;
  for (const Item& item : items) names.push_back(item.name);
  return names;
}

void require(const std::vector<std::string>& wanted, const std::vector<std::string>& there, const char* what,
             const std::string& scene) {
  for (const std::string& name : wanted)
    if (std::find(there.begin(), there.end(), name) == there.end())
      throw Error("scene {} has no {} {}; did you mean {}? It has: {}", scene, what, name, nearest_word(name, there),
                  joined(there, ", "));
}

/// Every frame of the path, for each of these lights and views, must be one that can be drawn: nothing runs before that.
void check_path(const Scene& scene, const std::string& reference, const std::string& name,
                const std::vector<std::string>& lights, const std::vector<std::string>& views) {
  const Light& some_light = *find_named(scene.lights, lights.front());
  const View& some_view = *find_named(scene.views, views.front());
  // A path moves one of both and does not look at the other.
  if (find_path(scene, name, some_light, some_view).moves == Path::Moves::camera)
    for (const std::string& view_name : views) {
      const View& view = *find_named(scene.views, view_name);
      check_frames(find_path(scene, name, some_light, view), some_light, view, reference);
    }
  else
    for (const std::string& light_name : lights) {
      const Light& light = *find_named(scene.lights, light_name);
      check_frames(find_path(scene, name, light, some_view), light, some_view, reference);
    }
}

}  // namespace

void require_names(const std::string& reference, const Scene& scene, const std::vector<std::string>& lights,
                   const std::vector<std::string>& views) {
  require(lights, names_of(scene.lights), "light", reference);
  require(views, names_of(scene.views), "view", reference);
}

std::vector<Job> expand_jobs(const Suite& suite, SceneLibrary& library) {
  std::vector<Job> jobs;
  std::map<std::string, std::size_t> places;  // by hash
  for (const SuiteGroup& group : suite.groups)
    for (const std::string& reference : group.scenes) {
      const SceneLibrary::Entry& entry = library.get(reference);
      std::vector<std::string> lights = group.lights, views = group.views;
      if (entry.scene) {
        if (lights.empty()) lights = names_of(entry.scene->lights);
        if (views.empty()) views = {entry.scene->views.front().name};
        require_names(reference, *entry.scene, lights, views);
      } else {
        // Not fetched, so nobody knows its lights: one row per technique says so.
        if (lights.empty()) lights = {"-"};
        if (views.empty()) views = {"-"};
      }
      const std::vector<std::string> paths = group.paths.empty() ? std::vector<std::string>{""} : group.paths;
      const auto sizes = group.sizes.empty() ? std::vector{std::pair(suite.width, suite.height)} : group.sizes;
      if (entry.scene)
        for (const std::string& path : group.paths) check_path(*entry.scene, reference, path, lights, views);
      for (const std::string& light : lights)
        for (const std::string& view : views)
          for (const std::string& path : paths)
            for (const auto& [width, height] : sizes)
              for (const Contender& contender : group.contenders) {
                Job job{"", reference, light, view, contender, width, height, path, jobs.size()};
                // A job that stands still has the hash that it had before there were paths.
                const std::string asked = fmt::format("{}|{}|{}|{}|{}x{}|{}{}", reference, light, view, contender.name(), width,
                                                      height, name(suite.truth), path.empty() ? "" : "|" + path);
                job.hash = content_hash(asked).substr(0, 16);
                const auto [known, is_new] = places.try_emplace(job.hash, jobs.size());
                if (is_new)
                  jobs.push_back(std::move(job));
                else if (std::string& label = jobs[known->second].contender.label; label.empty())
                  label = contender.label;
              }
    }
  return jobs;
}

}  // namespace gnomon
