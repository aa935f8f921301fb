#include "measure/run/suite.h"

#include <charconv>

#include "measure/paths.h"
#include "measure/scene/blob.h"
#include "measure/scene/time_reference.h"
#include "measure/scene/toml_table.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// A text or an array of texts; empty without the key.
std::vector<std::string> words(const Table& table, const toml::table& raw, std::string_view key) {
  if (!table.has(key)) return {};
  const toml::array* array = raw.get(key)->as_array();
  if (!array) return {table.text(key)};
  std::vector<std::string> result;
  for (const toml::node& item : *array) {
    const auto word = item.value_exact<std::string>();
    if (!word) table.refuse(key, "a list with something else", "a text or an array of texts");
    result.push_back(*word);
  }
  return result;
}

/// The key `time`: a number of seconds or an array of these; empty without the key.
std::vector<double> read_times(const Table& group, const toml::table& raw) {
  if (!group.has("time")) return {};
  const toml::array* array = raw.get("time")->as_array();
  std::vector<double> times;
  if (!array) times.push_back(group.number("time"));
  for (std::size_t k = 0; array && k < array->size(); ++k) {
    const auto seconds = array->get(k)->is_number() ? array->get(k)->value<double>() : std::nullopt;
    if (!seconds) group.refuse("time", "a list with something else", "a number or an array of numbers");
    times.push_back(*seconds);
  }
  for (const double seconds : times)
    if (!(seconds >= 0 && std::isfinite(seconds))) group.refuse("time", seconds, "seconds, 0 or more");
  if (times.empty()) group.refuse("time", "[]", "a number or an array of numbers");
  return times;
}

/// The keys `frames`, `frame_rate` and `start` of rows that follow animations.
FrameTimes read_frame_times(const Table& group) {
  FrameTimes times;
  for (const char* key : {"frames", "frame_rate", "start"})
    if (group.has(key) && !group.has("animations"))
      throw Error("group.{} is for rows that follow an animation, and group.animations is not there ({})", key,
                  group.where(key));
  if (group.has("frames")) times.frames = group.integer("frames", least_frames, least_frames, most_frames);
  if (group.has("frame_rate")) times.frame_rate = group.number("frame_rate");
  if (times.frame_rate && !(*times.frame_rate > 0)) group.refuse("frame_rate", *times.frame_rate, "frames per second, above 0");
  if (group.has("start")) times.start = group.number("start") + 0.0;  // minus zero is zero
  if (times.start && !(*times.start >= 0)) group.refuse("start", *times.start, "seconds, 0 or more");
  return times;
}

/// The key `animations`: what rows follow frame by frame.
std::vector<std::string> read_animations(const Table& group, const toml::table& raw) {
  std::vector<std::string> animations = words(group, raw, "animations");
  if (group.has("animations") && animations.empty()) group.refuse("animations", "[]", "a name or an array of names");
  for (const std::string& name : animations)
    if (name != every_animation && !is_plain_name(name))
      group.refuse("animations", '\'' + name + '\'', "a name of a..z, 0..9 and _, at most 100 of them, or *");
  if (!animations.empty() && group.has("time"))
    throw Error("group.time is of stills, and group.animations of rows that go on frame by frame: a group has one of both ({})",
                group.where("time"));
  return animations;
}

/// The key `animation`, which belongs to `time`; empty without it.
std::string read_animation(const Table& group) {
  const std::string animation = group.has("animation") ? group.text("animation") : "";
  if (!group.has("animation")) return animation;
  if (animation.empty()) group.refuse("animation", "''", "the name of an animation");
  if (!group.has("time"))
    throw Error(
        "group.animation = {0} is of stills and needs group.time; rows that follow it frame by frame are "
        "group.animations = [\"{0}\"] ({1})",
        animation, group.where("animation"));
  return animation;
}

std::vector<Contender> read_contenders(const Table& group, const toml::table& raw, const fs::path& path) {
  const toml::array* array = group.has("techniques") ? raw.get("techniques")->as_array() : nullptr;
  if (!array || array->empty())
    throw Error("group.techniques is not an array with something in it ({})", group.where("techniques"));
  std::vector<Contender> contenders;
  for (const toml::node& item : *array) {
    std::string use, label;
    if (const toml::table* entry = item.as_table()) {
      const Table table(*entry, path, "technique", {"use", "label"});
      use = table.text("use");
      if (table.has("label")) label = table.text("label");
    } else if (const auto word = item.value_exact<std::string>()) {
      use = *word;
    } else {
      group.refuse("techniques", "a list with something else", "texts or tables { use = ..., label = ... }");
    }
    try {
      for (Contender& c : parse_contenders(use, label)) contenders.push_back(std::move(c));
    } catch (const Error& error) {
      throw Error("{} ({}:{})", error.what(), path.string(), item.source().begin.line);
    }
  }
  return contenders;
}

