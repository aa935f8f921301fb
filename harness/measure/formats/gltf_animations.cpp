// Source: Khronos, glTF 2.0 specification (ISO/IEC 12113:2022), 3.11.
#include "measure/formats/gltf_animations.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "measure/formats/gltf_deform.h"

namespace gnomon::importing {
namespace {

template <class Value>
struct Word {
  std::string_view name;
  Value value;
};
constexpr Word<Track::Property> paths[] = {{"translation", Track::Property::translation},
                                           {"rotation", Track::Property::rotation},
                                           {"scale", Track::Property::scale},
                                           {"weights", Track::Property::weights}};
constexpr Word<Track::Interpolation> interpolations[] = {{"LINEAR", Track::Interpolation::linear},
                                                         {"STEP", Track::Interpolation::step},
                                                         {"CUBICSPLINE", Track::Interpolation::cubic}};

/// The value of a word that must be one of a table. `where` opens the error: "FILE: animation 0, channel 2: path".
template <class Value, std::size_t N>
Value value_of(const Word<Value> (&table)[N], const std::string& where, const std::string& word) {
  const auto found = std::ranges::find(table, word, &Word<Value>::name);
  if (found != std::end(table)) return found->value;
  std::vector<std::string> allowed;
  for (const Word<Value>& entry : table) allowed.emplace_back(entry.name);
  throw Error("{} = '{:.60}' is none of {}", where, word, joined(allowed));
}

class AnimationReader {
 public:
  explicit AnimationReader(const GltfFile& file) : file_(file) {}

  GltfAnimations read() {
    for (std::size_t a = 0; a < file_.count("animations"); ++a) {
      const Json& json = file_.item("animations", a);
      GltfAnimations::Item& item = answer_.items.emplace_back();
      item.animation.name = file_.text(json, "name");
      moved_.clear();
      const Json* channels = list_in(json, "channels");
      if (json.contains("channels") && !channels) throw Error("{}: animation {}: its channels are no list", file_.name(), a);
      for (std::size_t c = 0; channels && c < channels->size(); ++c)
        add_channel(json, channels->at(c), fmt::format("animation {}, channel {}", a, c), item);
    }
    return std::move(answer_);
  }

 private:
  void add_channel(const Json& animation, const Json& channel, const std::string& where, GltfAnimations::Item& item) {
    const Json* target = channel.is_object() ? object_in(channel, "target") : nullptr;
    if (!target) throw Error("{}: {} has no target", file_.name(), where);
    const std::string path = target->contains("path") ? plain_text(target->at("path")) : "";
    if (path == "pointer" || file_.extension_of(*target, "KHR_animation_pointer")) return void(++answer_.pointers);
    const auto node = file_.index(*target, where, "node");
    if (!node) return void(++answer_.without_node);
    Track track;
    track.property = value_of(paths, fmt::format("{}: {}: path", file_.name(), where), path);
    if (*node >= file_.count("nodes"))
      throw Error("{}: {} names node {} of {}", file_.name(), where, *node, file_.count("nodes"));
    track.node = static_cast<std::uint32_t>(*node);
    const Json& owner = file_.item("nodes", *node);
    if (track.property != Track::Property::weights && owner.contains("matrix"))
      throw Error("{}: {} moves node {}, which has a matrix; nodes with translation, rotation and scale are moved",
                  file_.name(), where, *node);
    if (!moved_.emplace(*node, track.property).second)
      throw Error("{}: {} moves the {} of node {}, as a channel before it does; one for each property is allowed", file_.name(),
                  where, path, *node);
    const std::size_t width = track.property == Track::Property::rotation  ? 4
                              : track.property == Track::Property::weights ? morph_target_count(file_, owner, where)
                                                                           : 3;
    if (width == 0) return void(++item.without_target);
    read_sampler(sampler(animation, channel, where), where, width, track);
    item.animation.tracks.push_back(std::move(track));
  }

