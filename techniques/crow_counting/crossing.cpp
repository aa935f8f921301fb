#include "crossing.h"

namespace gnomon::crow_counting {

Meeting meet_side(const glm::vec3& from, const glm::vec3& to, const glm::vec3& a, const glm::vec3& b, const glm::dvec4& light) {
  const int of_from = orient3d_sign(from, a, b, light), of_to = orient3d_sign(to, a, b, light);
  if (of_from == 0) return of_to == 0 ? Meeting::unclear : Meeting::none;
  if (of_to == of_from) return Meeting::none;
  const int turn = -of_from;
  const int behind = turn * orient3d_sign(from, to, a, b);
  if (behind <= 0) return Meeting::none;
  const int beside_a = turn * orient3d_sign(from, to, a, light), beside_b = -turn * orient3d_sign(from, to, b, light);
  if (beside_a < 0 || beside_b < 0) return Meeting::none;
  if (of_to == 0) return Meeting::touches;
  return beside_a == 0 || beside_b == 0 ? Meeting::unclear : Meeting::crosses;
}

Meeting meet_cap(const glm::vec3& from, const glm::vec3& to, const Triangle& triangle, const glm::dvec4& light, int facing) {
  const glm::vec3* corners = triangle.points;
  const int of_from = orient3d_sign(corners[0], corners[1], corners[2], from);
  int of_to = orient3d_sign(corners[0], corners[1], corners[2], to);
  if (of_to == 0) of_to = facing;
  if (of_from == 0 || of_from == of_to) return Meeting::none;
  bool unclear = false;
  for (int k = 0; k < 3; ++k) {
    const glm::vec3 &a = corners[k], &b = corners[(k + 1) % 3];
    int inside = of_to * orient3d_sign(from, to, a, b);
    if (inside == 0) inside = of_to * orient3d_sign(from, a, b, light);
    if (inside < 0) return Meeting::none;
    unclear |= inside == 0;
  }
  return unclear ? Meeting::unclear : Meeting::crosses;
}

}  // namespace gnomon::crow_counting
