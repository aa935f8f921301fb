#include "measure/scene/names.h"

#include <gnomon/param.h>

namespace gnomon {

void require_words(const std::vector<std::string>& wanted, const std::vector<std::string>& there, const char* what,
                   const std::string& reference) {
  for (const std::string& name : wanted)
    if (std::ranges::find(there, name) == there.end())
      throw Error("scene {} has no {} {}; did you mean {}? It has: {}", reference, what, name, nearest_word(name, there),
                  joined(there, ", "));
}

void require_names(const std::string& reference, const Scene& scene, const std::vector<std::string>& lights,
                   const std::vector<std::string>& views) {
  require_words(lights, names_of(scene.lights), "light", reference);
  require_words(views, names_of(scene.views), "view", reference);
}

}  // namespace gnomon
