#pragma once
#include <gnomon/technique.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "measure/answer_kind.h"
#include "measure/json.h"
#include "measure/printable.h"
#include "measure/truth_over.h"

namespace gnomon {

// One codec between structs and JSON objects, of records as of what passes between a program and its workers. A struct has a
//
//   void for_each_field(MaybeConst<Struct> auto& object, const auto& use) { use("key", object.member, "other", object.other); }
//
// in namespace gnomon, which names its fields in their order, for writing and for reading. An enum is written as name() spells
// it.

template <class T, class Of>
concept MaybeConst = std::is_same_v<std::remove_const_t<T>, Of>;

/// What reading does about a field that is absent or null: it keeps its default, or is an Error unless it is an optional.
enum class MissingField { kept, refused };

/// What for_each_field calls: it passes each key with its member to `each`.
template <class Each>
struct UseFields {
  Each each;
  void operator()(const char* key, auto& member, auto&... others) const {
    each(key, member);
    if constexpr (sizeof...(others) > 0) (*this)(others...);
  }
};
template <class Each>
UseFields(Each) -> UseFields<Each>;

void for_each_field(MaybeConst<Count> auto& r, const auto& use) { use("name", r.name, "value", r.value, "unit", r.unit); }

template <class T>
constexpr bool is_vector = false;
template <class T>
constexpr bool is_vector<std::vector<T>> = true;
/// One value for each stage; written as an object of those that have one.
template <class T>
constexpr bool is_by_stage = false;
template <class T>
constexpr bool is_by_stage<std::array<T, std::size(stage_names)>> = true;
using Color8 = std::array<std::uint8_t, 3>;

// The number of enumerators of each enum that can be read.
constexpr int enumerator_count(AnswerKind) { return std::size(answer_kind_names); }
constexpr int enumerator_count(Support::Kind) { return 3; }
constexpr int enumerator_count(Truth) { return 2; }
constexpr int enumerator_count(TruthOver) { return std::size(truth_over_names); }
constexpr int enumerator_count(LightShareKind) { return 2; }
constexpr int enumerator_count(Stage) { return std::size(stage_names); }

template <class T>
Json written(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    return name(value);
  } else if constexpr (std::is_same_v<T, double>) {
    return std::isfinite(value) ? Json(value) : Json();  // JSON has no NaN and no infinity: null
  } else if constexpr (requires { value.has_value(); }) {
    return value ? written(*value) : Json();
  } else if constexpr (is_vector<T>) {
    Json array = Json::array();
    for (const auto& item : value) array.push_back(written(item));
    return array;
  } else if constexpr (requires { typename T::mapped_type; }) {
    Json object = Json::object();
    for (const auto& [key, item] : value) object[plain_text(written(key))] = written(item);
    return object;
  } else if constexpr (is_by_stage<T>) {
    Json object = Json::object();
    for (std::size_t stage = 0; stage < value.size(); ++stage)
      if (!value[stage].empty()) object[std::string(stage_names[stage])] = value[stage];
    return object;
  } else if constexpr (requires { for_each_field(value, [](const char*, const auto&) {}); }) {
    Json object = Json::object();
    for_each_field(value, UseFields{[&](const char* key, const auto& member) { object[key] = written(member); }});
    return object;
  } else {
    return value;
  }
}

template <class T>
void read(const std::string& field, const Json& value, T& into, MissingField missing = MissingField::kept);

/// The members of `for_each_field` from those of an object.
template <class T>
void read_members(const std::string& field, const Json& object, T& into, MissingField missing) {
  if constexpr (std::is_same_v<T, Count>) into.value = std::numeric_limits<double>::quiet_NaN();
  const auto read_member = [&](const char* key, auto& member) {
    const std::string inner = fmt::format("{}.{}", field, key);
    if (const auto found = object.find(key); found != object.end() && !found->is_null())
      read(inner, *found, member, missing);
    else if (missing == MissingField::refused && !requires { member.has_value(); })
      throw Error("{} is missing", inner);
  };
  for_each_field(into, UseFields{read_member});
}

