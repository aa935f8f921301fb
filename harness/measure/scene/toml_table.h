#pragma once
// Private to the reader of described scenes: a TOML table that checks keys, types and ranges.
#include <gnomon/error.h>
#include <gnomon/param.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "measure/scene/base_scene.h"
#include "measure/scene/load.h"
#include "measure/scene/names.h"

namespace gnomon {

/// A TOML file, whose size and the depth of whose keys are bounded before it is parsed. Throws Error with the line of
/// invalid TOML; `what` begins errors about the file itself.
toml::table read_toml(const std::string& what, const std::filesystem::path& file);
/// The files that a description of a scene names, as written: meshes, masks and transmissions.
std::vector<std::string> files_named_in(const toml::table& description);

/// A TOML table. Its constructor refuses unknown keys.
class Table {
 public:
  Table(const toml::table& table, const std::filesystem::path& file, std::string what,
        const std::vector<std::string_view>& keys, const std::vector<std::string_view>& more_keys = {})
      : Table(table, file, std::move(what)) {
    std::vector<std::string> known(keys.begin(), keys.end());
    known.insert(known.end(), more_keys.begin(), more_keys.end());
    for (const auto& [key, value] : table)
      if (std::ranges::find(known, key.str()) == known.end())
        throw Error("{} has no key '{}'; did you mean '{}'? It has: {} ({}:{})", what_, key.str(),
                    nearest_word(key.str(), known), joined(known, ", "), file.string(), key.source().begin.line);
  }

  /// A table whose keys were checked before.
  Table(const toml::table& table, const std::filesystem::path& file, std::string what)
      : table_(table), file_(file), what_(std::move(what)) {}

  bool has(std::string_view key) const { return table_.contains(key); }
  /// "FILE:LINE" of a key, or of the table when the key is not there.
  std::string where(std::string_view key = {}) const {
    const toml::node* node = key.empty() ? nullptr : table_.get(key);
    return fmt::format("{}:{}", file_.string(), (node ? node->source() : table_.source()).begin.line);
  }
  template <class Value>
  [[noreturn]] void refuse(std::string_view key, const Value& value, std::string_view allowed) const {
    throw Error("{}.{} = {} is not {} ({})", what_, key, value, allowed, where(key));
  }

  /// What a key holds; false where it is not there.
  bool is_text(std::string_view key) const { return table_.get(key) && table_.get(key)->is_string(); }
  bool is_flag(std::string_view key) const { return table_.get(key) && table_.get(key)->is_boolean(); }

