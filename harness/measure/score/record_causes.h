#pragma once
#include "measure/cause/causes.h"
#include "measure/record/record.h"

namespace gnomon {

/// The causes of its technique's own in a record. They refer to the record's texts.
std::vector<CauseInfo> own_causes(const Record& record);
/// The common causes, then those that techniques of these records have of their own, each name once, by its first record. A
/// name's place in this list is its number among rows of several techniques. They refer to the records' texts.
std::vector<CauseInfo> causes_of(std::span<const Record* const> records);
std::vector<CauseInfo> causes_of(std::span<const Record> records);

}  // namespace gnomon
