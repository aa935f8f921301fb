#include "measure/scene/names.h"

#include <gnomon/param.h>

#include <cctype>

#include "measure/scene/channels.h"
#include "measure/scene/load.h"

namespace gnomon {

std::string plain_name(std::string name, std::string_view fallback) {
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? static_cast<char>(std::tolower(c)) : '_';
  return name.find_first_not_of('_') == std::string::npos ? std::string(fallback) : name;
}

void require_words(const std::vector<std::string>& wanted, const std::vector<std::string>& there, const char* what,
                   const std::string& reference) {
  for (const std::string& name : wanted)
    if (std::ranges::find(there, name) == there.end())
      throw Error("{} has no {} {}; did you mean {}? It has: {}", scene_in_words(reference), what, name,
                  nearest_word(name, there), joined(there, ", "));
}

void require_names(const std::string& reference, const Scene& scene, const std::vector<std::string>& lights,
                   const std::vector<std::string>& views) {
  std::vector<std::string> there = names_of(whole_lights(scene.lights));
  for (const Light& light : scene.lights)
    if (channel_of(light.name)) there.push_back(light.name);
  require_words(lights, there, "light", reference);
  require_words(views, names_of(scene.views), "view", reference);
}

}  // namespace gnomon
