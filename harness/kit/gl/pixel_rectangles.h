#pragma once
#include <gnomon/kit/gl/gl.h>

#include <functional>

namespace gnomon {

/// Few rectangles without a pixel in common that hold all pixels for which wanted(index): strips of 16 rows from
/// their first wanted column to their last, joined so that the area drawn, with a thousand pixels for each rectangle's own
/// draw, is least.
std::vector<PixelRectangle> rectangles_around(int width, int height, const std::function<bool(std::size_t)>& wanted);

}  // namespace gnomon
