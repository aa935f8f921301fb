#include "measure/program/explanation_json.h"

#include <cmath>

namespace gnomon {

namespace {

/// The keys of one object, each read at most once; any other key is refused.
class Keys {
 public:
  Keys(const Json& json, std::string what) : json_(json), what_(std::move(what)) {
    if (!json.is_object()) throw Error("{} is {}; an object is wanted", what_, json.type_name());
  }

  /// Puts what `convert` makes of the key's value, where there is one, into a member.
  void read(const char* key, auto& member, const auto& convert) {
    known_.emplace_back(key);
    if (json_.contains(key)) member = convert(json_[key], fmt::format("{}.{}", what_, key));
  }
  void refuse_others() const {
    for (const auto& [key, value] : json_.items())
      if (std::ranges::find(known_, key) == known_.end())
        throw Error("{} has no key {}; it has: {}", what_, key, joined(known_, ", "));
  }

 private:
  const Json& json_;
  std::string what_;
  std::vector<std::string> known_;
};

double number(const Json& json, const std::string& what) {
  if (!json.is_number() || !std::isfinite(json.get<double>())) throw Error("{} = {} is no number", what, json_text(json));
  return json.get<double>();
}
bool flag(const Json& json, const std::string& what) {
  if (!json.is_boolean()) throw Error("{} = {} is neither true nor false", what, json_text(json));
  return json.get<bool>();
}
/// Null is infinity.
double stored_distance(const Json& json, const std::string& what) { return json.is_null() ? INFINITY : number(json, what); }
std::uint64_t element_number(const Json& json, const std::string& what) {
  if (!json.is_number_unsigned()) throw Error("{} = {} is no number of an element", what, json_text(json));
  return json.get<std::uint64_t>();
}
/// Null is none.
std::string cause_name(const Json& json, const std::string& what) {
  if (!json.is_null() && !json.is_string()) throw Error("{} = {} is no name of a cause", what, json_text(json));
  return json.is_null() ? std::string() : json.get<std::string>();
}
glm::dvec3 vector(const Json& json, const std::string& what) {
  if (!json.is_array() || json.size() != 3) throw Error("{} = {} is no list of three numbers", what, json_text(json));
  return {number(json[0], what), number(json[1], what), number(json[2], what)};
}

Tap tap(const Json& json, const std::string& what) {
  Tap t;
  Keys keys(json, what);
  keys.read("origin", t.origin, vector);
  keys.read("direction", t.direction, vector);
  keys.read("weight", t.weight, number);
  keys.read("stored", t.stored, stored_distance);
  keys.refuse_others();
  return t;
}

LightSample sample(const Json& json, const std::string& what) {
  LightSample s;
  Keys keys(json, what);
  keys.read("place", s.place, vector);
  keys.read("weight", s.weight, number);
  keys.read("visibility", s.visibility, number);
  keys.refuse_others();
  return s;
}

template <class Item>
auto list_of(Item (*convert)(const Json&, const std::string&)) {
  return [convert](const Json& json, const std::string& what) {
    if (!json.is_array()) throw Error("{} is no list", what);
    std::vector<Item> items;
    for (std::size_t k = 0; k < json.size(); ++k) items.push_back(convert(json[k], fmt::format("{}[{}]", what, k)));
    return items;
  };
}

Explanation explanation(const Json& json, const std::string& what) {
  Explanation e;
  Keys keys(json, what);
  keys.read("covered", e.covered, flag);
  keys.read("taps", e.taps, list_of(tap));
  keys.read("bias", e.bias, number);
  keys.read("texel_width", e.texel_width, number);
  keys.read("shifted", e.shifted, vector);
  keys.read("element", e.element, element_number);
  keys.read("outline_error", e.outline_error, number);
  keys.read("formula_differs", e.formula_differs, flag);
  keys.read("cause", e.cause, cause_name);
  keys.read("samples", e.samples, list_of(sample));
  keys.refuse_others();
  return e;
}

}  // namespace

std::vector<std::optional<Explanation>> explanations_from_json(const Json& list) {
  if (!list.is_array()) throw Error("explanations are {}; a list is wanted", list.type_name());
  std::vector<std::optional<Explanation>> all;
  for (std::size_t k = 0; k < list.size(); ++k)
    if (std::optional<Explanation>& one = all.emplace_back(); !list[k].is_null())
      one = explanation(list[k], fmt::format("explanations[{}]", k));
  return all;
}

}  // namespace gnomon
