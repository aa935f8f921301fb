#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "app/viewer/panels.h"
#include "app/viewer/saved_state.h"
#include "measure/json.h"
#include "measure/picture/picture.h"

namespace gnomon::viewer {

/// Where the viewer writes: folders OUT/01, OUT/02, ... of what was saved, pictures OUT/window-01.png, ... of the window.
class SavedFiles {
 public:
  SavedFiles(std::filesystem::path out, std::vector<std::string> plugins)
      : out_(std::move(out)), plugins_(std::move(plugins)) {}

  /// The whole state: scene.toml, command.txt, mask.exr, picture.png, window.png, window.json. Needs a finished state. Answers
  /// the folder. Throws Error when it cannot be written.
  std::filesystem::path save(const Session& session, const EngineState& state, std::span<const std::uint32_t> rgba,
                             const Picture& window, const Json& places);
  /// Only scene.toml and command.txt. Answers the command.
  std::string save_command(const Session& session);
  /// The window. Answers the file.
  std::filesystem::path save_window(const Picture& window);

 private:
  SavedState saved_state(const Session& session) const;
  std::filesystem::path next(const std::string& before, const std::string& after) const;
  std::string write_command(const Session& session, const std::filesystem::path& staged, const std::filesystem::path& folder);

  std::filesystem::path out_;
  std::vector<std::string> plugins_;
};

/// What is where in the window and what it says, for window.json: rectangles in framebuffer pixels, the picked pixel, how far
/// each side is, the last message, why the selected scene could not be loaded, whether text is typed into a field.
Json window_json(glm::ivec2 window, double scale, const PixelRect& picture, const ControlPlaces& controls,
                 const Session& session, const EngineState& state);

/// A PNG that appears whole or not at all; its folder is made. Throws Error.
void write_window(const std::filesystem::path& file, const Picture& picture);

}  // namespace gnomon::viewer
