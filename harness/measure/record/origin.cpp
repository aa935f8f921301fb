#include "measure/record/origin.h"

namespace gnomon {

std::string plugin_hash(const Record& record) {
  const auto found = record.context.find("plugin");
  return found == record.context.end() || !found->is_object() ? "" : plain_text(found->value("hash", Json("")));
}

bool is_foreign(const Record& record) { return record.context.contains("foreign"); }

}  // namespace gnomon
