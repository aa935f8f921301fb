#pragma once
#include "app/viewer/moves.h"
#include "app/viewer/picture_drawing.h"

namespace gnomon::viewer {

/// The words over the picture: the names of the sides in their upper corners, why an answer is approximate, what a side waits
/// for or why it has no answer, and the name of the light beside its handle. None covers another: notices lie below names, and
/// the light's name is where there is room, or nowhere.
void draw_labels(const PictureDrawing& drawing, const Session& session, const PanelData& shown,
                 const std::optional<Handle>& light);

}  // namespace gnomon::viewer
