// Files that the viewer writes. All of a folder appear at once.
#include "app/viewer/saving.h"

#include <gnomon/error.h>
#include <imgui.h>

#include "app/staged_folder.h"
#include "measure/scene/blob.h"

namespace gnomon::viewer {

namespace fs = std::filesystem;
namespace {

Json json_of(const PixelRect& rect) { return {{"x", rect.x}, {"y", rect.y}, {"width", rect.width}, {"height", rect.height}}; }

Json json_of(const ControlPlace& place) {
  const auto whole = [](double value) { return static_cast<int>(std::lround(value)); };
  return {{"x", whole(place.low.x)},
          {"y", whole(place.low.y)},
          {"width", whole(place.high.x) - whole(place.low.x)},
          {"height", whole(place.high.y) - whole(place.low.y)},
          {"visible", place.is_visible}};
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

Json window_json(glm::ivec2 window, double scale, const PixelRect& picture, const ControlPlaces& controls,
                 const Session& session, const EngineState& state) {
  static constexpr const char* phases[] = {"starting", "working", "done", "unsupported", "failed"};
  Json named = Json::object(), sides = Json::object();
  for (const auto& [name, place] : controls) named[name] = json_of(place);
  for (int side = 0; side < 2; ++side)
    sides[side_name(side)] = {{"technique", session.selection().sides[side].technique},
                              {"settings", session.selection().sides[side].settings},
                              {"layer", session.selection().sides[side].layer},
                              {"phase", phases[static_cast<int>(state.sides[side].phase)]},
                              {"words", state.sides[side].words}};
  return {{"window", {{"width", window.x}, {"height", window.y}, {"scale", scale}}},
          {"picture", json_of(picture)},
          {"layout", layout_rows()[static_cast<int>(session.layout)].id},
          {"paint", paint_rows()[static_cast<int>(session.paint)].id},
          {"divider", session.divider},
          {"picked", session.picked() ? Json{session.picked()->x, session.picked()->y} : Json()},
          {"sides", sides},
          {"message", session.message()},
          {"scene_error", state.scene_error},
          {"typing", ImGui::GetIO().WantTextInput},
          {"controls", named}};
}

void write_window(const fs::path& file, const Picture& picture) {
  const app::StagedFolder folder = app::StagedFolder::for_file(file);
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

SavedState SavedFiles::saved_state(const Session& session) const {
  const Selection& selection = session.selection();
  // A scene that could not be loaded is selected, but not shown.
  return {.scene = selection.loaded ? selection.loaded->reference : selection.scene,
          .light = selection.light,
          .view = selection.view,
          .plugins = plugins_,
          .technique = selection.sides[0].technique,
          .settings = selection.sides[0].settings,
          .width = selection.width,
          .height = selection.height,
          .truth = selection.truth};
}

std::string SavedFiles::write_command(const Session& session, const fs::path& staged, const fs::path& folder) {
  const SavedState state = saved_state(session);
  const std::string command = render_command(state, folder / "scene.toml", folder / "render");
  write_file(staged / "scene.toml", state_toml(state, folder / "scene.toml"));
  write_file(staged / "command.txt", command + "\n");
  return command;
}

fs::path SavedFiles::save(const Session& session, const EngineState& state, std::span<const std::uint32_t> rgba,
                          const Picture& window, const Json& places) {
  const Selection& selection = session.selection();
  const SideState& left = state.sides[0];
  std::span<const float> mask;
  if (left.is_reference && state.reference)
    mask = state.reference->mask;
  else if (left.answer)
    mask = left.answer->mask;
  const auto pixels = static_cast<std::size_t>(selection.width) * selection.height;
  if (left.phase != Phase::done || mask.size() != pixels)
    throw Error("the left side, {}, has no mask to save: {}", selection.sides[0].technique,
                left.words.empty() ? "it is not done" : left.words);
  const fs::path folder = next("", "");
  const app::StagedFolder staged = app::StagedFolder::beside(folder);
  write_command(session, staged.path, folder);
  const std::vector<std::string> names = {selection.light.name + ".V"};
  const std::vector<std::span<const float>> channels = {mask};
  write_exr(staged.path / "mask.exr", selection.width, selection.height, names, channels);
  write_png(staged.path / "picture.png", picture_of(rgba, selection.width, selection.height));
  write_png(staged.path / "window.png", window);
  write_file(staged.path / "window.json", json_text(places, 2) + "\n");
  staged.publish();
  return folder;
}

std::string SavedFiles::save_command(const Session& session) {
  const fs::path folder = next("", "");
  const app::StagedFolder staged = app::StagedFolder::beside(folder);
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
