#pragma once
#include "analysis/analysis.h"

namespace gnomon {

/// What is said of the first setting of a pair, against the second.
enum class PairVerdict {
  better,
  worse,
  not_told_apart,  ///< places enough, and no difference that chance does not make
  too_few,         ///< places: no difference could have been called over so few
};
std::string_view name(PairVerdict verdict);  ///< "better", "worse", "not told apart", "too few places"

/// Two settings over the places that both have.
struct RankedPair {
  std::string first, second;
  std::size_t places = 0, scenes = 0;  ///< scenes: of these places
  std::vector<Place> left_out = {};    ///< places that only one of the two has
  /// What the first has over what the second has, at a typical place: infinite where the second has 0 everywhere, nothing
  /// where they share no place. The 95 % interval is of this pair alone.
  std::optional<ValueWithInterval> ratio = {};
  double p = 1;            ///< of a difference this large between equals
  double family_rate = 1;  ///< the chance of any false call among all pairs at which this one is called (Holm 1979)
  PairVerdict verdict = PairVerdict::not_told_apart;
};

/// Pairs of settings at the places of one kind of light, by their error or by a cost.
struct Ranking {
  AnswerKind answer = AnswerKind::binary;
  std::optional<Cost> cost = {};  ///< nothing: by the error
  std::vector<RankedPair> pairs = {};
  std::size_t tests = 0;                ///< that the family rates are over; all pairs where these were chosen by what is tested
  std::size_t needed_places = 2;        ///< fewer call no difference among so many tests
  std::size_t drawn = 0;                ///< flips of signs that were drawn where there are too many places to count all; else 0
  std::vector<std::string> notes = {};  ///< of the kind of light: what is left out, and who beats no constant mask
};

struct RankOptions {
  std::string error = "error";    ///< a quantity
  std::optional<Cost> cost = {};  ///< nothing: each that was measured
  bool all_pairs = false;         ///< else the best by error against each
};

/// Contenders in pairs over places: for each kind of light by error, then by costs. Errors and memory have no noise, and places
/// are what may differ: their relative differences are tested by flips of their signs (flip_signs), so that no place counts
/// more for its scale. Of times the logarithms of ratios are tested by Student's t over places. The best is the one whose
/// errors are least relative to those of the others, of those that beat the best constant mask, if any does. Pairs of it stand
/// first. Empty where no two contenders share a place. Throws Error when no record has the error, when it has no better side,
/// and when no pair has the requested cost.
std::vector<Ranking> find_ranks(std::span<const Record> records, const RankOptions& options);

}  // namespace gnomon
