#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "app/viewer/panels.h"
#include "measure/picture/picture.h"

namespace gnomon::viewer {

/// A scene TOML: the geometry of the scene that it names, and these lights and this view alone. Reading it gives the very
/// floats. `file` is where it will be: a scene that is a file is named relative to its folder, which need not be there yet.
/// Throws Error when that name is not UTF-8, as TOML must be.
std::string state_toml(const Selection& shown, const std::filesystem::path& file);

/// One line for a POSIX shell that renders the left side of `scene_file`, where the selection was saved, into `out`; no newline
/// at its end unless a name has one. Paths and plugins are as given, relative ones for the folder in which the line will be
/// used.
std::string render_command(const Selection& shown, std::span<const std::string> plugins,
                           const std::filesystem::path& scene_file, const std::filesystem::path& out);

/// The window as it was drawn.
struct DrawnWindow {
  Picture pixels;
  double scale = 1;
  PixelRect picture;  ///< where the picture is
  const ControlPlaces& controls;
};

/// Where the viewer writes: folders OUT/01, OUT/02, ... of what was saved, pictures OUT/window-01.png, ... of the window.
class SavedFiles {
 public:
  SavedFiles(std::filesystem::path out, std::vector<std::string> plugins)
      : out_(std::move(out)), plugins_(std::move(plugins)) {}

  /// The whole state: scene.toml, command.txt, mask.exr, picture.png, window.png, window.json, with a profile profile.csv.
  /// Needs a finished state. Returns the folder. Throws Error when it cannot be written.
  std::filesystem::path save(const Session& session, const EngineState& state, const Composition& composition,
                             std::span<const std::uint32_t> rgba, const DrawnWindow& window);
  /// Only scene.toml and command.txt. Returns the command.
  std::string save_command(const Session& session);
  /// The window. Returns the file.
  std::filesystem::path save_window(const Picture& window);

 private:
  std::filesystem::path next(const std::string& before, const std::string& after) const;
  std::string write_command(const Session& session, const std::filesystem::path& staged, const std::filesystem::path& folder);

  std::filesystem::path out_;
  std::vector<std::string> plugins_;
};

/// A PNG that appears whole or not at all; its folder is made. Throws Error.
void write_window(const std::filesystem::path& file, const Picture& picture);

}  // namespace gnomon::viewer
