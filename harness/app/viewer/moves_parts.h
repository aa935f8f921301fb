#pragma once
#include <gnomon/error.h>

#include <cmath>
#include <glm/glm.hpp>

#include "measure/scene/load.h"

namespace gnomon::viewer {

// What moves of the camera and of the light share.

/// Whether `check` accepts the view or light.
template <class Item>
bool is_valid(const Item& item) {
  try {
    check(item, "");
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// Whether a place is finite and within the limit of `check`, so that it may be cast: to cast more than float holds is
/// undefined.
inline bool is_castable(const glm::dvec3& p) {
  constexpr double largest = 1e30;
  return std::abs(p.x) <= largest && std::abs(p.y) <= largest && std::abs(p.z) <= largest;
}

}  // namespace gnomon::viewer
