#pragma once
#include "report/figure/figure_script.h"

namespace gnomon {

// Tics of axes, and labels beside marks, that do not cover one another.

/// "250", "10k", "1.5M".
std::string short_number(double value);
/// Tics of a logarithmic axis over this range with at most `most` labels, unless powers of ten alone are more; the rest are
/// small.
std::string log_tics(double least, double greatest, std::size_t most);
/// Tics at the values themselves; empty where two of them are nearer than this share of a logarithmic axis.
std::string value_tics(std::vector<double> values, double share);
/// Whether three values or more are further apart the greater they are, by about one ratio: 1, 2, 5, 10. Sorted and above 0.
bool are_spaced_by_ratio(std::span<const double> values);
/// The step of tics of a linear axis over this range, 1, 2 or 5 times a power of ten, with at most `most` labels.
double linear_step(double least, double greatest, std::size_t most);
/// The names of tics at multiples of this step.
std::vector<std::string> linear_names(double least, double greatest, double step);
/// The names in a list of tics such as those above.
std::vector<std::string> names_of_tics(std::string_view tics);
/// Tics 0, 1, 2, ... named by these words, turned where they do not fit.
std::string word_tics(const std::vector<std::string>& words, bool do_turn);

/// A place in a panel, in cm from its lower left corner.
struct PanelPoint {
  double x = 0, y = 0;
};
/// For each of the labels of marks where its center lies from its mark, in cm: beside it, over as few marks and other labels as
/// can be, and within the panel.
std::vector<PanelPoint> label_offsets(std::span<const PanelPoint> marks, std::span<const std::string> labels,
                                      std::span<const PanelPoint> all_marks, const PanelGrid& grid);

}  // namespace gnomon
