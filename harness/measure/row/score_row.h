#pragma once
#include "measure/row/row.h"

namespace gnomon {

/// The score of a mask: that of one light, or those of a row's lights together.
struct Score {
  AnswerKind kind = AnswerKind::binary;  ///< of the reference
  Metrics metrics;
  std::map<std::string, std::uint64_t> classes;
  /// Nothing where causes were not looked for.
  std::optional<std::map<std::string, std::uint64_t>> causes;
  /// The part of each in the mean error, where the answer is not binary.
  std::optional<std::map<std::string, double>> cause_errors;
};
/// Of a row: each light's, and the row's own. Of one light both are the same. Where lights are of several channels metrics are
/// means over the channels; pixels have the class and the errors of the one that errs most there.
struct RowScore {
  std::vector<Score> lights;
  Score whole;
  ErrorCounts errors;   ///< of the whole
  double exposure = 1;  ///< of its pictures; see exposure_of
};

/// Scores a row that is put together; `before` is the same row at the frame before, on a path.
RowScore score(const MeasuredRow& row, const Scene& scene, const MeasuredRow* before = nullptr);

/// The precision of the reference of an answer that is a fraction, over all pixels that it has; nothing of a binary one.
std::optional<Record::ReferenceFacts> reference_facts(const Answer& answer, const AreaTarget& target);

/// The precision of the truth over the pixel; nothing where the answer has none.
std::optional<Record::PixelFacts> pixel_facts(const Answer& answer);

/// Puts scores into a record whose lights are described: metrics against its headline truth. There is one for each light.
void put_score(Record& record, std::span<const Score> lights, const Score& whole);
void put_score(Record& record, const RowScore& score);

/// The score of a path of so many frames: metrics are means, classes and causes sums. A mean is there where every frame has the
/// metric (one between two frames: every frame but the first), for one over some frames would be another quantity in every row.
class PathScore {
 public:
  explicit PathScore(int frames) : share_(1 / static_cast<double>(frames)) {}
  void add(const Score& score);
  Score score() const;

 private:
  Score sum_;                                                           ///< but for metrics
  std::map<std::string, std::pair<double, int>, std::less<>> metrics_;  ///< sums, and of how many frames that have a value
  double share_;
  int frames_ = 0;
};

}  // namespace gnomon
