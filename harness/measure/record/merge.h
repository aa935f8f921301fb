#pragma once
#include "measure/record/record.h"

namespace gnomon {

/// A job that two folders answer differently: one table cannot have both.
struct MergeConflict {
  std::string job, title;                ///< "SCENE LIGHT [VIEW] [PATH] TECHNIQUE:SETTINGS", as in --dry-run
  std::filesystem::path first, second;   ///< folders, in the order given
  std::vector<std::string> differences;  ///< "metrics.shape.wrong_rate: 0.1, 0.2"
};

/// A record and the folder that its pictures lie in.
struct MergedRow {
  Record record;
  std::filesystem::path folder;
};

struct Merge {
  std::vector<MergedRow> rows;           ///< suites in order of first appearance; within one by `place`, then as given
  std::size_t duplicate_count = 0;       ///< rows left out because another folder has the same one
  std::vector<MergeConflict> conflicts;  ///< the row of the first folder is among `rows`, or of the last with prefer_last
  std::vector<std::string> notes;        ///< for readers of the table: mixed machines, missing rows
};

/// Differences in facts that must be the same whenever a job is run: status, support, reason, parameters, sizes, classes,
/// metrics, causes, frames, the scene's content and the commit of the program. Times, memory and machine may differ. Empty:
/// none.
std::vector<std::string> differences(const Record& a, const Record& b);

/// Records of several runs, folder by folder, as the records of one. A job in several folders counts once: by its first record
/// or, with `prefer_last`, by its last one. Same runs in the same order, same answer.
Merge merge_records(std::span<const std::pair<std::filesystem::path, std::vector<Record>>> runs, bool prefer_last = false);

/// Throws Error unless `out` can become the folder of a merged run: it is not there, or is an empty folder.
void require_free(const std::filesystem::path& out);

/// Writes the rows to `out` and copies their pictures byte by byte. The folder is made under another name beside it, `finish`
/// adds other files to it, and a rename makes it visible: it is there whole or not at all. Returns how many pictures are named
/// in records but missing from their folder. Throws Error on a path that leaves its folder and on two rows that name one file.
std::size_t write_merge(const Merge& merge, const std::filesystem::path& out,
                        const std::function<void(const std::filesystem::path& folder)>& finish);

}  // namespace gnomon
