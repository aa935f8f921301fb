// Computes the reference at each frame, coarse first, and what scoring needs of it.
#include <tbb/task_group.h>

#include <algorithm>

#include "app/viewer/engine_body.h"
#include "measure/frame/frame.h"
#include "measure/frame/light_rays.h"
#include "measure/notice.h"

namespace gnomon::viewer {

namespace {

constexpr std::size_t most_known = 8, most_known_pixels = std::size_t{8} << 20;  // references that are remembered
constexpr double long_ms = 60;    // a reference that takes longer is shown coarse first
constexpr double moving_ms = 12;  // while something moves, beside the sides' own work

/// Every `step`-th pixel of a G-buffer.
GBuffer thinned(const GBuffer& g, int step) {
  struct Arrays {
    std::vector<float> floats[6];
    std::vector<std::uint32_t> ids[2];
  };
  auto arrays = std::make_shared<Arrays>();
  const int width = (g.width + step - 1) / step, height = (g.height + step - 1) / step;
  const std::span<const float> floats[] = {g.px, g.py, g.pz, g.nx, g.ny, g.nz};
  const std::span<const std::uint32_t> ids[] = {g.mesh, g.triangle};
  const auto thin = [&](const auto& from, auto& to) {
    to.reserve(static_cast<std::size_t>(width) * height);
    for (int y = 0; y < g.height; y += step)
      for (int x = 0; x < g.width; x += step) to.push_back(from[static_cast<std::size_t>(y) * g.width + x]);
  };
  for (int k = 0; k < 6; ++k) thin(floats[k], arrays->floats[k]);
  for (int k = 0; k < 2; ++k) thin(ids[k], arrays->ids[k]);
  const Arrays& a = *arrays;
  return {g.view,      g.truth,     width,       height,   a.floats[0], a.floats[1], a.floats[2],
          a.floats[3], a.floats[4], a.floats[5], a.ids[0], a.ids[1],    arrays};
}

/// Good enough to move by, under a light with area.
constexpr AreaTarget quick{.error = 0.02, .cap = 256};

void trace(const RayScene& casters, const Frame& frame, const GBuffer& pixels, const AreaTarget& target,
           std::vector<float>& mask) {
  mask.resize(pixels.size());
  if (has_area(frame.light))
    trace_shares(casters, frame.scene(), pixels, frame.light, target, mask);
  else
    trace_shadows(casters, frame.scene(), pixels, frame.light, mask);
}

}  // namespace

bool Interruptible::run(std::uint64_t ticket, const std::function<void()>& work) {
  tbb::task_group_context context(tbb::task_group_context::isolated);
  tbb::task_group group(context);
  {
    const std::lock_guard lock(mutex_);
    if (ticket != ticket_) return false;
    cancel_ = [&] { context.cancel_group_execution(); };
  }
  struct Done {
    Interruptible& self;
    ~Done() {
      const std::lock_guard lock(self.mutex_);
      self.cancel_ = nullptr;
    }
  } const done{*this};
  return group.run_and_wait(work) != tbb::canceled;
}

void Interruptible::give_up() {
  const std::lock_guard lock(mutex_);
  ++ticket_;
  if (cancel_) cancel_();
}

Engine::Body::Work Engine::Body::next_reference() {
  const auto& frame = state.frame;
  if (!frame || frame->number == refined) return {};
  const auto& known = state.reference;
  const bool is_traced = known && known->frame == frame && known->mask.size() == frame->gbuffer.size();
  // Classes and the rest are worth their time only when they stay.
  if (is_traced && selection.is_moving) return {};
  return [this, frame, known = is_traced ? known : nullptr, ticket = refinement.ticket(), is_moving = selection.is_moving] {
    try {
      known ? complete_reference(*known, ticket) : trace_reference(frame, is_moving, ticket);
    } catch (const std::exception& error) {
      // A full disk or no memory: said, and tried again at the next frame.
      ReferenceState none;
      none.frame = frame;
      none.why_not = message_of(error);
      none.is_complete = true;
      publish(std::move(none));
    }
  };
}

/// Makes it the newest of the state.
std::shared_ptr<const ReferenceState> Engine::Body::publish(ReferenceState reference) {
  const auto published = std::make_shared<const ReferenceState>(std::move(reference));
  change([&](EngineState& s) {
    s.reference = published;
    if (published->is_complete) refined = published->frame->number;
  });
  return published;
}

/// The mask; all of the reference where it is known from before.
void Engine::Body::trace_reference(const std::shared_ptr<const Frame>& frame, bool is_moving, std::uint64_t ticket) {
  ReferenceState reference;
  reference.frame = frame;
  if (const Support support = reference_support(frame->scene(), frame->light, frame->gbuffer.view); !support) {
    reference.why_not = support.why();
    reference.is_complete = true;
    publish(std::move(reference));
    return;
  }
  const GBuffer& g = frame->gbuffer;
  std::erase_if(known_references,
                [&](const KnownReference& known) { return known.loaded != frame->loaded; });  // a scene may be large
  const std::vector<std::byte> seen = light_and_view_bytes(frame->light, g.view);
  const auto is_same = [&](const KnownReference& known) {
    return known.truth == g.truth && known.reference->width == g.width && known.reference->height == g.height &&
           known.light_and_view == seen;
  };
  if (const auto found = std::ranges::find_if(known_references, is_same); found != known_references.end()) {
    std::rotate(known_references.begin(), found, found + 1);
    reference = *known_references.front().reference;
    reference.frame = frame;
    publish(std::move(reference));
    return;
  }

  const RayScene& casters = frame->loaded->store->casters(g.truth);
  const auto trace_pixels = [&](const GBuffer& pixels) {
    std::vector<float> mask;
    const auto start = Clock::now();
    if (!refinement.run(ticket, [&] { trace(casters, *frame, pixels, quick, mask); })) return false;
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    rays_per_ms = static_cast<double>(pixels.size()) / std::max(ms, 1e-3);
    reference.mask = std::move(mask);
    reference.width = pixels.width;
    reference.height = pixels.height;
    return true;
  };
  // While something moves it begins as coarse as it must be to be there with the next picture.
  const double shown_first = static_cast<double>(g.size()) / ((is_moving ? moving_ms : long_ms) * std::max(rays_per_ms, 1e-3));
  for (const int step : {8, 4, 2}) {
    const bool is_needed = is_moving ? shown_first > step * step / 4.0 : frame->is_full() && shown_first > 1;
    if (!is_needed) continue;
    if (!trace_pixels(thinned(g, step))) return;
    publish(reference);
  }
  if (!trace_pixels(g)) return;
  reference.is_complete = !frame->is_full();
  publish(std::move(reference));
}

/// Classes, occluders, and the same on the meshes where the scene has curved shapes.
void Engine::Body::complete_reference(ReferenceState reference, std::uint64_t ticket) {
  const std::shared_ptr<const Frame> frame = reference.frame;
  const Scene& scene = frame->scene();
  const GBuffer& g = frame->gbuffer;
  const RayScene& casters = frame->loaded->store->casters(g.truth);
  std::vector<PixelClass> classes;
  const auto find_classes = [&] {
    if (!has_area(frame->light)) {
      classes = classify(scene, casters, g, frame->light, reference.mask);
      return;
    }
    SoftReference soft = trace_soft(scene, casters, g, frame->light, {});
    reference.mask = std::move(soft.area);
    reference.error = std::move(soft.area_error);
    reference.irradiance = std::move(soft.irradiance);
    reference.irradiance_error = std::move(soft.irradiance_error);
    classes = std::move(soft.classes);
  };
  if (!refinement.run(ticket, find_classes)) return;
  reference.classes = std::move(classes);
  publish(reference);
  std::vector<std::uint32_t> nearest_caster;
  std::shared_ptr<ReferenceState> on_mesh;
  const bool is_done = refinement.run(ticket, [&] {
    nearest_caster = find_nearest_casters(scene, casters, g, frame->light, reference.mask);
    if (g.truth == Truth::mesh || !scene.has_curved_shapes()) return;
    auto mesh_frame = std::make_shared<Frame>();
    mesh_frame->loaded = frame->loaded;
    mesh_frame->light = frame->light;
    mesh_frame->gbuffer =
        make_gbuffer(scene, frame->loaded->store->everything(Truth::mesh), g.view, g.width, g.height, Truth::mesh);
    on_mesh = std::make_shared<ReferenceState>();
    trace(frame->loaded->store->casters(Truth::mesh), *mesh_frame, mesh_frame->gbuffer, {}, on_mesh->mask);
    on_mesh->frame = mesh_frame;
    mesh_frame->file = write_shared(mesh_frame->gbuffer);
  });
  if (!is_done) return;
  reference.nearest_caster = std::move(nearest_caster);
  reference.on_mesh = on_mesh;
  reference.is_complete = true;
  auto bare = std::make_shared<ReferenceState>(*publish(std::move(reference)));
  bare->frame.reset();
  known_references.push_front({frame->loaded, light_and_view_bytes(frame->light, g.view), g.truth, bare});
  std::size_t pixels = 0;
  for (const KnownReference& known : known_references) pixels += known.reference->mask.size();
  while (known_references.size() > 1 && (known_references.size() > most_known || pixels > most_known_pixels)) {
    pixels -= known_references.back().reference->mask.size();
    known_references.pop_back();
  }
}

}  // namespace gnomon::viewer
