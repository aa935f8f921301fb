// From a text to what it names: techniques with their settings, one or a sweep of them.
#include <gnomon/registry.h>

#include <unordered_map>

#include "measure/run/suite.h"

namespace gnomon {

namespace {

constexpr double most_texts = 100'000;  // of one text with braces
constexpr std::size_t most_characters = 2'000;

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
  std::vector<std::string> techniques;
  for (const std::string& part : parts_outside_braces(text)) {
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

std::vector<std::string> parts_outside_braces(std::string_view text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char c : text) {
    depth += (c == '{') - (c == '}');
    if (c == ',' && depth == 0)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

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

void refuse_several_techniques(const std::string& text) {
  if (const std::vector<std::string> several = techniques_in(text); several.size() > 1)
    throw Error("'{}' names {} techniques; where several are taken, the option is repeated: --technique {}", text,
                several.size(), joined(several, " --technique "));
}

std::vector<Contender> parse_contenders(const std::string& text, const std::string& label) {
  if (text == "*") {
    if (!label.empty()) throw Error("label {} would name every technique", label);
    std::vector<Contender> all;
    for (const TechniqueEntry& entry : registry().techniques())
      if (!entry.about.named_only) all.push_back({entry.id, "", "", true});
    return all;
  }
  refuse_several_techniques(text);
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

}  // namespace gnomon