  const Json& sampler(const Json& animation, const Json& channel, const std::string& where) const {
    const auto index = file_.index(channel, where, "sampler");
    if (!index) throw Error("{}: {} has no sampler", file_.name(), where);
    const Json* samplers = list_in(animation, "samplers");
    const std::size_t count = samplers ? samplers->size() : 0;
    if (*index >= count) throw Error("{}: {} names sampler {} of {}", file_.name(), where, *index, count);
    if (!samplers->at(*index).is_object()) throw Error("{}: {}: sampler {} is no object", file_.name(), where, *index);
    return samplers->at(*index);
  }

  void read_sampler(const Json& sampler, const std::string& where, std::size_t width, Track& track) const {
    if (sampler.contains("interpolation"))
      track.interpolation = value_of(interpolations, fmt::format("{}: {}: interpolation", file_.name(), where),
                                     plain_text(sampler.at("interpolation")));
    const auto input = file_.index(sampler, where, "input"), output = file_.index(sampler, where, "output");
    if (!input || !output) throw Error("{}: {}: its sampler lacks its {}", file_.name(), where, input ? "output" : "input");
    track.times = read_numbers(*input, 1, where).values;
    check_times(where, track.times);

    // Weights are elements of one number each.
    const bool is_cubic = track.interpolation == Track::Interpolation::cubic;
    const std::size_t element = track.property == Track::Property::weights ? 1 : width, key_size = is_cubic ? 3 * width : width,
                      wanted = track.times.size() * (key_size / element);
    Numbers numbers = read_numbers(*output, element, where);
    if (numbers.count != wanted)
      throw Error("{}: {}: its sampler has {} keys{} and {} elements of output; {} are wanted", file_.name(), where,
                  track.times.size(), is_cubic ? " with tangents" : "", numbers.count, wanted);
    track.values = std::move(numbers.values);
    for (std::size_t i = 0; i < track.values.size(); ++i)
      if (!std::isfinite(track.values[i]))
        throw Error("{}: {}, key {}: value = {} is not finite", file_.name(), where, i / key_size, track.values[i]);
    if (track.property != Track::Property::rotation) return;
    for (std::size_t k = 0; k < track.times.size(); ++k) {
      double* const value = &track.values[k * key_size + (is_cubic ? width : 0)];
      const glm::dvec4 rotation(value[0], value[1], value[2], value[3]);
      if (!(glm::length(rotation) > 0)) throw Error("{}: {}, key {}: rotation = (0, 0, 0, 0) is none", file_.name(), where, k);
      const glm::dvec4 unit = glm::normalize(rotation);
      for (int i = 0; i < 4; ++i) value[i] = unit[i];
    }
  }

  /// An accessor's error names the channel, too.
  Numbers read_numbers(std::size_t accessor, std::size_t width, const std::string& where) const {
    try {
      return file_.read(accessor, width);
    } catch (const Error& error) {
      throw Error("{} (named in {})", error.what(), where);
    }
  }

  void check_times(const std::string& where, const std::vector<double>& times) const {
    if (times.empty()) throw Error("{}: {}: its sampler has no keys; one at least is needed", file_.name(), where);
    for (std::size_t k = 0; k < times.size(); ++k) {
      if (!(times[k] >= 0 && std::isfinite(times[k])))
        throw Error("{}: {}, key {}: time = {} is not a number of seconds, 0 or more", file_.name(), where, k, times[k]);
      if (k > 0 && times[k] < times[k - 1])
        throw Error("{}: {}, key {}: time = {} is below {}, that of the key before; times must ascend", file_.name(), where, k,
                    times[k], times[k - 1]);
    }
  }

  const GltfFile& file_;
  GltfAnimations answer_;
  std::set<std::pair<std::size_t, Track::Property>> moved_;  ///< by this animation
};

}  // namespace

GltfAnimations read_animations(const GltfFile& file) { return AnimationReader(file).read(); }

}  // namespace gnomon::importing
