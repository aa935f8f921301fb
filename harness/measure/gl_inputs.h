#pragma once
#include "measure/fields.h"

namespace gnomon {

/// Uploads to OpenGL for a frame.
struct GlInputs {
  std::uint64_t input_bytes = 0;  ///< of the G-buffer and of depth, outside all stages
  double upload_ms = 0;
  /// The scene's triangles, where a stage uploaded them: a part of the memory; and triangles that no stage uploaded, in all of
  /// the worker's life, which are meant to be 0. Nothing of records from before these were counted.
  std::optional<std::uint64_t> geometry_bytes, loose_bytes;
};
void for_each_field(MaybeConst<GlInputs> auto& r, const auto& use) {
  use("input_bytes", r.input_bytes, "upload_ms", r.upload_ms);
  use("geometry_bytes", r.geometry_bytes, "loose_bytes", r.loose_bytes);
}

}  // namespace gnomon
