#pragma once
#include <map>
#include <set>

#include "analysis/analysis.h"

namespace gnomon {

// Rows that differ along one axis only: what growth and sweeps are made of.

/// Rows of one setting that are equal in everything but the axis.
struct AxisSeries {
  Place place;          ///< scene: the family, "sphere_field:count=*"; what the axis varies is 0 or empty
  std::string setting;  ///< without the parameter that the axis varies
  Role role = Role::contender;
  std::vector<std::pair<double, const Record*>> rows;  ///< x and row, in the order of the records
};

/// By scene reference, the family that the axis `triangles` joins it to: the reference with the parameters starred that change
/// how many triangles scenes of its id have, "sphere_field:count=*"; itself where there is none.
std::map<std::string, std::string> scene_families(std::span<const Record> records);

/// The numeric parameters of techniques and of scenes that these records have, in alphabetical order.
std::vector<std::string> numeric_parameters(std::span<const Record> records);
/// The unit that the registered techniques or scenes of these records declare for the parameter; "" where none does.
std::string parameter_unit(std::span<const Record> records, const std::string& parameter);

/// Whether a registered technique or scene of these records declares the numbers of the parameter for a logarithmic axis.
bool is_log_parameter(std::span<const Record> records, const std::string& parameter);

/// All series along "triangles", "pixels", "lights" (how many a row has together, of as many the first row; where no
/// row has several 1, 2, 3, ... in the order of the records) or a parameter, of the records
/// that `takes` accepts, in the order of their first ones. Records without a value on the axis belong to none.
std::vector<AxisSeries> join_series(std::span<const Record> records, const std::string& axis,
                                    const std::function<bool(const Record&)>& takes);

}  // namespace gnomon
