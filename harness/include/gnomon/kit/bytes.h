#pragma once
#include <cstddef>

namespace gnomon {

/// Bytes of the elements of vectors, for the count "bytes". Their room beyond is left out: it depends on what they held before.
template <class... Vector>
std::size_t bytes_of(const Vector&... vectors) {
  return ((vectors.size() * sizeof(typename Vector::value_type)) + ...);
}

}  // namespace gnomon
