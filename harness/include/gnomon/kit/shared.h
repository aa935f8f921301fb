#pragma once
#include <gnomon/technique.h>

namespace gnomon {

/// What setup and build make of a technique, held by all its objects, one for each light: a member of it. The object that was
/// made first fills it; those for other lights, guests, look at the same.
///
///   struct Built { RayCasters casters; };
///   Shared<Built> built_;
///   std::unique_ptr<Technique> for_another_light() const override { return another(*this, &MyTechnique::built_); }
template <class Made>
class Shared {
 public:
  Made* operator->() const { return made_.get(); }
  Made& operator*() const { return *made_; }
  /// Of what it counts of the things shared, bytes above all, the part that this object answers for: all of it, a guest
  /// nothing.
  double own(double count) const { return is_guest_ ? 0 : count; }
  bool is_guest() const { return is_guest_; }
  Shared for_guest() const {
    Shared guest = *this;
    guest.is_guest_ = true;
    return guest;
  }

 private:
  std::shared_ptr<Made> made_ = std::make_shared<Made>();
  bool is_guest_ = false;
};

/// A fresh object of the same technique with the same settings, a guest in these members of `first`.
template <class T, class... Member>
std::unique_ptr<Technique> another(const T& first, Member... members) {
  auto object = std::make_unique<T>();
  object->set_id(first.id());
  object->apply(first.settings());
  ((object.get()->*members = (first.*members).for_guest()), ...);
  return object;
}

}  // namespace gnomon
