#pragma once
#include <cstdint>
#include <optional>

#include "measure/fields.h"

namespace gnomon {

/// What went up to OpenGL for a frame.
struct GlInputs {
  std::uint64_t input_bytes = 0;  ///< of the G-buffer and of depth, outside all stages
  double upload_ms = 0;
  /// The scene's triangles, where a stage uploaded them: a part of the memory; and triangles that no stage uploaded, in all of
  /// the worker's life, which are meant to be 0. Nothing of records from before these were counted.
  std::optional<std::uint64_t> geometry_bytes, loose_bytes;
};
void for_each_field(MaybeConst<GlInputs> auto& gl, const auto& use) {
  use("input_bytes", gl.input_bytes);
  use("upload_ms", gl.upload_ms);
  use("geometry_bytes", gl.geometry_bytes);
  use("loose_bytes", gl.loose_bytes);
}

}  // namespace gnomon
