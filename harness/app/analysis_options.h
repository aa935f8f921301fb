#pragma once
#include "app/app.h"
#include "report/analysis/analysis_table.h"

namespace gnomon::app {

/// Options that `analyze` and `figure` share; `cost` is the word of --cost.
void add_analysis_options(Command& command, AnalysisOptions& options, std::string& cost);

/// The positional words of `analyze` and `figure`: folders and a kind; `kinds` lists the command's for the help.
void add_kind_words(Command& command, std::vector<std::string>& words, const std::string& kinds);

/// Takes the kind of analysis or figure, the last of `words`, off the folders before it. Throws Error, which begins with `name`
/// of the command, when there is no folder or the words hold an option that this kind does not take; `kinds` are the command's.
std::string take_kind(std::vector<std::string>& words, const Command& command, const std::string& name,
                      const std::vector<std::string>& kinds);

/// The records of these folders, in order, that match --filter. A row that stands in several folders counts once, by its first
/// record, and stderr says how many did. Throws Error when two folders answer a job differently, and when there is no record.
std::vector<Record> read_runs(const std::vector<std::string>& dirs, const std::string& filter);

}  // namespace gnomon::app
