#include "measure/record/withdraw.h"

#include <cstdlib>

namespace gnomon {

void forget_results(Record& record) {
  record.stages = {};
  record.iterations.clear();
  record.stop.clear();
  record.counts.clear();
  record.bytes.reset();
  record.peak_bytes.reset();
  record.gl.reset();
  record.classes.clear();
  record.metrics.clear();
  record.causes.reset();
  record.frames.clear();
  record.mask.reset();
  record.error_picture.reset();
  record.shaded_picture.reset();
}

void withdraw(Record& record, const std::string& reason) {
  forget_results(record);
  record.status = Status::unsupported;
  record.support = Support::Kind::unsupported;
  record.reason = reason;
}

void withdraw_false_reference(Record& record) {
  constexpr int last_hard_frames = 5;
  const bool has_area = record.light_kind == "rect" || record.light_kind == "disc" || record.light_kind == "sphere";
  if (record.status != Status::ok || !has_area || std::atoi(context_text(record, "frames").c_str()) > last_hard_frames) return;
  withdraw(record, "it was scored against the hard shadow of the light's center, and the light has an area");
}

}  // namespace gnomon
