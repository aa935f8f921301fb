#pragma once
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace gnomon {

/// Leaves elements unset where a vector would make them without arguments.
template <class T>
struct UnsetAllocator : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = UnsetAllocator<U>;
  };
  template <class U>
  void construct(U*) noexcept {}
  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
  }
};

/// A vector for large plain data: resize touches no memory, so that threads can fill it side by side. What is not written may
/// be anything.
template <class T>
using UnsetVector = std::vector<T, UnsetAllocator<T>>;

}  // namespace gnomon
