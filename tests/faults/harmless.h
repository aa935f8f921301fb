#pragma once
// What the faulty techniques of this folder share: everything goes well, until one of them misbehaves in one stage.
#include <gnomon/registry.h>

#include <algorithm>

class Harmless : public gnomon::Technique {
 public:
  gnomon::Support supports(const gnomon::Scene&, const gnomon::Light&, const gnomon::View&) const override {
    return gnomon::Support::full();
  }
  void setup() override {}
  void build(const gnomon::Scene&) override {}
  void relight(const gnomon::Light&) override {}
  void resolve(const gnomon::GBuffer&, gnomon::VisibilityMask& mask) override { std::ranges::fill(mask.pixels(), 1.0f); }
  gnomon::Counts counts() const override { return {}; }
};
