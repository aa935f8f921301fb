#include "measure/score/record_causes.h"

#include <algorithm>

#include "measure/cause/own_causes.h"

namespace gnomon {

std::vector<CauseInfo> own_causes(const Record& record) {
  std::vector<CauseInfo> rows;
  for (const Record::OwnCauseFacts& cause : record.own_causes)
    rows.push_back({own_cause(rows.size()), cause.name, cause.sentence, cause.color});
  return rows;
}

std::vector<CauseInfo> causes_of(std::span<const Record* const> records) {
  std::vector<CauseInfo> all = with_common({});
  for (const Record* record : records)
    for (const CauseInfo& info : own_causes(*record))
      if (std::ranges::find(all, info.name, &CauseInfo::name) == all.end()) all.push_back(info);
  return all;
}

std::vector<CauseInfo> causes_of(std::span<const Record> records) {
  std::vector<const Record*> all;
  for (const Record& record : records) all.push_back(&record);
  return causes_of(all);
}

}  // namespace gnomon
