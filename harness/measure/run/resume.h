#pragma once
#include <set>
#include <span>
#include <string>
#include <vector>

#include "measure/record/record.h"
#include "measure/run/run.h"

namespace gnomon {

/// What a folder holds of a run that is to go on in it.
struct Earlier {
  std::vector<Record> kept;        ///< numbered as the suite numbers its rows now, in order of the file
  std::set<std::string> done;      ///< jobs of `kept`: they are not run again
  bool is_changed = false;         ///< the file does not hold `kept` as it is: rows went, or have new places
  std::vector<std::string> notes;  ///< what a reader of the table should know: other processors, other numbers of threads
};

/// Reads options.out; nothing where there are no records. A scene that was not fetched then and is now is run, and its old row
/// goes; so does a failed row of `jobs` when failed ones are to be tried again. Rows that cannot stand in one table with new
/// ones are an Error: of a scene that has changed since, of another commit, of another suite, and of the same one with other
/// processes, repetitions or truth; so is a folder none of whose rows the suite has. Where it has some, a note counts the rest.
/// `suite` are all jobs of the suite, `jobs` those that are asked for.
Earlier earlier_rows(const RunOptions& options, SceneLibrary& library, std::span<const Job> suite, std::span<const Job> jobs);

}  // namespace gnomon
