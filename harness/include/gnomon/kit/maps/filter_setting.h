#pragma once
#include <gnomon/kit/maps/map_filter.h>
#include <gnomon/technique.h>

namespace gnomon {

/// The parameters `filter`, `filter_radius`, `filter_taps`, `noise_frame`, `noise_frames`, `edge_search` and `early_bail` of
/// techniques that compare depths.
class FilterSetting {
 public:
  explicit FilterSetting(Parametrized* owner);
  MapFilter used() const;
  /// Unsupported where the filter has no weights for so large a radius.
  Support support() const;

 private:
  Choice filter;
  Number<int> filter_radius, filter_taps, noise_frame, noise_frames, edge_search;
  Flag early_bail;
};

}  // namespace gnomon
