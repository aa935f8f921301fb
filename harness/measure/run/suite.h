#pragma once
#include <gnomon/kit/area/area_rays.h>
#include <gnomon/scene.h>

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "measure/scene/posed_scene.h"
#include "measure/truth_over.h"

namespace gnomon {

/// One technique with its settings, as a suite or the command line names it.
struct Contender {
  std::string technique;          ///< id
  std::string settings;           ///< canonical "a=1,b=2" of what differs from the defaults
  std::string label;              ///< short name for tables; may be empty
  bool is_from_wildcard = false;  ///< named by `*`: it is left out where it supports nothing
  std::string name() const { return settings.empty() ? technique : technique + ":" + settings; }
};

/// The bytes of a file.
std::string file_text(const std::filesystem::path& file);

/// "640x360" into width and height of 1 .. 16384 pixels. Throws Error that starts with `what`.
std::pair<int, int> parse_size(const std::string& text, const std::string& what);

/// A text at its commas outside of braces: "a=1,b={2,3}" has two parts. One part where it has no such comma.
std::vector<std::string> parts_outside_braces(std::string_view text);
/// `a{b,c}d` gives `abd` and `acd`; two braces give their product. Throws Error on a brace without its partner.
std::vector<std::string> expand_braces(const std::string& text);
/// Reads `id:param=value,...`; a comma list in braces is a sweep: `shadow_map:resolution={256,1024}` gives two contenders,
/// two braces their product; `*` alone is every registered technique. A row of a sweep that has the default of the swept
/// parameter gets a label with that value. Throws Error on unknown techniques and parameters and on values out of range.
/// Throws Error where a text names several techniques, as "svbsp,shadow_map:filter=pcf" does.
void refuse_several_techniques(const std::string& text);
std::vector<Contender> parse_contenders(const std::string& text, const std::string& label = "");

/// Which frames of an animation a row has. Nothing: as find_path has them; at another rate or start as many as reach the last
/// key.
struct FrameTimes {
  std::optional<int> frames = {};                     ///< least_frames .. most_frames
  std::optional<double> frame_rate = {}, start = {};  ///< frames per second, above 0; seconds at the first frame, 0 or more
  bool operator==(const FrameTimes&) const = default;
};
/// Of a row that follows an animation.
inline constexpr int least_frames = 2, most_frames = most_motion_frames;
/// In place of a name: each animation of the scene.
inline constexpr std::string_view every_animation = "*";

/// Rows that share scenes, lights, views and contenders: their cross product.
struct SuiteGroup {
  std::vector<std::string> scenes;  ///< references, with the time of a still where the group has times
  std::vector<std::string> lights;  ///< names, or `*soft` and `*hard`: with area, without; empty: all of each scene
  std::vector<std::string> views;   ///< names, or patterns with `*`; empty: the first view of each scene
  std::vector<Contender> contenders;
  std::vector<std::string> paths = {};          ///< names, see motion.h; empty: nothing moves
  std::vector<std::pair<int, int>> sizes = {};  ///< width and height in pixels; empty: the suite's
  /// Animations by name, or `*` for each of the scene, followed frame by frame: rows beside those of `paths`.
  std::vector<std::string> animations = {};
  FrameTimes times = {};  ///< of these rows
  /// Light paths of a pixel of the reference that global pictures are compared with; 0: they are not.
  int global_samples = 0;
};

/// What to run and how often; data, not code. docs/suites.md describes the file.
struct Suite {
  std::string name, title;
  std::string text;  ///< of its file; empty where it was none
  int width = 640, height = 360;
  Truth truth = Truth::shape;
  TruthOver truth_over = TruthOver::center;
  int processes = 5;    ///< fresh worker processes per contender: the unit of statistics
  int repetitions = 3;  ///< timed repetitions of each stage in each process
  int warmups = 3;
  double timeout = 60;  ///< seconds that one step of a worker may take
  /// After `processes`, rows whose 95 % interval of relight, of resolve or of update is wider than this share of the time get
  /// more processes; 0: none do.
  double interval = 0;
  double budget = 600;     ///< seconds that those further processes may take in all
  AreaTarget target = {};  ///< of the reference under lights with area
  enum class Pictures { all, masks, none };
  Pictures pictures = Pictures::all;  ///< what rows leave: a mask, an error picture and a shaded picture; the mask; nothing
  std::vector<SuiteGroup> groups;
};

/// What SuiteGroup::global_samples may be, where it is not 0.
inline constexpr int least_global_samples = 16, most_global_samples = 16384;

/// Tables that the file of an edition has beside those of a suite. One with the first of them is read as a suite without them.
inline constexpr std::array<std::string_view, 4> edition_tables{"edition", "metrics", "scenes", "techniques"};

/// Suite by name (bench/suites/NAME.toml) or by path ending in .toml. Throws Error with file and line.
Suite read_suite(const std::string& name_or_path);
std::vector<std::string> suite_names();

}  // namespace gnomon
