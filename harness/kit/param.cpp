#include <gnomon/param.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

namespace gnomon {

Parameter::Parameter(Parametrized* owner, std::string_view name, std::string_view unit, Stage spoils, std::string_view sentence)
    : owner_(owner), name_(name), unit_(unit), sentence_(sentence), spoils_(spoils) {
  owner->parameters_.push_back(this);
}

namespace {

/// "12.5" or "1e1": a number, but not one that is written as a whole number, nor one that is whole and out of range ("1e300").
bool is_fraction(std::string_view text, const Range<int>& range) {
  double number = 0;
  const char* const last = text.data() + text.size();
  const auto [end, code] = std::from_chars(text.data(), last, number);
  if (std::isfinite(number) && number == std::trunc(number) && (number < range.min || number > range.max)) return false;
  return code == std::errc{} && end == last && text.find_first_not_of("0123456789", text.starts_with('-')) != text.npos;
}

}  // namespace

void Parameter::refuse(std::string_view value, std::string_view more) const {
  if (const auto* whole = dynamic_cast<const Number<int>*>(&typed(*this)); whole && is_fraction(value, whole->range()))
    throw Error("{}.{} = {} is not a whole number in digits; allowed are {}", owner_->id(), name_, value, allowed());
  throw Error("{}.{} = {} is outside {}{}", owner_->id(), name_, value.empty() ? "(nothing)" : value, allowed(), more);
}

template <class T>
void Number<T>::set(std::string_view value) {
  T parsed{};
  const auto [end, code] = std::from_chars(value.data(), value.data() + value.size(), parsed);
  const bool is_number = code == std::errc{} && end == value.data() + value.size();
  if (!is_number || !(parsed >= range_.min && parsed <= range_.max)) refuse(value);
  value_ = parsed;
}
template class Number<int>;
template class Number<double>;

Choice::Choice(Parametrized* owner, std::string_view name, std::string_view value, std::vector<std::string_view> choices,
               Stage spoils, std::string_view sentence)
    : Parameter(owner, name, "", spoils, sentence), choices_(std::move(choices)) {
  const auto found = std::find(choices_.begin(), choices_.end(), value);
  if (found == choices_.end()) throw Error("parameter {}: default {} is outside {}", name, value, allowed());
  index_ = default_ = static_cast<int>(found - choices_.begin());
}

void Choice::set(std::string_view value) {
  const auto found = std::find(choices_.begin(), choices_.end(), value);
  if (found == choices_.end()) refuse(value);
  index_ = static_cast<int>(found - choices_.begin());
}

namespace {

struct InnerName {
  std::string full_name;
};

/// `of.count` of averaged_hard is `count` of the object that `of` names.
class InnerParameter final : InnerName, public Parameter {
 public:
  InnerParameter(const Parametrized& owner, std::string_view prefix, Parameter& row)
      : InnerName{fmt::format("{}.{}", prefix, row.name())},
        Parameter(owner, full_name, row.unit(), row.spoils(), row.sentence()),
        row_(row) {}
  Parameter& row() const { return row_; }
  std::string text() const override { return row_.text(); }
  std::string default_text() const override { return row_.default_text(); }
  std::string allowed() const override { return row_.allowed(); }
  std::vector<std::string> probes() const override { return row_.probes(); }
  void set(std::string_view value) override {
    try {
      row_.set(value);
    } catch (const Error&) {
      refuse(value);  // by the name that was written
    }
  }

