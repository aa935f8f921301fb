#include "measure/run/light_selection.h"

#include <gnomon/error.h>
#include <gnomon/param.h>

#include "measure/scene/channels.h"
#include "measure/scene/load.h"
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

/// Of whole lights: a light of three channels has one name, and each of its channels one that no pattern without a dot selects.
class Words {
 public:
  Words(const std::string& scene_name, const Scene& scene)
      : scene_name_(scene_name), scene_(scene), whole_(whole_lights(scene.lights)), names_(names_of(whole_)) {}

  /// The lights, in the scene's order, that a word without `+` selects.
  std::vector<std::string> lights(const std::string& word) const {
    const bool is_soft = word == "*soft", is_of_kind = is_soft || word == "*hard";
    std::vector<std::string> found;
    for (const Light& light : word.find('.') == word.npos ? whole_ : scene_.lights)
      if (is_of_kind ? has_area(light) == is_soft : is_like(light.name, word)) found.push_back(light.name);
    if (!found.empty()) return found;
    if (is_of_kind)
      throw Error("{} has no light {} area, which {} asks for; it has: {}", scene_in_words(scene_name_),
                  is_soft ? "with" : "without", word, joined(names_));
    if (word.find('*') != word.npos)
      throw Error("{} has no light whose name is like {}; it has: {}", scene_in_words(scene_name_), word, joined(names_));
    throw Error("{} has no light {}; did you mean {}? It has: {}", scene_in_words(scene_name_), word,
                nearest_word(word, names_), joined(names_));
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
      std::ranges::move(lights(term), std::back_inserter(named));
      has_pattern = has_pattern || term.find('*') != term.npos;
      begin = end + 1;
    }
    std::ranges::sort(named, {}, [&](const std::string& name) { return places(name).front(); });
    RowLights together = row(word, named);
    if (!has_pattern) together.name = joined(named, "+");
    return together;
  }

  /// Selected lights as one row, which tables call `word` where they are several.
  RowLights row(const std::string& word, const std::vector<std::string>& names) const {
    RowLights row{names.size() == 1 ? names.front() : word, {}};
    for (const std::string& name : names)
      for (const std::size_t k : places(name)) {
        const std::string& light = scene_.lights[k].name;
        if (std::ranges::find(row.lights, light) != row.lights.end())
          throw Error("lights {}: light {} is named twice; a row has each light once", word, name);
        row.lights.push_back(light);
      }
    if (row.lights.size() > most_lights)
      throw Error("lights {} of {} are {}; a row has at most {} lights together", word, scene_in_words(scene_name_),
                  row.lights.size(), most_lights);
    return row;
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

  /// Of a light of that name, or of its channels, their places in the scene.
  std::vector<std::size_t> places(const std::string& name) const {
    std::vector<std::size_t> found;
    for (std::size_t k = 0; k < scene_.lights.size(); ++k)
      if (scene_.lights[k].name == name || whole_name(scene_.lights[k].name) == name) found.push_back(k);
    return found;
  }

  const std::string& scene_name_;
  const Scene& scene_;
  std::vector<Light> whole_;
  std::vector<std::string> names_;  ///< of these
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
    for (const std::string& light : lights) add(of.row(light, {light}));
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
