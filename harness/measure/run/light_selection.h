#pragma once
#include <gnomon/scene.h>

#include <string>
#include <string_view>
#include <vector>

namespace gnomon {

/// The lights of one row.
struct RowLights {
  std::string name;                 ///< as tables write it: "sun", "sun+lamp", "all+"; of the three channels of sun "sun"
  std::vector<std::string> lights;  ///< each once, in the scene's order
  std::size_t count() const { return std::size(lights); }
};

/// More lights in one row would need more memory for masks and references than most machines have.
inline constexpr std::size_t most_lights = 256;

/// Whether a name is like a pattern, in which `*` matches any letters.
bool is_like(std::string_view name, std::string_view pattern);

/// Whether a word is the name of one light, so that a scene without it is an error.
bool is_light_name(std::string_view word);

/// The lights of a scene that `--light` and the `lights` of a suite select:
///   sun         that light
///   *           all lights, a row each; `*hard` those without area, `*soft` those with, `ring_*` those of such names
///   sun+lamp    these lights together, in one row
///   all+        all lights together; `*hard+`, `*soft+`, `ring_*+` those lights together
///   all+4       four of them together, evenly chosen in the scene's order; `ring_*+16` sixteen of those
///   sun.red     one channel of a light, where glass colors it (split_lights); `sun` is its three channels in one row
/// No words select all lights, a row each. The same lights are a row once; one light "together" is that light. `scene_name` is
/// for errors. Throws Error when there is no such light or are not so many, one is named twice in a row, or a row has more than
/// `most_lights`.
std::vector<RowLights> row_lights(const std::vector<std::string>& words, const std::string& scene_name, const Scene& scene);

}  // namespace gnomon
