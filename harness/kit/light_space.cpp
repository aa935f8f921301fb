#include <gnomon/kit/light_space.h>

#include <utility>

namespace gnomon {

LightSpace::LightSpace(const glm::dvec3& light, const glm::dmat3& frame, OppositeFaces opposite, int first_axis)
    : face_count_(6), first_axis_(first_axis) {
  const LightFace own{light, frame, true};
  for (int k = 0; k < 3; ++k) {
    glm::dvec3 x = own.axis((k + 1) % 3), y = own.axis((k + 2) % 3);
    const glm::dvec3 z = own.axis(k);
    faces_[2 * k] = {light, frame_of(x, y, z), true};
    if (opposite == OppositeFaces::turned) y = -y;
    if (opposite == OppositeFaces::swapped) std::swap(x, y);
    faces_[2 * k + 1] = {light, frame_of(x, y, -z), true};
  }
}

}  // namespace gnomon
