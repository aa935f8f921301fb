#pragma once
#include <gnomon/param.h>

#include <memory>
#include <string>
#include <vector>

namespace gnomon::viewer {

struct Frame;

/// How the mean error of a technique at a frame falls with its parameter `samples`, as far as it is measured.
struct SampleCurve {
  std::shared_ptr<const Frame> frame;
  std::vector<double> samples, error;  ///< mean of |mask - reference| over the tested pixels
  double error_floor = 0;              ///< what the reference's own noise makes of it
  bool is_complete = false;            ///< nothing more will come
  std::string why_not = {};            ///< it ended early for this reason; else empty
};

/// The settings to ask: 1, 4, 16, ... as far as the range of the parameter `samples` goes. None where there is no such
/// parameter.
std::vector<int> curve_samples(const Parametrized& technique);

}  // namespace gnomon::viewer
