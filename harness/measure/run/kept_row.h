#pragma once
#include "measure/run/row.h"

namespace gnomon {

/// Where a kept row's masks were made, of today's scene: on a path at its last frame.
struct KeptPlace {
  FrameKey key;
  std::vector<Light> lights;
};
/// Throws Error when the scene lacks a light, the view or the path.
KeptPlace kept_place(const Record& record, const Scene& scene, Truth truth);

/// The reference's target for one of the record's lights, and which of its two numbers the mask is compared with.
AreaTarget target_of(const Record& record, std::size_t light);
LightShareKind estimates_of(const Record& record, std::size_t light);
/// How many pixels of a light's mask have which cause, as the record says; nothing when nobody asked.
const std::optional<std::map<std::string, std::uint64_t>>& known_causes(const Record& record, std::size_t light);

/// The masks in the channels LIGHT.WHAT of a record's file beside today's references, causes left out; not put together. Throws
/// Error on a file without them and on what is no visibility. The record outlives the row.
MeasuredRow kept_row(const Record& record, const std::filesystem::path& file, std::string_view what, const KeptPlace& place,
                     FrameStore& frames);
/// The causes in the channel LIGHT.cause. Throws Error on what is no cause.
std::vector<Cause> kept_causes(const Record& record, const std::filesystem::path& file, std::size_t light);

}  // namespace gnomon
