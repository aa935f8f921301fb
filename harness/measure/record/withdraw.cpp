#include "measure/record/withdraw.h"

#include <cstdlib>
#include <type_traits>

namespace gnomon {

void forget_results(Record& r) {
  const auto empty = [](auto&... fields) { ((fields = std::decay_t<decltype(fields)>()), ...); };
  empty(r.stages, r.iterations, r.stop, r.counts, r.bytes, r.peak_bytes, r.gl, r.classes, r.metrics, r.causes, r.frames, r.mask,
        r.error_picture, r.shaded_picture);
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