/// Throws Error with the field, its value and what is allowed.
template <class T>
void read(const std::string& field, const Json& value, T& into, MissingField missing) {
  const auto need = [&](bool is_good, std::string_view allowed) {
    if (!is_good) throw Error("{} = {} is not {}", field, json_text(value), allowed);
  };
  if constexpr (std::is_same_v<T, std::string>) {
    need(value.is_string(), "text");
    into = value.get<std::string>();
    // Texts of records are shown in a terminal, where they may do nothing else; messages are taken to the letter.
    if (missing == MissingField::kept && has_control_characters(into)) into = printable(into);
  } else if constexpr (std::is_same_v<T, double>) {
    need(value.is_number(), "a number");
    into = value.get<double>();
  } else if constexpr (std::is_same_v<T, bool>) {
    need(value.is_boolean(), "true or false");
    into = value.get<bool>();
  } else if constexpr (std::is_integral_v<T>) {
    const bool is_whole = value.is_number_unsigned() || (value.is_number_integer() && value.get<std::int64_t>() >= 0);
    need(is_whole, "a whole number, 0 or more");
    need(std::in_range<T>(value.get<std::uint64_t>()), fmt::format("{} at most", std::numeric_limits<T>::max()));
    into = value.get<T>();
  } else if constexpr (std::is_enum_v<T>) {
    std::vector<std::string> words;
    for (int k = 0; k < enumerator_count(T()); ++k) words.emplace_back(name(static_cast<T>(k)));
    const auto found = std::ranges::find_if(words, [&](const std::string& word) { return value == word; });
    if (found == words.end()) need(false, "one of " + joined(words));
    into = static_cast<T>(found - words.begin());
  } else if constexpr (std::is_same_v<T, Json>) {
    need(value.is_object(), "an object");
    into = value;
  } else if constexpr (requires { into.has_value(); }) {
    into.reset();
    if (!value.is_null()) read(field, value, into.emplace(typename T::value_type{}), missing);
  } else if constexpr (std::is_same_v<T, Color8>) {
    const bool is_color = value.is_array() && value.size() == 3 && std::ranges::all_of(value, [](const Json& level) {
                            return level.is_number_unsigned() && level.get<std::uint64_t>() <= 255;
                          });
    need(is_color, "three whole numbers, 0 .. 255");
    into = value.get<Color8>();
  } else if constexpr (is_vector<T>) {
    need(value.is_array(), "an array");
    into.clear();
    // A null is a value that is not defined at its place, where there is such a place; else a time that was not taken.
    for (const Json& item : value)
      if (!item.is_null() || missing == MissingField::refused || requires(typename T::value_type v) { v.reset(); })
        read(field, item, into.emplace_back(), missing);
  } else if constexpr (is_by_stage<T>) {
    std::map<std::string, typename T::value_type> by_name;
    read(field, value, by_name, missing);
    for (std::size_t stage = 0; stage < into.size(); ++stage) into[stage] = by_name[std::string(stage_names[stage])];
  } else if constexpr (requires { requires std::is_enum_v<typename T::key_type>; }) {
    need(value.is_object(), "an object");
    for (int k = 0; k < enumerator_count(typename T::key_type()); ++k) {  // other names are passed over
      const auto key = static_cast<typename T::key_type>(k);
      if (const auto found = value.find(name(key)); found != value.end())
        read(fmt::format("{}.{}", field, name(key)), *found, into[key], missing);
    }
  } else if constexpr (requires { typename T::mapped_type; }) {
    need(value.is_object(), "an object");
    for (const auto& [key, item] : value.items()) read(field + "." + key, item, into[key], missing);
  } else {
    need(value.is_object(), "an object");
    read_members(field, value, into, missing);
  }
}

}  // namespace gnomon
