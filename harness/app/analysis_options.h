#pragma once
#include "app/app.h"
#include "report/analysis/analysis_table.h"

namespace gnomon::app {

/// Options that `analyze` and `figure` share; `cost` is the word of --cost.
void add_analysis_options(CLI::App* command, AnalysisOptions& options, std::string& cost);

/// The records of these folders, in order, that match --filter. Throws Error when none does.
std::vector<Record> read_runs(const std::vector<std::string>& dirs, const std::string& filter);

}  // namespace gnomon::app
