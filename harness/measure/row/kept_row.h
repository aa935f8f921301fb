#pragma once
#include "measure/row/row.h"

namespace gnomon {

/// Frames of a row on a path; 1 of a still, and where the record has no curves of its metrics.
int frame_count(const Record& record);

/// The frame of a kept row's masks in today's scene: on a path the last one.
struct KeptPlace {
  FrameKey key;
  std::vector<Light> lights;
};
/// `posed` moves the scene to where it is in that frame, and back to rest for a row whose geometry stands still; null where
/// there are no others. Throws Error when the scene lacks a light, the view, the path or the animation.
KeptPlace kept_place(const Record& record, const Scene& scene, Truth truth, PosedScene* posed = nullptr);

/// Which of the reference's two numbers the light's mask is compared with.
LightShareKind estimates_of(const Record::LightFacts& light);

/// The masks in the channels LIGHT.WHAT of a record's file beside today's references, causes left out; not put together. Throws
/// Error on a file without them and on what is no visibility. The record outlives the row.
MeasuredRow kept_row(const Record& record, const std::filesystem::path& file, std::string_view what, const KeptPlace& place,
                     FrameStore& frames);
/// The causes in the channel LIGHT.cause of one of the record's lights. Throws Error on what is no cause.
std::vector<Cause> kept_causes(const Record& record, const std::filesystem::path& file, const Record::LightFacts& light);

}  // namespace gnomon