SuiteGroup read_group(const toml::table& raw, const fs::path& path) {
  const Table reader(raw, path, "group",
                     {"scenes", "animation", "time", "lights", "views", "techniques", "paths", "sizes", "global_samples",
                      "animations", "frames", "frame_rate", "start"});
  const auto list = [&](std::string_view key) { return words(reader, raw, key); };
  SuiteGroup group{{}, list("lights"), list("views"), read_contenders(reader, raw, path), list("paths")};
  group.global_samples = reader.integer("global_samples", 0, least_global_samples, most_global_samples);
  group.animations = read_animations(reader, raw);
  group.times = read_frame_times(reader);
  const std::vector<std::string> scenes = list("scenes"), sizes = list("sizes");
  const std::string animation = read_animation(reader);
  const std::vector<double> times = read_times(reader, raw);
  try {
    for (const std::string& scene : scenes)
      for (std::string& still : at_times(expand_braces(scene), animation, times)) group.scenes.push_back(std::move(still));
    for (const std::string& size : sizes) group.sizes.push_back(parse_size(size, "group.sizes"));
  } catch (const Error& error) {
    throw Error("{} ({})", error.what(), reader.where());
  }
  if (group.scenes.empty()) throw Error("group.scenes is empty ({})", reader.where());
  return group;
}

}  // namespace

std::string file_text(const fs::path& file) {
  const std::shared_ptr<const MappedFile> copy = MappedFile::copy(file);
  return {reinterpret_cast<const char*>(copy->bytes().data()), copy->bytes().size()};
}

std::pair<int, int> parse_size(const std::string& text, const std::string& what) {
  const auto refuse = [&] { throw Error("{} {} is not WxH with W and H of 1 .. 16384 pixels", what, text); };
  int size[2] = {};
  const char *at = text.data(), *end = text.data() + text.size();
  for (int k = 0; k < 2; ++k) {
    const auto [next, code] = std::from_chars(at, end, size[k]);
    if (code != std::errc{} || size[k] < 1 || size[k] > 16384) refuse();
    at = next;
    if (k == 0 && (at == end || *at++ != 'x')) refuse();
  }
  if (at != end) refuse();
  return {size[0], size[1]};
}

std::vector<std::string> suite_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(data_root() / "bench/suites"))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem());
  std::ranges::sort(names);
  return names;
}

Suite read_suite(const std::string& name_or_path) {
  fs::path path = name_or_path;
  if (path.extension() != ".toml") {
    const std::vector<std::string> names = suite_names();
    if (std::find(names.begin(), names.end(), name_or_path) == names.end())
      throw Error("there is no suite {}; did you mean {}? There are: {}", name_or_path, nearest_word(name_or_path, names),
                  joined(names, ", "));
    path = data_root() / "bench/suites" / (name_or_path + ".toml");
  }
  const toml::table table = read_toml("suite " + path.string(), path);
  const Table top(table, path, "suite",
                  {"title", "width", "height", "truth", "truth_over", "processes", "repetitions", "warmups", "timeout",
                   "interval", "budget", "reference_error", "reference_rays", "group"},
                  table.contains(edition_tables.front()) ? std::vector(edition_tables.begin(), edition_tables.end())
                                                         : std::vector<std::string_view>());
  Suite suite;
  suite.name = path.stem();
  suite.text = file_text(path);
  if (top.has("title")) suite.title = top.text("title");
  suite.width = top.integer("width", suite.width, 1, 16384);
  suite.height = top.integer("height", suite.height, 1, 16384);
  if (top.has("truth")) {
    if (top.text("truth") != "shape" && top.text("truth") != "mesh") top.refuse("truth", top.text("truth"), "shape or mesh");
    suite.truth = top.text("truth") == "mesh" ? Truth::mesh : Truth::shape;
  }
  if (top.has("truth_over")) {
    const auto found = std::ranges::find(truth_over_names, top.text("truth_over"));
    if (found == std::end(truth_over_names)) top.refuse("truth_over", top.text("truth_over"), "center, pixel or both");
    suite.truth_over = static_cast<TruthOver>(found - std::begin(truth_over_names));
  }
  suite.processes = top.integer("processes", suite.processes, 1, 1000);
  suite.repetitions = top.integer("repetitions", suite.repetitions, 1, 1000);
  suite.warmups = top.integer("warmups", suite.warmups, 1, 100);
  if (top.has("timeout")) suite.timeout = top.positive("timeout");
  if (top.has("interval")) suite.interval = top.positive("interval");
  if (top.has("budget")) suite.budget = top.positive("budget");
  if (top.has("budget") && !top.has("interval"))
    throw Error("suite.budget = {} is for the processes that suite.interval asks for, which is not there ({})", suite.budget,
                top.where("budget"));
  suite.target.error = top.number("reference_error", suite.target.error);
  if (!(suite.target.error >= 1e-5 && suite.target.error <= 0.1))
    top.refuse("reference_error", suite.target.error, "a standard error of 0.00001 .. 0.1");
  suite.target.cap = static_cast<std::uint32_t>(top.integer("reference_rays", static_cast<int>(suite.target.cap), 64, 1 << 24));
  for (const toml::table* raw : top.tables("group")) suite.groups.push_back(read_group(*raw, path));
  if (suite.groups.empty()) throw Error("suite {} has no [[group]]", path.string());
  return suite;
}

}  // namespace gnomon
