#pragma once
// Lights everything, and tells a cause of one half of a picture; of the other half nothing.
#include <string>

#include "faults/harmless.h"

class NamesHalf : public Harmless {
 public:
  enum class Half { left, right };
  NamesHalf(Half half, std::string cause) : half_(half), cause_(std::move(cause)) {}

  void resolve(const gnomon::GBuffer& gbuffer, gnomon::VisibilityMask& mask) override {
    Harmless::resolve(gbuffer, mask);
    width_ = static_cast<std::size_t>(gbuffer.width);
  }
  std::optional<gnomon::Explanation> explain(std::size_t index) const override {
    gnomon::Explanation why;
    if ((index % width_ < width_ / 2) == (half_ == Half::left)) why.cause = cause_;
    return why;
  }

 private:
  Half half_;
  std::string cause_;
  std::size_t width_ = 1;
};
