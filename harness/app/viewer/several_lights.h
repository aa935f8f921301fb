#pragma once
#include "app/viewer/picture_parts.h"

namespace gnomon::viewer {

// Several lights as one picture: what score/together.h makes of their masks, as the viewer keeps it.

/// The masks of several lights that follow each other in `all`.
std::vector<std::vector<float>> split_masks(std::span<const float> all, std::size_t lights);

struct ShownMasks {
  std::vector<float> mask;
  ChannelMasks channels;  ///< where the lights are channels
};
/// One mask a light of the frame, one pixel each of `gbuffer`, which is the frame's or a thinned one of it: the share of the
/// light that they would give together, all pixels taken as they are.
ShownMasks shown_together(const Frame& frame, const GBuffer& gbuffer, std::span<const std::vector<float>> masks);

/// Fills masks, errors and classes of a reference from its `lights`.
void put_together(ReferenceState& reference);

/// What the masks of an answer are judged by under light `k` of several. The reference is one that is put together.
Evidence evidence_of(const SideAnswer& answer, const ReferenceState& reference, LightShareKind estimates, std::size_t k);

/// The answer against the reference; with the causes under each light where these are found.
std::shared_ptr<const Together> put_together(const SideAnswer& answer, const ReferenceState& reference,
                                             LightShareKind estimates, std::span<const std::vector<Cause>> causes,
                                             std::span<const CauseInfo> own_causes = {});

}  // namespace gnomon::viewer
