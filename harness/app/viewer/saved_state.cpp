#include "app/viewer/saved_state.h"

#include <gnomon/error.h>

#include <cassert>
#include <charconv>
#include <cmath>

#include "measure/json.h"
#include "measure/scene/load.h"

namespace gnomon::viewer {

namespace fs = std::filesystem;

namespace {

bool reads_back(const std::string& text, float value) {
  double read = 0;
  std::from_chars(text.data(), text.data() + text.size(), read);
  return static_cast<float>(read) == value;
}

/// The fewest digits that read back as this float. The reader rounds to double first, so that for a few floats the shortest
/// text lands between two of them and falls to the wrong side: 7.038531e-26 is one.
std::string number(float value) {
  if (value == 0) return std::signbit(value) ? "-0.0" : "0";  // TOML's -0 is a whole number, which has no sign
  assert(std::isfinite(value));
  std::string text = fmt::format("{}", value);
  for (int digits = 7; digits <= 17 && !reads_back(text, value); ++digits) text = fmt::format("{:.{}g}", value, digits);
  return text;
}

std::string vector(const glm::vec3& v) { return fmt::format("[{}, {}, {}]", number(v.x), number(v.y), number(v.z)); }

/// A TOML string. Its escapes are those of JSON, and DEL.
std::string quoted(const std::string& text) {
  std::string result;
  try {
    result = nlohmann::json(text).dump();
  } catch (const nlohmann::json::type_error&) {
    throw Error("'{}' is not UTF-8 and cannot be named in a scene description", text);
  }
  for (std::size_t at; (at = result.find('\x7f')) != std::string::npos;) result.replace(at, 1, "\\u007F");
  return result;
}

/// The scene as a description in `file` names it. Of the folders between, links are followed, so that `..` leads where it says;
/// the scene's own name stays, for a description finds its meshes beside the name that it is opened by.
std::string base_reference(const std::string& scene, const fs::path& file) {
  if (!names_file(scene)) return scene;
  const fs::path from = fs::absolute(file).parent_path(), base = fs::absolute(scene);
  const std::string name = fs::relative(base.parent_path(), from) / base.filename();
  return name.starts_with('.') ? name : "./" + name;
}

std::string line(std::string_view key, const std::string& value) { return fmt::format("{} = {}\n", key, value); }
std::string line(std::string_view key, float value) { return line(key, number(value)); }
std::string line(std::string_view key, const glm::vec3& value) { return line(key, vector(value)); }

std::string kind_toml(const PointLight& l) { return line("position", l.position); }
std::string kind_toml(const SpotLight& l) {
  return line("position", l.position) + line("direction", l.direction) + line("inner_degrees", l.inner_degrees) +
         line("outer_degrees", l.outer_degrees);
}
std::string kind_toml(const DirectionalLight& l) { return line("direction", l.direction); }
std::string kind_toml(const RectLight& l) {
  return line("center", l.center) + line("half_u", l.half_u) + line("half_v", l.half_v);
}
std::string kind_toml(const DiscLight& l) {
  return line("center", l.center) + line("normal", l.normal) + line("radius", l.radius);
}
std::string kind_toml(const SphereLight& l) { return line("center", l.center) + line("radius", l.radius); }

std::string light_toml(const Light& light) {
  return "[[light]]\n" + line("name", quoted(light.name)) + line("kind", quoted(std::string(kind_name(light)))) +
         std::visit([](const auto& kind) { return kind_toml(kind); }, light.kind) + line("intensity", light.intensity);
}

std::string view_toml(const View& view) {
  return "[[view]]\n" + line("name", quoted(view.name)) + line("eye", view.eye) + line("target", view.target) +
         line("up", view.up) + line("fov_y_degrees", view.fov_y_degrees);
}

/// The word as a POSIX shell reads it back; plain where nothing in it means anything to a shell.
std::string shell_word(const std::string& word) {
  constexpr std::string_view plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_@%+=:,./-";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string result = "'";
  for (const char c : word) c == '\'' ? result += "'\\''" : result += c;
  return result + "'";
}

/// A path that is no option, whatever it begins with.
std::string path_word(const std::string& path) { return path.starts_with('-') ? "./" + path : path; }

}  // namespace

std::string state_toml(const SavedState& state, const fs::path& file) {
  const std::string base = quoted(base_reference(state.scene, file));
  return fmt::format("# Saved state: {} under light '{}', seen from view '{}'.\nscene = {}\n\n{}\n{}", base, state.light.name,
                     state.view.name, base, light_toml(state.light), view_toml(state.view));
}

std::string render_command(const SavedState& state, const fs::path& scene_file, const fs::path& out) {
  std::vector<std::string> words = {"gnomon"};
  for (const std::string& plugin : state.plugins) words.insert(words.end(), {"--plugin", path_word(plugin)});
  words.insert(words.end(),
               {"render", "--scene", path_word(scene_file.string()), "--technique",
                state.technique + (state.settings.empty() ? "" : ":" + state.settings), "--light", state.light.name, "--view",
                state.view.name, "--size", fmt::format("{}x{}", state.width, state.height)});
  if (state.truth != Truth::shape) words.insert(words.end(), {"--truth", std::string(name(state.truth))});
  words.insert(words.end(), {"--out", path_word(out.string())});
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + shell_word(word);
  return line;
}

}  // namespace gnomon::viewer
