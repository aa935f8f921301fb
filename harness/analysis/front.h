#pragma once
#include "analysis/analysis.h"

namespace gnomon {

/// One setting in one place, or over all places: what fronts and budgets choose among.
struct Candidate {
  std::string setting = {}, technique = {};
  Role role = Role::contender;
  double error = 0;  ///< over all places: the mean
  /// Of errors under lights with area what the reference's own noise makes, shown beside; over all places: the mean.
  std::optional<double> floor = {};
  /// Over all places: the mean (see gain_over_constant); nothing where a record does not say.
  std::optional<double> gain_over_constant = {};
  std::optional<ValueWithInterval> cost = {};           ///< over all places: the geometric mean
  std::optional<ValueWithInterval> time = {};           ///< the same, in milliseconds also where the cost is memory
  std::optional<LogTime> log_cost = {}, log_time = {};  ///< of cost and time, where there are processes enough
  std::optional<double> bytes = {};                     ///< over all places: the geometric mean
  ValueWithInterval relative_cost = {};                 ///< to the cheapest contender of the field

  /// Errors are ranked by this: those that the reference's own noise may make are alike.
  double ranked_error() const { return floor && error <= *floor ? 0 : error; }
  /// Whether it may be on a front and meet a budget.
  bool may_be_best() const { return role == Role::contender && gain_over_constant.value_or(1) > 0; }
};

/// Candidates that may be compared with one another.
struct Field {
  std::optional<Place> place;              ///< nothing: over all places
  AnswerKind answer = AnswerKind::binary;  ///< of its places
  std::size_t places = 1, all_places = 1;  ///< how many it covers, of how many of its kind that anybody finished
  /// Error of the best constant mask, over all places the mean; where techniques are compared with different numbers that are
  /// true of a light, the largest.
  std::optional<double> constant = {};
  std::vector<Candidate> candidates;
  std::vector<std::string> notes;  ///< who is left out, and why
};

struct FieldOptions {
  std::string error = "error";  ///< a quantity
  Cost cost = Cost::light;
};

/// One field for each place, and then one over all places of each kind of answer, where there are two such places at least:
/// over those that every setting finished, so that means compare the same scenes. Settings that share no place with the others
/// are left out, the one with the fewest places first, and noted. Throws Error when no record has the error, when it has no
/// better side, and when no contender has it.
std::vector<Field> find_fields(std::span<const Record> records, const FieldOptions& options);

/// Of these fields the one for all places of each kind of light: over them all, or the only one.
std::vector<const Field*> overall_fields(std::span<const Field> fields);

/// The rank of a candidate among the contenders of its field.
enum class Standing {
  front,    ///< no contender is at least as good in both and better in one
  unclear,  ///< beaten by value, but its cost is not told apart from those of all who beat it (told_apart)
  beaten,
  constant,  ///< a contender that errs as much as the best constant mask, or more
  aside,     ///< reference, baseline, or without a cost: no contender that can be placed
};
std::string_view name(Standing standing);

struct FrontEntry {
  Standing standing = Standing::aside;
  std::string beaten_by;  ///< the cheapest contender that beats it
};
/// One for each candidate.
std::vector<FrontEntry> find_front(const Field& field, std::string_view direction);

/// The best contender that a budget allows.
struct Best {
  std::string what;                   ///< "time", "memory", "error": what is limited
  double budget = 0;                  ///< milliseconds, bytes, or the error's unit
  std::optional<std::size_t> winner;  ///< of the field's candidates; nothing when none keeps the budget
  std::vector<std::size_t> also;      ///< as good as it by value, or not told apart from it
};

struct Budgets {
  std::vector<double> times, memories, errors;
};
/// Round numbers 1, 2, 5 x 10^k from the least to the greatest value of any contender, at most `most` each, evenly picked.
Budgets round_budgets(std::span<const Field> fields, std::size_t most = 5);

/// Equal time and equal memory: the lowest error, ties by cost. Equal error: the lowest time. Of quantities whose direction is
/// "higher" an error budget is the least that will do.
std::vector<Best> find_best(const Field& field, const Budgets& budgets, std::string_view direction);

}  // namespace gnomon
