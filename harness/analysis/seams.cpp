#include "analysis/seams.h"

#include "measure/score/metrics.h"

namespace gnomon {

namespace {

/// Bins up to 8 px.
constexpr std::size_t near_bins = 4;

/// Sum over the first bins of what part of the error each makes; nothing where a bin with pixels has no error, which on a path
/// is one that some frame leaves empty.
std::optional<double> error_of_bins(const SeamErrors& row, std::size_t count) {
  double sum = 0;
  for (std::size_t k = 0; k < count; ++k) {
    if (row.shares[k].value_or(0) == 0) continue;
    if (!row.errors[k]) return std::nullopt;
    sum += *row.shares[k] * *row.errors[k];
  }
  return sum;
}

}  // namespace

std::vector<std::string> seam_bin_names() {
  std::vector<std::string> names;
  for (const MetricInfo& info : metric_infos())
    if (info.name.starts_with(seam_error_prefix)) names.emplace_back(info.name.substr(seam_error_prefix.size()));
  return names;
}

std::vector<SeamErrors> find_seams(std::span<const Record> records) {
  const std::vector<std::string> bins = seam_bin_names();
  std::vector<SeamErrors> rows;
  for (const Record& r : records) {
    SeamErrors row{.record = &r, .errors = {}, .shares = {}, .near_share = {}, .near_part = {}};
    for (const std::string& bin : bins) {
      row.errors.push_back(r.metric(fmt::format("{}{}", seam_error_prefix, bin)));
      row.shares.push_back(r.metric(fmt::format("{}{}", seam_share_prefix, bin)));
    }
    if (r.status != Status::ok || !row.shares.front()) continue;
    row.near_share = 0;
    for (std::size_t k = 0; k < near_bins; ++k) *row.near_share += row.shares[k].value_or(0);
    const std::optional<double> near = error_of_bins(row, near_bins), all = error_of_bins(row, bins.size());
    if (near && all && *all > 0) row.near_part = *near / *all;
    rows.push_back(std::move(row));
  }
  if (rows.empty())
    throw Error(
        "no row of these records has seams: slices of cascaded_map, six faces of a map under a point light, both images of "
        "paraboloid_map and pages of virtual_map have, in runs of this version");
  return rows;
}

}  // namespace gnomon