  std::string text(std::string_view key) const { return exact<std::string>(key, "a text"); }
  /// A text that is not empty.
  std::string file_name(std::string_view key) const {
    const std::string name = text(key);
    if (name.empty()) refuse(key, "''", "the name of a file");
    return name;
  }
  bool flag(std::string_view key, bool fallback) const { return has(key) ? exact<bool>(key, "true or false") : fallback; }
  double number(std::string_view key) const { return number_of(key, need(key)); }
  double number(std::string_view key, double fallback) const { return has(key) ? number(key) : fallback; }
  int integer(std::string_view key, int fallback, int least, int most) const {
    if (!has(key)) return fallback;
    const auto value = exact<std::int64_t>(key, fmt::format("a whole number of {} .. {}", least, most));
    if (value < least || value > most) refuse(key, value, fmt::format("within {} .. {}", least, most));
    return static_cast<int>(value);
  }
  /// Above 0 as a float32 too.
  float positive(std::string_view key) const {
    const double value = number(key);
    if (!(static_cast<float>(value) > 0)) refuse(key, value, "a number above 0");
    return static_cast<float>(value);
  }
  glm::dvec3 vector(std::string_view key) const { return three(key, need(key)); }
  glm::dvec3 vector(std::string_view key, const glm::dvec3& fallback) const { return has(key) ? vector(key) : fallback; }
  /// Not zero, as float32 either.
  glm::dvec3 length_and_direction(std::string_view key) const {
    const glm::dvec3 value = vector(key);
    if (glm::vec3(value) == glm::vec3(0)) refuse(key, "[0, 0, 0]", "a vector of any length");
    return value;
  }
  /// A direction of any length but zero: a usable one.
  glm::dvec3 direction(std::string_view key) const {
    const glm::dvec3 value = vector(key);
    if (value == glm::dvec3(0)) refuse(key, "[0, 0, 0]", "a direction");
    return usable_direction(value);
  }
  /// `count` vectors; any number of at least `least` where `count` is 0.
  std::vector<glm::dvec3> vectors(std::string_view key, std::size_t count, std::size_t least) const {
    const toml::array* array = need(key).as_array();
    if (!array || (count > 0 && array->size() != count) || array->size() < least)
      refuse(key, kind(key), count > 0 ? fmt::format("{} vectors", count) : fmt::format("{} or more vectors", least));
    std::vector<glm::dvec3> result;
    for (const toml::node& item : *array) result.push_back(three(key, item));
    return result;
  }
  /// The numbers of a list.
  std::vector<double> numbers(std::string_view key) const {
    const toml::array* array = need(key).as_array();
    if (!array) refuse(key, kind(key), "a list of numbers");
    std::vector<double> result;
    for (const toml::node& item : *array) result.push_back(number_of(key, item));
    return result;
  }
  /// One text, or those of a list of one or more.
  std::vector<std::string> texts(std::string_view key) const {
    if (is_text(key)) return {text(key)};
    const toml::array* array = need(key).as_array();
    if (!array || array->empty()) refuse(key, kind(key), "a text or a list of texts");
    std::vector<std::string> result;
    for (const toml::node& item : *array) {
      if (!item.is_string()) refuse(key, "a list with something else", "a text or a list of texts");
      result.push_back(*item.value_exact<std::string>());
    }
    return result;
  }
  glm::dvec2 pair(std::string_view key) const {
    const toml::array* array = need(key).as_array();
    if (!array || array->size() != 2) refuse(key, kind(key), "[width, depth]");
    return {number_of(key, (*array)[0]), number_of(key, (*array)[1])};
  }
  /// One number for all three axes, or one each; none of them 0.
  glm::dvec3 scale(std::string_view key) const {
    if (!has(key)) return glm::dvec3(1);
    const glm::dvec3 value = need(key).is_array() ? vector(key) : glm::dvec3(number(key));
    if (value.x == 0 || value.y == 0 || value.z == 0) refuse(key, 0, "a scale: it may not be 0");
    return value;
  }
  /// A name of [a-z0-9_] that no `other` has; `fallback` without the key.
  template <class Named>
  std::string name(std::string_view key, const std::vector<Named>& others, const std::string& fallback = Named{}.name) const {
    const std::string value = has(key) ? text(key) : fallback;
    if (!is_plain_name(value)) refuse(key, '\'' + value + '\'', "a name of a..z, 0..9 and _, at most 100 of them");
    if (find_named(others, value)) refuse(key, '\'' + value + '\'', "unique");
    return value;
  }
  /// 0 .. 1.
  double share(std::string_view key) const { return share_of(key, need(key)); }
  /// Three shares of 0 .. 1, or one for all three. `allowed` is what the key may hold.
  glm::vec3 shares(std::string_view key, std::string_view allowed) const {
    const toml::node& node = need(key);
    const toml::array* array = node.as_array();
    if (array ? array->size() != 3 : !node.is_number()) refuse(key, kind(key), allowed);
    if (!array) return glm::dvec3(share_of(key, node));
    for (const toml::node& item : *array)
      if (!item.is_number()) refuse(key, "a list with something else", allowed);
    return glm::dvec3(share_of(key, (*array)[0]), share_of(key, (*array)[1]), share_of(key, (*array)[2]));
  }
  glm::vec3 albedo() const {
    const glm::vec3 value(vector("albedo", glm::dvec3(0.7)));
    if (std::min({value.x, value.y, value.z}) < 0 || std::max({value.x, value.y, value.z}) > 1)
      refuse("albedo", fmt::format("[{}, {}, {}]", value.x, value.y, value.z), "three shares of 0 .. 1");
    return value;
  }
  /// The tables of `[[key]]`, none when there is none.
  std::vector<const toml::table*> tables(std::string_view key) const {
    std::vector<const toml::table*> result;
    if (!has(key)) return result;
    const toml::array* array = need(key).as_array();
    if (!array) refuse(key, kind(key), fmt::format("an array of tables: write [[{}]]", key));
    constexpr std::size_t most = 10'000;  // names are compared with each other
    if (array->size() > most) refuse(key, fmt::format("{} tables", array->size()), fmt::format("at most {}", most));
    for (const toml::node& item : *array) {
      if (!item.is_table()) refuse(key, "an array of values", fmt::format("an array of tables: write [[{}]]", key));
      result.push_back(item.as_table());
    }
    return result;
  }

 private:
  const toml::node& need(std::string_view key) const {
    const toml::node* node = table_.get(key);
    if (!node) throw Error("{} lacks the key '{}' ({})", what_, key, where());
    return *node;
  }
  template <class Value>
  Value exact(std::string_view key, std::string_view allowed) const {
    const auto value = need(key).template value_exact<Value>();
    if (!value) refuse(key, kind(key), allowed);
    return *value;
  }
  std::string kind(std::string_view key) const {
    const toml::node& node = need(key);
    if (node.is_array()) return fmt::format("an array of {}", node.as_array()->size());
    if (node.is_string()) return "a text";
    if (node.is_table()) return "a table";
    if (node.is_boolean()) return "a truth value";
    return node.is_number() ? "a number" : "a date";
  }
  /// Of any size, not finite, too.
  double value_of(std::string_view key, const toml::node& node) const {
    if (!node.is_number()) refuse(key, &node == &need(key) ? kind(key) : "a list with something else", "a number or numbers");
    // Not value<double>() of both: that has no answer for whole numbers that a double must round.
    const auto whole = node.value_exact<std::int64_t>();
    return whole ? static_cast<double>(*whole) : *node.value_exact<double>();
  }
  double number_of(std::string_view key, const toml::node& node) const {
    const double value = value_of(key, node);
    constexpr double largest = 1e30;  // of any number; of what may be a coordinate, less: largest_coordinate
    if (!std::isfinite(value) || std::abs(value) > largest) refuse(key, value, "within -1e30 .. 1e30");
    return value;
  }
  double share_of(std::string_view key, const toml::node& node) const {
    const double value = value_of(key, node);
    if (!(value >= 0 && value <= 1)) refuse(key, value, "within 0 .. 1");
    return value;
  }
  glm::dvec3 three(std::string_view key, const toml::node& node) const {
    const toml::array* array = node.as_array();
    if (!array || array->size() != 3) refuse(key, kind(key), "a vector [x, y, z]");
    return {number_of(key, (*array)[0]), number_of(key, (*array)[1]), number_of(key, (*array)[2])};
  }
  const toml::table& table_;
  const std::filesystem::path& file_;
  std::string what_;
};

}  // namespace gnomon
