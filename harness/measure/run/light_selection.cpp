#include "measure/run/light_selection.h"

#include <gnomon/error.h>
#include <gnomon/param.h>

#include "measure/scene/names.h"

namespace gnomon {

bool is_like(std::string_view name, std::string_view pattern) {
  const std::size_t star = pattern.find('*');
  if (star == pattern.npos) return name == pattern;
  if (!name.starts_with(pattern.substr(0, star))) return false;
  const std::string_view rest = pattern.substr(star + 1);
  for (std::size_t at = star; at <= name.size(); ++at)
    if (is_like(name.substr(at), rest)) return true;
  return false;
}

namespace {

class Words {
 public:
  Words(const std::string& scene_name, const Scene& scene)
      : scene_name_(scene_name), scene_(scene), names_(names_of(scene.lights)) {}

  /// The lights, in the scene's order, that a word without `+` selects.
  std::vector<std::string> lights(const std::string& word) const {
    const bool is_soft = word == "*soft", is_of_kind = is_soft || word == "*hard";
    std::vector<std::string> found;
    for (const Light& light : scene_.lights)
      if (is_of_kind ? has_area(light) == is_soft : is_like(light.name, word)) found.push_back(light.name);
    if (!found.empty()) return found;
    if (is_of_kind)
      throw Error("scene {} has no light {} area, which {} asks for; it has: {}", scene_name_, is_soft ? "with" : "without",
                  word, joined(names_));
    if (word.find('*') != word.npos)
      throw Error("scene {} has no light whose name is like {}; it has: {}", scene_name_, word, joined(names_));
    throw Error("scene {} has no light {}; did you mean {}? It has: {}", scene_name_, word, nearest_word(word, names_),
                joined(names_));
  }

  /// The row of a word with `+`.
  RowLights together(const std::string& word) const {
    const std::size_t plus = word.rfind('+');
    const std::string whole = word.substr(0, plus), number = word.substr(plus + 1);
    // Beside a name, digits are a name, too.
    const bool is_number = !number.empty() && number.size() < 7 && number.find_first_not_of("0123456789") == number.npos;
    if (is_number && (whole == "all" || (whole.find('*') != whole.npos && whole.find('+') == whole.npos)))
      return row(word, chosen(word, whole == "all" ? names_ : lights(whole), std::stoul(number)));
    if (word == "all+") return row(word, names_);
    std::vector<std::string> named;
    bool has_pattern = false;
    const std::string terms = word.ends_with('+') ? word.substr(0, word.size() - 1) : word;
    for (std::size_t begin = 0; begin <= terms.size();) {
      const std::size_t end = std::min(terms.find('+', begin), terms.size());
      const std::string term = terms.substr(begin, end - begin);
      if (term.empty()) throw Error("lights {}: a name is missing beside a +; write a+b, or all+ for all lights", word);
      for (std::string& light : lights(term)) {
        if (std::ranges::find(named, light) != named.end())
          throw Error("lights {}: light {} is named twice; a row has each light once", word, light);
        named.push_back(std::move(light));
      }
      has_pattern = has_pattern || term.find('*') != term.npos;
      begin = end + 1;
    }
    std::ranges::sort(named, {}, [&](const std::string& name) { return std::ranges::find(names_, name) - names_.begin(); });
    const std::string name = has_pattern ? word : joined(named, "+");
    return row(name, std::move(named));
  }

  const std::vector<std::string>& all() const { return names_; }

 private:
  static std::vector<std::string> chosen(const std::string& word, const std::vector<std::string>& from, std::size_t count) {
    if (count < 1 || count > from.size())
      throw Error("lights {}: {} is outside 1 .. {}, which are there", word, count, from.size());
    std::vector<std::string> lights;
    for (std::size_t k = 0; k < count; ++k) lights.push_back(from[k * from.size() / count]);
    return lights;
  }

  RowLights row(const std::string& word, std::vector<std::string> lights) const {
    if (lights.size() > most_lights)
      throw Error("lights {} of scene {} are {}; a row has at most {} lights together", word, scene_name_, lights.size(),
                  most_lights);
    return {lights.size() == 1 ? lights.front() : word, std::move(lights)};
  }

  const std::string& scene_name_;
  const Scene& scene_;
  std::vector<std::string> names_;
};

}  // namespace

bool is_light_name(std::string_view word) { return word.find_first_of("*+") == word.npos; }

std::vector<RowLights> row_lights(const std::vector<std::string>& words, const std::string& scene_name, const Scene& scene) {
  const Words of(scene_name, scene);
  std::vector<RowLights> rows;
  const auto add = [&](RowLights row) {
    if (std::ranges::find(rows, row.lights, &RowLights::lights) == rows.end()) rows.push_back(std::move(row));
  };
  const auto add_each = [&](const std::vector<std::string>& lights) {
    for (const std::string& light : lights) add({light, {light}});
  };
  if (words.empty()) add_each(of.all());
  for (const std::string& word : words) {
    if (word.find('+') != word.npos)
      add(of.together(word));
    else
      add_each(of.lights(word));
  }
  return rows;
}

}  // namespace gnomon
