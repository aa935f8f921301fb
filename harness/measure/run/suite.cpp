#include "measure/run/suite.h"

#include <gnomon/registry.h>

#include <charconv>
#include <unordered_map>

#include "measure/paths.h"
#include "measure/scene/blob.h"
#include "measure/scene/time_reference.h"
#include "measure/scene/toml_table.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

constexpr double most_texts = 100'000;  // of one text with braces
constexpr std::size_t most_characters = 2'000;

/// `a{b,c}d` gives `abd` and `acd`; two braces give their product. Throws Error on a brace without its partner.
std::vector<std::string> expand_braces(const std::string& text) {
  double count = 1, in_brace = 1;
  for (const char c : text) {
    if (c == '{') in_brace = 1;
    if (c == ',') ++in_brace;
    if (c == '}') count *= in_brace;
  }
  if (count > most_texts) throw Error("'{}' stands for {:.0f} settings; at most {:.0f} are made", text, count, most_texts);
  if (text.size() > most_characters)
    throw Error("'{}' has {} characters; at most {} are taken", text, text.size(), most_characters);
  std::vector<std::string> out = {""};
  const auto multiply = [&](std::string_view items) {
    std::vector<std::string> product;
    for (const std::string& begin : out)
      for (std::size_t at = 0, end = 0; end != items.npos; at = end + 1) {
        end = items.find(',', at);
        product.emplace_back(begin).append(items.substr(at, end - at));
      }
    out = std::move(product);
  };
  for (std::size_t at = 0, open = 0; open != text.npos;) {
    open = text.find_first_of("{}", at);
    for (std::string& one : out) one.append(text, at, open - at);
    if (open == text.npos) break;
    if (text[open] == '}') throw Error("'{}' closes a brace that it does not open", text);
    const std::size_t close = text.find_first_of("{}", open + 1);
    if (close == text.npos || text[close] == '{') throw Error("'{}' opens a brace that it does not close", text);
    multiply(std::string_view(text).substr(open + 1, close - open - 1));
    at = close + 1;
  }
  return out;
}

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

/// Labels those rows of a sweep whose `name()` leaves out a swept parameter, because its value is the default:
/// "shadow_map:resolution=1024" beside "shadow_map:resolution=256". They are the same jobs as without the label. A sweep has up
/// to 100,000 rows: of each it keeps the values, not the technique.
class SweepNames {
 public:
  /// The next row.
  void add(const Technique& technique) {
    rows_.push_back(values_.size());
    for (const Parameter* const parameter : technique.parameters()) {
      Value& value = values_.emplace_back(Value{nullptr, parameter->text(), false});
      const auto [entry, is_first] = swept_.try_emplace(key_of(technique, *parameter));
      Swept& swept = entry->second;
      if (is_first) swept = {std::string(parameter->name()), value.text, false};
      swept.varies |= swept.first != value.text;
      value.of = &swept;
      value.is_default = value.text == parameter->default_text();
    }
  }
  void label(std::vector<Contender>& contenders) const {
    for (std::size_t k = 0; k < contenders.size(); ++k) {
      std::vector<std::string> shown;
      for (std::size_t v = rows_[k], end = k + 1 < rows_.size() ? rows_[k + 1] : values_.size(); v < end; ++v)
        if (const Value& value = values_[v]; value.of->varies || !value.is_default)
          shown.push_back(fmt::format("{}={}", value.of->name, value.text));
      const std::string name = contenders[k].technique + (shown.empty() ? "" : ":") + joined(shown, ",");
      if (name != contenders[k].name()) contenders[k].label = name;
    }
  }

 private:
  struct Swept {
    std::string name, first;  ///< the value in the first row
    bool varies = false;      ///< another row has another
  };
  struct Value {
    const Swept* of;
    std::string text;
    bool is_default;
  };
  /// Of rows of one technique, and of one object within it: `of.count` of one `of` is not that of another.
  static std::string key_of(const Technique& technique, const Parameter& parameter) {
    const std::size_t dot = parameter.name().rfind('.');
    const std::string owner(dot == std::string_view::npos ? "" : technique.parameter(parameter.name().substr(0, dot)).text());
    return std::string(technique.id()).append(" ").append(parameter.name()).append(" ").append(owner);
  }

  std::unordered_map<std::string, Swept> swept_;
  std::vector<Value> values_;      ///< of all parameters of all rows
  std::vector<std::size_t> rows_;  ///< where each begins
};

/// The techniques that a text names side by side: "a:b=1,c" names "a:b=1" and "c". One where it is as it should be.
std::vector<std::string> techniques_in(const std::string& text) {
  std::vector<std::string> parts(1);
  int depth = 0;  // commas within braces are of a sweep
  for (const char c : text) {
    depth += (c == '{') - (c == '}');
    if (c == ',' && depth == 0)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  std::vector<std::string> techniques;
  for (const std::string& part : parts) {
    const std::string id = part.substr(0, part.find_first_of(":="));
    const bool is_setting = id.empty() || (id.size() < part.size() && part[id.size()] == '=');
    const auto is_technique = [&] { return registry().find_technique(id) || techniques.back().find(':') == std::string::npos; };
    if (techniques.empty() || (!is_setting && is_technique()))
      techniques.push_back(part);
    else
      techniques.back() += ',' + part;
  }
  return techniques;
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

std::vector<Contender> parse_contenders(const std::string& text, const std::string& label) {
  if (text == "*") {
    if (!label.empty()) throw Error("label {} would name every technique", label);
    std::vector<Contender> all;
    for (const TechniqueEntry& entry : registry().techniques())
      if (!entry.about.named_only) all.push_back({entry.id, "", "", true});
    return all;
  }
  if (const std::vector<std::string> several = techniques_in(text); several.size() > 1)
    throw Error("'{}' names {} techniques; where several are taken, the option is repeated: --technique {}", text,
                several.size(), joined(several, " --technique "));
  const std::vector<std::string> plain = expand_braces(text);
  if (plain.size() > 1 && !label.empty()) throw Error("label {} would name {} rows of the sweep {}", label, plain.size(), text);
  std::vector<Contender> contenders;
  SweepNames names;
  for (const std::string& one : plain) {
    const std::size_t colon = one.find(':');
    const std::string id = one.substr(0, colon);
    const std::unique_ptr<Technique> technique = registry().technique(id).make();
    if (colon != std::string::npos) technique->apply(one.substr(colon + 1));
    contenders.push_back({id, technique->settings(), label, false});
    names.add(*technique);
  }
  names.label(contenders);
  return contenders;
}

std::vector<std::string> suite_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(data_root() / "bench/suites"))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
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
                   "interval", "budget", "reference_error", "reference_rays", "group"});
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