 private:
  Parameter& row_;
};

}  // namespace

const Parameter& typed(const Parameter& row) {
  const auto* const inner = dynamic_cast<const InnerParameter*>(&row);
  return inner ? typed(inner->row()) : row;
}

ObjectParameter::~ObjectParameter() = default;

ObjectParameter::Known& ObjectParameter::known() const {
  const auto found = known_.find(id_);
  if (found != known_.end()) return found->second;
  Known fresh{made(id_), {}};
  for (Parameter* const row : fresh.object->parameters())
    fresh.rows.push_back(std::make_unique<InnerParameter>(owner(), name(), *row));
  return known_.emplace(id_, std::move(fresh)).first->second;
}

void ObjectParameter::set(std::string_view value) {
  if (value == id_) return;
  if (const std::string why = objection(value); !why.empty()) refuse(value, "; " + why);
  id_ = value;
}

std::vector<Parameter*> Parametrized::parameters() const {
  std::vector<Parameter*> rows;
  for (Parameter* const row : parameters_) {
    rows.push_back(row);
    if (const auto* const object = dynamic_cast<const ObjectParameter*>(row))
      for (const auto& inner : object->inner()) rows.push_back(inner.get());
  }
  return rows;
}

Parameter& Parametrized::parameter(std::string_view name) const {
  std::vector<std::string> names;
  for (Parameter* row : parameters()) {
    if (row->name() == name) return *row;
    names.emplace_back(row->name());
  }
  if (names.empty()) throw Error("{} has no parameter {}; it has none at all", id_, name);
  throw Error("{} has no parameter {}; did you mean {}? It has: {}", id_, name, nearest_word(name, names), joined(names, ", "));
}

std::string Parametrized::settings() const {
  std::string text;
  for (const Parameter* row : parameters())
    if (row->text() != row->default_text()) text += fmt::format("{}{}={}", text.empty() ? "" : ",", row->name(), row->text());
  return text;
}

void Parametrized::apply(std::string_view settings) {
  if (settings.empty()) return;
  std::vector<std::pair<std::string_view, std::string_view>> items;
  for (std::size_t start = 0; start != settings.npos;) {
    const std::size_t comma = settings.find(',', start);
    const std::string_view item = settings.substr(start, comma - start);
    start = comma == settings.npos ? comma : comma + 1;
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos) throw Error("{}: '{}' is not of the form parameter=value", id_, item);
    items.emplace_back(item.substr(0, equals), item.substr(equals + 1));
  }
  // An object comes before its rows: which ones there are depends on it.
  std::ranges::stable_sort(items, {}, [](const auto& item) { return std::ranges::count(item.first, '.'); });
  // All or nothing: where one value is refused, those set before it go back to what they were, the last one first.
  std::vector<std::pair<std::string_view, std::string>> before;
  try {
    for (const auto& [name, value] : items) {
      Parameter& row = parameter(name);
      if (std::ranges::find(before, name, [](const auto& old) { return old.first; }) != before.end())
        throw Error("{}.{} is given twice", id_, name);
      before.emplace_back(name, row.text());
      row.set(value);
    }
  } catch (const Error&) {
    for (; !before.empty(); before.pop_back()) parameter(before.back().first).set(before.back().second);
    throw;
  }
}

std::string joined(std::span<const std::string> words, std::string_view between) {
  std::string text;
  for (const std::string& word : words) {
    if (&word != words.data()) text += between;
    text += word;
  }
  return text;
}

std::vector<std::string> nearest_words(std::string_view word, std::span<const std::string> candidates, std::size_t most) {
  word = word.substr(0, 100);  // the time grows with it, and it may be a whole file
  const auto distance = [](std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
      std::size_t diagonal = std::exchange(row[0], i);
      for (std::size_t j = 1; j <= b.size(); ++j) {
        const std::size_t substitute = diagonal + (a[i - 1] != b[j - 1]);
        diagonal = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
      }
    }
    return row.back();
  };
  std::vector<std::pair<std::size_t, std::string>> ranked;
  for (const std::string& candidate : candidates) ranked.emplace_back(distance(word, candidate), candidate);
  std::ranges::stable_sort(ranked, {}, &std::pair<std::size_t, std::string>::first);
  std::vector<std::string> nearest;
  for (const auto& [far, candidate] : std::span(ranked).first(std::min(most, ranked.size()))) nearest.push_back(candidate);
  return nearest;
}

std::string nearest_word(std::string_view word, std::span<const std::string> candidates) {
  const std::vector<std::string> nearest = nearest_words(word, candidates, 1);
  return nearest.empty() ? "" : nearest.front();
}

}  // namespace gnomon
