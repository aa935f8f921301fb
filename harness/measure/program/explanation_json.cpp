#include "measure/program/explanation_json.h"

#include <gnomon/error.h>

#include <cmath>

namespace gnomon {

namespace {

/// The keys of one object, each read at most once; what is left over is refused.
class Keys {
 public:
  Keys(const Json& json, std::string what) : json_(json), what_(std::move(what)) {
    if (!json.is_object()) throw Error("{} is {}; an object is wanted", what_, json.type_name());
  }

  template <class Read>
  void read(const char* key, const Read& read) {
    known_.emplace_back(key);
    if (json_.contains(key)) read(json_[key], fmt::format("{}.{}", what_, key));
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
glm::dvec3 vector(const Json& json, const std::string& what) {
  if (!json.is_array() || json.size() != 3) throw Error("{} = {} is no list of three numbers", what, json_text(json));
  return {number(json[0], what), number(json[1], what), number(json[2], what)};
}

Tap tap(const Json& json, const std::string& what) {
  Tap t;
  Keys keys(json, what);
  keys.read("origin", [&](const Json& j, const std::string& w) { t.origin = vector(j, w); });
  keys.read("direction", [&](const Json& j, const std::string& w) { t.direction = vector(j, w); });
  keys.read("weight", [&](const Json& j, const std::string& w) { t.weight = number(j, w); });
  keys.read("stored", [&](const Json& j, const std::string& w) { t.stored = j.is_null() ? INFINITY : number(j, w); });
  keys.refuse_others();
  return t;
}

LightSample sample(const Json& json, const std::string& what) {
  LightSample s;
  Keys keys(json, what);
  keys.read("place", [&](const Json& j, const std::string& w) { s.place = vector(j, w); });
  keys.read("weight", [&](const Json& j, const std::string& w) { s.weight = number(j, w); });
  keys.read("visibility", [&](const Json& j, const std::string& w) { s.visibility = number(j, w); });
  keys.refuse_others();
  return s;
}

template <class Item>
std::vector<Item> list_of(const Json& json, const std::string& what, Item (*read)(const Json&, const std::string&)) {
  if (!json.is_array()) throw Error("{} is no list", what);
  std::vector<Item> items;
  for (std::size_t k = 0; k < json.size(); ++k) items.push_back(read(json[k], fmt::format("{}[{}]", what, k)));
  return items;
}

Explanation explanation(const Json& json, const std::string& what) {
  Explanation e;
  Keys keys(json, what);
  keys.read("covered", [&](const Json& j, const std::string& w) { e.covered = flag(j, w); });
  keys.read("taps", [&](const Json& j, const std::string& w) { e.taps = list_of(j, w, tap); });
  keys.read("bias", [&](const Json& j, const std::string& w) { e.bias = number(j, w); });
  keys.read("texel_width", [&](const Json& j, const std::string& w) { e.texel_width = number(j, w); });
  keys.read("shifted", [&](const Json& j, const std::string& w) { e.shifted = vector(j, w); });
  keys.read("element", [&](const Json& j, const std::string& w) {
    if (!j.is_number_unsigned()) throw Error("{} = {} is no number of an element", w, json_text(j));
    e.element = j.get<std::uint64_t>();
  });
  keys.read("outline_error", [&](const Json& j, const std::string& w) { e.outline_error = number(j, w); });
  keys.read("formula_differs", [&](const Json& j, const std::string& w) { e.formula_differs = flag(j, w); });
  keys.read("cause", [&](const Json& j, const std::string& w) {
    if (!j.is_null() && !j.is_string()) throw Error("{} = {} is no name of a cause", w, json_text(j));
    if (j.is_string()) e.cause = j.get<std::string>();
  });
  keys.read("samples", [&](const Json& j, const std::string& w) { e.samples = list_of(j, w, sample); });
  keys.refuse_others();
  return e;
}

}  // namespace

std::vector<std::optional<Explanation>> explanations_from_json(const Json& list) {
  if (!list.is_array()) throw Error("explanations are {}; a list is wanted", list.type_name());
  std::vector<std::optional<Explanation>> all;
  for (std::size_t k = 0; k < list.size(); ++k)
    if (list[k].is_null())
      all.emplace_back();
    else
      all.emplace_back(explanation(list[k], fmt::format("explanations[{}]", k)));
  return all;
}

}  // namespace gnomon
