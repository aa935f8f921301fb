// Files that the viewer writes. All of a folder appear at once.
#include "app/viewer/saving.h"

#include <gnomon/error.h>
#include <imgui.h>

#include <cassert>
#include <charconv>
#include <cmath>

#include "app/staged_folder.h"
#include "measure/scene/blob.h"
#include "measure/scene/load.h"
#include "measure/scene/time_reference.h"

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
  std::string result = json_text(Json(text));  // replaces what is no UTF-8
  if (plain_text(parse_json(result)) != text) throw Error("'{}' is not UTF-8 and cannot be named in a scene description", text);
  for (std::size_t at; (at = result.find('\x7f')) != std::string::npos;) result.replace(at, 1, "\\u007F");
  return result;
}

/// The scene as a description in `file` names it. Links are followed in the folders between, so that `..` leads to the parent;
/// the scene's own name stays, for a description finds its meshes beside the name that it is opened by.
std::string base_reference(const std::string& reference, const fs::path& file) {
  if (!names_file(reference)) return reference;
  const std::string scene = without_time(reference), time = reference.substr(scene.size());
  const fs::path from = fs::absolute(file).parent_path(), base = fs::absolute(scene);
  const std::string name = (fs::relative(base.parent_path(), from) / base.filename()).string() + time;
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
std::string emits_toml(Emits emits) { return emits == Emits::in_front ? line("one_sided", std::string("true")) : ""; }
std::string kind_toml(const RectLight& l) {
  return line("center", l.center) + line("half_u", l.half_u) + line("half_v", l.half_v) + emits_toml(l.emits);
}
std::string kind_toml(const DiscLight& l) {
  return line("center", l.center) + line("normal", l.normal) + line("radius", l.radius) + emits_toml(l.emits);
}
std::string kind_toml(const SphereLight& l) { return line("center", l.center) + line("radius", l.radius); }

std::string light_toml(const Light& light) {
  return "[[light]]\n" + line("name", quoted(light.name)) + line("kind", quoted(std::string(kind_name(light)))) +
         std::visit([](const auto& kind) { return kind_toml(kind); }, light.kind) + line("intensity", light.intensity);
}

std::string view_toml(const View& view) {
  return "[[view]]\n" + line("name", quoted(view.name)) + line("eye", view.eye) + line("target", view.target) +
         line("up", view.up) + line("fov_y_degrees", view.fov_y_degrees) +
         (view.exposure > 0 ? line("exposure", view.exposure) : "");
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

Json json_of(const PixelRect& rect) { return {{"x", rect.x}, {"y", rect.y}, {"width", rect.width}, {"height", rect.height}}; }

/// What is where in the window, and its texts: rectangles in framebuffer pixels, the picked pixel, how far each side is, the
/// last message, why the selected scene could not be loaded, whether text is typed into a field.
Json window_json(const DrawnWindow& window, const Session& session, const EngineState& state) {
  Json json;
  json["window"] = {{"width", window.pixels.width}, {"height", window.pixels.height}, {"scale", window.scale}};
  json["picture"] = json_of(window.picture);
  json["layout"] = layout_rows[static_cast<int>(session.layout)].id;
  json["paint"] = paint_rows[static_cast<int>(session.paint)].id;
  json["divider"] = session.divider;
  json["difference"]["against"] = against_rows[static_cast<int>(session.difference.against)].id;
  json["difference"]["full_scale"] = session.difference.full;
  json["difference"]["plain"] = session.difference.is_plain;
  json["contours"] = session.shows_contours;
  json["light"] = session.selection().light.name;
  json["together"] = Json::array();
  for (const Light& light : session.selection().together) json["together"].push_back(light.name);
  json["animation"] = nullptr;
  if (const auto& at = session.selection().at)
    json["animation"] = {{"name", at->animation},
                         {"seconds", at->seconds},
                         {"frame", session.player().frame()},
                         {"frames", session.player().last_frame() + 1},
                         {"playing", session.player().is_playing()}};
  json["profile"] = nullptr;
  if (const auto& line = session.profile) json["profile"] = {line->from.x, line->from.y, line->to.x, line->to.y};
  json["curve"] = nullptr;
  if (const auto& curve = state.curve)
    json["curve"] = {{"samples", curve->samples},
                     {"error", curve->error},
                     {"error_floor", curve->error_floor},
                     {"complete", curve->is_complete},
                     {"why_not", curve->why_not}};
  json["picked"] = nullptr;
  if (session.picked()) json["picked"] = {session.picked()->x, session.picked()->y};
  for (int side = 0; side < 2; ++side) {
    const SideSelection& selection = session.selection().sides[side];
    Json& row = json["sides"][side_name(side)];
    row["technique"] = selection.technique;
    row["settings"] = selection.settings;
    row["layer"] = selection.layer;
    row["phase"] = phase_names[static_cast<int>(state.sides[side].phase)];
    row["words"] = state.sides[side].words;
  }
  json["parameter"] = session.chosen_parameter();
  json["message"] = session.message();
  json["scene_error"] = state.scene_error;
  json["typing"] = ImGui::GetIO().WantTextInput;
  json["controls"] = Json::object();
  for (const auto& [name, place] : window.controls) {
    const glm::ivec2 low = glm::round(place.low), high = glm::round(place.high);
    json["controls"][name] = json_of(PixelRect{low.x, low.y, high.x - low.x, high.y - low.y});
    json["controls"][name]["visible"] = place.is_visible;
  }
  return json;
}

/// The masks of a side under each light; none where it has no answer.
std::vector<std::span<const float>> masks_of(const SideState& side, const ReferenceState* reference) {
  std::vector<std::span<const float>> masks;
  if (side.is_reference && reference) {
    for (const auto& light : reference->lights) masks.push_back(light->mask);
    if (!reference->frame->is_together()) masks.push_back(reference->mask);
  } else if (side.answer) {
    for (std::size_t k = 0; k < side.answer->frame->all_lights().size(); ++k) masks.push_back(side.answer->mask_under(k));
  }
  return masks;
}

Picture picture_of(std::span<const std::uint32_t> rgba, int width, int height) {
  Picture picture{width, height, {}};
  picture.rgb.reserve(rgba.size() * 3);
  for (const std::uint32_t& pixel : rgba) {
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(&pixel);
    picture.rgb.insert(picture.rgb.end(), bytes, bytes + 3);
  }
  return picture;
}

}  // namespace

std::string state_toml(const Selection& shown, const fs::path& file) {
  // A scene that could not be loaded is selected, but not shown.
  std::string reference = shown.loaded ? shown.loaded->reference : shown.scene;
  if (shown.at) reference = with_time(reference, {shown.at->animation, shown.at->seconds});
  const std::string base = quoted(base_reference(reference, file));
  // A file has no channels: its glass makes them again.
  const std::vector<Light> lights = whole_lights(lights_of(shown));
  std::string names, tables;
  for (const Light& light : lights) {
    names += fmt::format("{}'{}'", names.empty() ? "" : ", ", light.name);
    tables += light_toml(light) + "\n";
  }
  return fmt::format("# Saved state: {} under {} {}, seen from view '{}'.\nscene = {}\n\n{}{}", base,
                     lights.size() == 1 ? "light" : "lights", names, shown.view.name, base, tables, view_toml(shown.view));
}

std::string render_command(const Selection& shown, std::span<const std::string> plugins, const fs::path& scene_file,
                           const fs::path& out) {
  // The saved scene has the lights that are shown; of one that has channels all of these.
  const std::size_t whole = whole_lights(shown.together).size(), channels = std::size(all_channels) * whole;
  const std::size_t saved_count = channel_of(shown.light.name) ? channels : whole;
  std::vector<std::string> words = {"gnomon"};
  for (const std::string& plugin : plugins) words.insert(words.end(), {load_option(plugin), path_word(plugin)});
  words.insert(words.end(), {"render", "--scene", path_word(scene_file.string()), "--technique", written(shown.sides[0]),
                             "--light", shown.together.empty() ? shown.light.name : together_word(shown, saved_count), "--view",
                             shown.view.name, "--size", fmt::format("{}x{}", shown.width, shown.height)});
  if (shown.truth != Truth::shape) words.insert(words.end(), {"--truth", std::string(name(shown.truth))});
  words.insert(words.end(), {"--out", path_word(out.string())});
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + shell_word(word);
  return line;
}

void write_window(const fs::path& file, const Picture& picture) {
  const app::StagedFolder folder(file, app::StagedFolder::Target::file);
  write_png(folder.path / file.filename(), picture);
  folder.publish();
}

/// The first OUT/BEFOREnnAFTER that is not there yet.
fs::path SavedFiles::next(const std::string& before, const std::string& after) const {
  for (int number = 1;; ++number) {
    const fs::path path = out_ / fmt::format("{}{:02}{}", before, number, after);
    std::error_code ignored;
    if (!fs::exists(fs::symlink_status(path, ignored))) return path;
  }
}

std::string SavedFiles::write_command(const Session& session, const fs::path& staged, const fs::path& folder) {
  const fs::path scene_file = folder / "scene.toml";
  const std::string command = render_command(session.selection(), plugins_, scene_file, folder / "render");
  write_file(staged / "scene.toml", state_toml(session.selection(), scene_file));
  write_file(staged / "command.txt", command + "\n");
  return command;
}

fs::path SavedFiles::save(const Session& session, const EngineState& state, const Composition& composition,
                          std::span<const std::uint32_t> rgba, const DrawnWindow& window) {
  const Selection& selection = session.selection();
  const SideState& left = state.sides[0];
  std::vector<std::string> names;
  for (const Light& light : lights_of(selection)) names.push_back(light.name + ".V");
  const std::vector<std::span<const float>> masks = masks_of(left, state.reference.get());
  const auto pixels = static_cast<std::size_t>(selection.width) * selection.height;
  if (left.phase != Phase::done || masks.size() != names.size() || masks[0].size() != pixels)
    throw Error("the left side, {}, has no mask to save: {}", selection.sides[0].technique,
                left.words.empty() ? "it is not done" : left.words);
  const fs::path folder = next("", "");
  const app::StagedFolder staged(folder);
  write_command(session, staged.path, folder);
  write_exr(staged.path / "mask.exr", selection.width, selection.height, names, masks);
  write_png(staged.path / "picture.png", picture_of(rgba, selection.width, selection.height));
  write_png(staged.path / "window.png", window.pixels);
  write_file(staged.path / "window.json", json_text(window_json(window, session, state), 2) + "\n");
  if (session.profile) write_file(staged.path / "profile.csv", profile_csv(profile_along(composition, *session.profile)));
  staged.publish();
  return folder;
}

std::string SavedFiles::save_command(const Session& session) {
  const fs::path folder = next("", "");
  const app::StagedFolder staged(folder);
  const std::string command = write_command(session, staged.path, folder);
  staged.publish();
  return command;
}

fs::path SavedFiles::save_window(const Picture& window) {
  const fs::path file = next("window-", ".png");
  write_window(file, window);
  return file;
}

}  // namespace gnomon::viewer
