#include "analysis/front.h"

#include <cmath>

#include "analysis/missing_places.h"
#include "measure/counted.h"

namespace gnomon {

namespace {

double geometric_mean(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += std::log(std::max(value, 1e-9));
  return std::exp(sum / static_cast<double>(values.size()));
}

/// The least cost of a contender becomes 1.
void add_relative_costs(Field& field) {
  std::optional<double> least;
  for (const Candidate& c : field.candidates)
    if (c.role == Role::contender && c.cost && (!least || c.cost->value < *least)) least = c.cost->value;
  if (!least || *least <= 0) return;
  for (Candidate& c : field.candidates) {
    if (!c.cost) continue;
    c.relative_cost = *c.cost;
    for (double* end : {&c.relative_cost.value, &c.relative_cost.low, &c.relative_cost.high}) *end /= *least;
  }
}

/// The mean of what `of` says of the rows; nothing where it says nothing of one.
template <class Of>
std::optional<double> mean(std::span<const Record* const> rows, const Of& of) {
  double sum = 0;
  for (const Record* row : rows) {
    const std::optional<double> one = of(*row);
    if (!one) return std::nullopt;
    sum += *one;
  }
  return rows.empty() ? std::nullopt : std::optional(sum / static_cast<double>(rows.size()));
}

std::optional<double> constant_error(std::span<const Record* const> rows, const FieldOptions& options) {
  return mean(rows, [&](const Record& r) { return r.metric(constant_metric(options.error)); });
}

std::optional<double> larger(std::optional<double> a, std::optional<double> b) { return a && b ? std::max(*a, *b) : a ? a : b; }

/// How far the setting of these rows, one a place, is off.
Candidate candidate_of(std::span<const Record* const> rows, const FieldOptions& options) {
  const Record& first = *rows.front();
  return {.setting = setting_name(first),
          .technique = first.technique,
          .role = first.role,
          .error = *mean(rows, [&](const Record& r) { return quantity(r, options.error); }),
          .floor = mean(rows, [&](const Record& r) { return noise_floor(r, options.error); }),
          .gain_over_constant = mean(rows, [&](const Record& r) { return gain_over_constant(r, options.error); })};
}

Candidate candidate_of(const Record& r, const FieldOptions& options) {
  const Record* const rows[] = {&r};
  Candidate candidate = candidate_of(rows, options);
  candidate.cost = cost_of(r, options.cost);
  const Cost time = options.cost == Cost::bytes ? Cost::light : options.cost;
  candidate.time = options.cost == Cost::bytes ? cost_of(r, time) : candidate.cost;
  candidate.log_time = sample_of(r, parts_of(time)).log_time();
  if (options.cost != Cost::bytes) candidate.log_cost = candidate.log_time;
  if (r.bytes) candidate.bytes = static_cast<double>(*r.bytes);
  return candidate;
}

/// Over all places: means of what the rows of one setting measured.
Candidate mean_of(const std::vector<const Record*>& rows, const FieldOptions& options) {
  Candidate candidate = candidate_of(rows, options);
  const auto geometric_cost = [&](Cost cost) -> std::optional<ValueWithInterval> {
    std::vector<double> sizes;
    std::vector<Sample> samples;
    for (const Record* row : rows) {
      if (cost == Cost::bytes) {
        if (!row->bytes) return std::nullopt;
        sizes.push_back(static_cast<double>(*row->bytes));
        continue;
      }
      samples.push_back(sample_of(*row, parts_of(cost)));
      if (!samples.back().is_timed()) return std::nullopt;
    }
    if (cost != Cost::bytes) return bootstrap(samples, geometric_mean);
    // One zero makes a geometric mean zero: a technique that holds no bytes on some scene costs none.
    const bool is_nothing = std::ranges::any_of(sizes, [](double size) { return size <= 0; });
    return ValueWithInterval(is_nothing ? 0 : geometric_mean(sizes));
  };
  const auto geometric_log = [&](Cost cost) -> std::optional<LogTime> {
    std::vector<LogTime> times;
    for (const Record* row : rows) {
      const std::optional<LogTime> time = sample_of(*row, parts_of(cost)).log_time();
      if (!time) return std::nullopt;
      times.push_back(*time);
    }
    return times.empty() ? std::nullopt : std::optional(mean_of(times));
  };
  candidate.log_time = geometric_log(options.cost == Cost::bytes ? Cost::light : options.cost);
  if (options.cost != Cost::bytes) candidate.log_cost = candidate.log_time;
  candidate.cost = geometric_cost(options.cost);
  candidate.time = options.cost == Cost::bytes ? geometric_cost(Cost::light) : candidate.cost;
  if (const auto bytes = geometric_cost(Cost::bytes)) candidate.bytes = bytes->value;
  return candidate;
}

/// The field over all places of a kind of light, from the rows of each setting in order of appearance.
Field overall(std::span<const Record> records, RowsBySetting settings, const FieldOptions& options, AnswerKind answer) {
  Field field{.place = {}, .answer = answer, .candidates = {}, .notes = {}};
  std::set<Place> common;
  while (!settings.empty()) {
    common = common_places(settings, &RowsBySetting::value_type::second);
    if (!common.empty()) break;
    const auto fewest =
        std::ranges::min_element(settings, [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
    field.notes.push_back(fmt::format("left out: {}, which finished only {} of the places",
                                      setting_name(*fewest->second.begin()->second), fewest->second.size()));
    settings.erase(fewest);
  }
  std::vector<Place> all;
  for (const auto& [key, rows] : settings)
    for (const auto& [place, row] : rows) add_once(all, place);
  field.places = common.size();
  field.all_places = all.size();
  for (std::string& line : missing_places(records, settings, all, "not among the " + counted(common.size(), "place{s}")))
    field.notes.push_back(std::move(line));
  for (const auto& [key, rows] : settings) {
    std::vector<const Record*> compared;
    for (const auto& [place, row] : rows)
      if (common.contains(place)) compared.push_back(row);
    field.candidates.push_back(mean_of(compared, options));
    field.constant = larger(field.constant, constant_error(compared, options));
  }
  add_relative_costs(field);
  return field;
}

/// The note on the rows that the cost of motion leaves out; empty where it leaves out none. Throws Error where no geometry
/// moves.
std::string still_rows(std::span<const Record> records) {
  const auto is_still = [](const Record& r) { return r.status == Status::ok && !moves_geometry(r); };
  const auto still = std::ranges::count_if(records, is_still);
  if (std::ranges::none_of(records, moves_geometry))
    throw Error("there is no cost of motion: the geometry of no row moves; run rows that follow an animation");
  return still == 0 ? "" : fmt::format("left out: {} row{} whose geometry stands still", still, still == 1 ? "" : "s");
}

}  // namespace

std::vector<Field> find_fields(std::span<const Record> records, const FieldOptions& options) {
  require_quantity(records, options.error);
  if (better(options.error).empty()) throw Error("{} has no better side: front and best cannot rank by it", options.error);
  const bool needs_motion = options.cost == Cost::motion || options.error == "update_ms" || options.error == "motion_ms" ||
                            options.error.starts_with("moving_");
  const std::string left_out = needs_motion ? still_rows(records) : "";
  std::vector<Field> fields;
  std::map<Place, std::size_t> places;
  const auto is_asked = [&](const Record& r) {
    return (options.cost != Cost::motion || moves_geometry(r)) && quantity(r, options.error).has_value();
  };
  for (const Record& r : records) {
    if (r.status != Status::ok || !is_asked(r)) continue;
    const auto [found, is_new] = places.try_emplace(place_of(r), fields.size());
    if (is_new) fields.push_back({.place = place_of(r), .answer = r.answer, .candidates = {}, .notes = {}});
    Field& field = fields[found->second];
    field.candidates.push_back(candidate_of(r, options));
    const Record* const here[] = {&r};
    field.constant = larger(field.constant, constant_error(here, options));
  }
  const auto competes = [](const Candidate& c) { return c.role == Role::contender; };
  if (std::ranges::none_of(fields, [&](const Field& f) { return std::ranges::any_of(f.candidates, competes); }))
    throw Error("there is nothing to rank: no contender finished with the number {}", options.error);
  for (Field& field : fields) add_relative_costs(field);
  if (!left_out.empty()) fields.front().notes.push_back(left_out);
  for (const AnswerKind of : all_answer_kinds) {
    if (std::ranges::count_if(fields, [&](const Field& f) { return f.place && f.answer == of; }) < 2) continue;
    const auto is_wanted = [&](const Record& r) { return r.answer == of && is_asked(r); };
    fields.push_back(overall(records, rows_by_setting(records, is_wanted), options, of));
  }
  return fields;
}

std::vector<const Field*> overall_fields(std::span<const Field> fields) {
  std::vector<const Field*> result;
  for (const AnswerKind of : all_answer_kinds) {
    const Field* last = nullptr;
    for (const Field& field : fields)
      if (field.answer == of) last = &field;
    if (last) result.push_back(last);
  }
  return result;
}

std::string_view name(Standing standing) {
  static constexpr std::string_view names[] = {"front", "unclear", "beaten", "constant", "aside"};
  return names[static_cast<int>(standing)];
}

std::vector<FrontEntry> find_front(const Field& field, std::string_view direction) {
  const auto competes = [](const Candidate& c) { return c.may_be_best() && c.cost; };
  const auto competing = static_cast<std::size_t>(std::ranges::count_if(field.candidates, competes));
  std::vector<FrontEntry> stands;
  std::vector<Contrast> contrasts;  // of costs that a beaten candidate may share with who beats it
  std::vector<std::size_t> owners;  // entries
  for (const Candidate& mine : field.candidates) {
    FrontEntry stand;
    if (!competes(mine)) {
      if (mine.role == Role::contender && mine.cost) stand.standing = Standing::constant;
      stands.push_back(stand);
      continue;
    }
    stand.standing = Standing::front;
    const Candidate* beater = nullptr;
    for (const Candidate& other : field.candidates) {
      if (!competes(other) || is_better(direction, mine.ranked_error(), other.ranked_error()) ||
          mine.cost->value < other.cost->value)
        continue;
      const bool is_strict =
          is_better(direction, other.ranked_error(), mine.ranked_error()) || other.cost->value < mine.cost->value;
      if (!is_strict) continue;
      if (mine.log_cost && other.log_cost) {
        contrasts.push_back({*mine.log_cost, *other.log_cost, competing});
        owners.push_back(stands.size());
        if (stand.standing == Standing::front) stand.standing = Standing::unclear;
      } else {
        stand.standing = Standing::beaten;  // by value: bytes, for instance
      }
      if (!beater || other.cost->value < beater->cost->value) beater = &other;
    }
    if (beater) stand.beaten_by = beater->setting;
    stands.push_back(stand);
  }
  const std::vector<bool> told = told_apart(contrasts);
  for (std::size_t k = 0; k < told.size(); ++k)
    if (told[k]) stands[owners[k]].standing = Standing::beaten;
  return stands;
}

}  // namespace gnomon
