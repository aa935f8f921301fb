#pragma once
#include "app/app.h"
#include "report/analysis/analysis_table.h"

namespace gnomon::app {

/// Options that `analyze` and `figure` share; `cost` is the word of --cost.
void add_analysis_options(Command& command, AnalysisOptions& options, std::string& cost);

/// Throws Error when an option of analyses was given that this kind does not take; `kinds` are those of the command.
void require_taken(const Command& command, const std::string& kind, const std::vector<std::string>& kinds);

/// The records of these folders, in order, that match --filter. A row that stands in several folders counts once, by its first
/// record, and stderr says how many did. Throws Error when two folders answer a job differently, and when there is no record.
std::vector<Record> read_runs(const std::vector<std::string>& dirs, const std::string& filter);

}  // namespace gnomon::app
