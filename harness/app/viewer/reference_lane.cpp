#include "app/viewer/reference_lane.h"

#include <tbb/task_group.h>

#include "app/viewer/several_lights.h"
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
  const auto arrays = std::make_shared<Arrays>();
  GBuffer few = g;
  few.width = (g.width + step - 1) / step;
  few.height = (g.height + step - 1) / step;
  const auto thin = [&](auto& pixels, auto& kept) {
    kept.reserve(few.size());
    for (int y = 0; y < g.height; y += step)
      for (int x = 0; x < g.width; x += step) kept.push_back(pixels[static_cast<std::size_t>(y) * g.width + x]);
    pixels = kept;
  };
  std::span<const float>* const floats[] = {&few.px, &few.py, &few.pz, &few.nx, &few.ny, &few.nz};
  for (int k = 0; k < 6; ++k) thin(*floats[k], arrays->floats[k]);
  thin(few.mesh, arrays->ids[0]);
  thin(few.triangle, arrays->ids[1]);
  few.storage = arrays;
  return few;
}

/// Good enough to move by, under a light with area.
constexpr AreaTarget quick{.error = 0.02, .cap = 256};

std::vector<float> trace(const RayScene& casters, const Scene& scene, const GBuffer& pixels, const Light& light,
                         const AreaTarget& target) {
  std::vector<float> mask(pixels.size());
  if (has_area(light))
    trace_shares(casters, scene, pixels, light, target, mask);
  else
    trace_shadows(casters, scene, pixels, light, mask);
  return mask;
}

/// The hash of the frame's pose; empty at rest.
/// Of its exact shapes each animation leaves others.
std::string pose_of(const Frame& frame) {
  return frame.pose ? frame.pose->hash + " " + frame.pose->at.animation : std::string();
}

/// Why there is no reference under a frame's lights; empty when there is one.
std::string obstacle(const Frame& frame) {
  for (const Light& light : frame.all_lights())
    if (const Support support = reference_support(frame.scene(light), light, frame.gbuffer.view); !support)
      return frame.is_together() ? fmt::format("{}: {}", light.name, support.why()) : support.why();
  return "";
}

/// Classes under one light, and under one with area the shares.
void find_classes(const Frame& frame, const Light& light, ReferenceState& reference) {
  const Scene& scene = frame.scene(light);
  const RayScene& casters = frame.casters(light);
  const std::vector<std::uint8_t> silhouettes = find_silhouettes(frame.everything(frame.gbuffer.truth), frame.gbuffer);
  if (!has_area(light)) {
    reference.classes = classify(scene, casters, frame.gbuffer, light, reference.mask, silhouettes);
    return;
  }
  SoftReference soft = trace_soft(scene, casters, frame.gbuffer, light, silhouettes, {});
  reference.mask = std::move(soft.area);
  reference.error = std::move(soft.area_error);
  reference.irradiance = std::move(soft.irradiance);
  reference.irradiance_error = std::move(soft.irradiance_error);
  reference.half = std::move(soft.area_half);
  reference.irradiance_half = std::move(soft.irradiance_half);
  reference.classes = std::move(soft.classes);
}

}  // namespace

Work ReferenceLane::next() {
  const auto& frame = board_.state.frame;
  if (!frame || frame->number == refined_) return {};
  const auto& known = board_.state.reference;
  const bool is_moving = board_.selection.is_moving;
  const bool is_traced = known && known->frame == frame && known->mask.size() == frame->gbuffer.size();
  // Classes and the rest are worth their time only when they stay.
  if (is_traced && is_moving) return {};
  return [this, frame, known = is_traced ? known : nullptr, ticket = refinement_.ticket(), is_moving] {
    try {
      known ? complete_reference(*known, ticket) : trace_reference(frame, is_moving, ticket);
    } catch (const std::exception& error) {
      publish_none(frame, message_of(error));  // a full disk or no memory: tried again at the next frame
    }
  };
}

/// Makes it the newest of the state.
std::shared_ptr<const ReferenceState> ReferenceLane::publish(ReferenceState reference) {
  const auto published = std::make_shared<const ReferenceState>(std::move(reference));
  board_.change([&](EngineState& s) {
    s.reference = published;
    if (published->is_complete) refined_ = published->frame->number;
  });
  return published;
}

void ReferenceLane::publish_none(const std::shared_ptr<const Frame>& frame, const std::string& why_not) {
  ReferenceState none;
  none.frame = frame;
  none.why_not = why_not;
  none.is_complete = true;
  publish(std::move(none));
}

/// The remembered reference at a frame under one of its lights; null where there is none.
std::shared_ptr<const ReferenceState> ReferenceLane::known_reference(const Frame& frame, const Light& light) {
  const GBuffer& g = frame.gbuffer;
  const std::vector<std::byte> seen = light_and_view_bytes(light, g.view);
  const auto found = std::ranges::find_if(known_references_, [&](const KnownReference& known) {
    return known.truth == g.truth && known.reference->width == g.width && known.reference->height == g.height &&
           known.pose == pose_of(frame) && known.light_and_view == seen;
  });
  if (found == known_references_.end()) return nullptr;
  std::rotate(known_references_.begin(), found, found + 1);
  return known_references_.front().reference;
}

/// Those of the frame that was completed last are kept in any case.
void ReferenceLane::remember(const Frame& frame, const Light& light, std::shared_ptr<const ReferenceState> reference) {
  const std::size_t more = frame.all_lights().size() - 1, most = most_known + more,
                    most_pixels = most_known_pixels + more * frame.gbuffer.size();
  known_references_.push_front({frame.loaded, pose_of(frame), light_and_view_bytes(light, frame.gbuffer.view),
                                frame.gbuffer.truth, std::move(reference)});
  std::size_t pixels = 0;
  for (const KnownReference& known : known_references_) pixels += known.reference->mask.size();
  while (known_references_.size() > 1 && (known_references_.size() > most || pixels > most_pixels)) {
    pixels -= known_references_.back().reference->mask.size();
    known_references_.pop_back();
  }
}

/// The mask under one light, as it was where neither light nor pixels have changed since the frame before.
std::vector<float> ReferenceLane::trace_light(const Frame& frame, const GBuffer& pixels, int step, const Light& light) {
  const auto traced = [&] { return trace(frame.casters(light), frame.scene(light), pixels, light, quick); };
  if (!frame.is_together()) return traced();
  if (const auto known = step == 1 ? known_reference(frame, light) : nullptr) return known->mask;
  if (traced_pixels_ != frame.gbuffer.storage) traced_masks_.clear();
  traced_pixels_ = frame.gbuffer.storage;
  const std::pair key{light.name, step};
  const auto found = traced_masks_.find(key);
  if (found != traced_masks_.end() && are_same(found->second.light, light)) return found->second.mask;
  std::vector<float> mask = traced();
  if (!tbb::is_current_task_group_canceling()) traced_masks_[key] = {light, mask};
  return mask;
}

/// The mask; all of the reference where it is remembered.
void ReferenceLane::trace_reference(const std::shared_ptr<const Frame>& frame, bool is_moving, std::uint64_t ticket) {
  if (const std::string why_not = obstacle(*frame); !why_not.empty()) return publish_none(frame, why_not);
  ReferenceState reference;
  const GBuffer& g = frame->gbuffer;
  std::erase_if(known_references_,
                [&](const KnownReference& known) { return known.loaded != frame->loaded; });  // a scene may be large
  std::vector<std::shared_ptr<const ReferenceState>> known;
  for (const Light& light : frame->all_lights()) known.push_back(known_reference(*frame, light));
  const bool is_known = std::ranges::all_of(known, [](const auto& one) { return one != nullptr; });
  if (is_known && !frame->is_together()) reference = *known[0];
  reference.frame = frame;
  if (is_known) {
    if (frame->is_together()) {
      reference.lights = std::move(known);
      put_together(reference);
      reference.is_complete = true;
    }
    publish(std::move(reference));
    return;
  }

  const auto trace_pixels = [&](const GBuffer& pixels, int step) {
    std::vector<std::vector<float>> masks;
    const auto start = Clock::now();
    const auto trace_all = [&] {
      for (const Light& light : frame->all_lights()) masks.push_back(trace_light(*frame, pixels, step, light));
    };
    // While something moves, the techniques come first: the other half of the cores is theirs alone.
    bool is_done = false;
    const auto run = [&] { is_done = refinement_.run(ticket, trace_all); };
    is_moving ? half_the_cores_.execute(run) : run();
    if (!is_done) return false;
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    rays_per_ms_ = static_cast<double>(pixels.size()) / std::max(ms, 1e-3);
    ShownMasks shown = frame->is_together() ? shown_together(*frame, pixels, masks) : ShownMasks{std::move(masks[0]), {}};
    reference.mask = std::move(shown.mask);
    reference.channels = std::move(shown.channels);
    reference.width = pixels.width;
    reference.height = pixels.height;
    return true;
  };
  // While something moves, it begins coarse enough to appear with the next picture.
  const double most_ms = is_moving ? moving_ms : long_ms;
  const double shown_first = static_cast<double>(g.size()) / (most_ms * std::max(rays_per_ms_, 1e-3));
  for (const int step : {8, 4, 2}) {
    const bool is_needed = is_moving ? shown_first > step * step / 4.0 : frame->is_full() && shown_first > 1;
    if (!is_needed) continue;
    if (!trace_pixels(thinned(g, step), step)) return;
    publish(reference);
  }
  if (!trace_pixels(g, 1)) return;
  reference.is_complete = !frame->is_full();
  publish(std::move(reference));
}

/// The nearest casters under one light, and the mask on the meshes where the scene has curved shapes. `mesh_frame` is made
/// then, if it is null.
void ReferenceLane::find_nearest(const Frame& frame, const Light& light, std::shared_ptr<Frame>& mesh_frame,
                                 ReferenceState& reference) {
  const Scene& scene = frame.scene(light);
  const GBuffer& g = frame.gbuffer;
  reference.nearest_caster = find_nearest_casters(scene, frame.casters(light), g, light, reference.mask);
  if (g.truth == Truth::mesh || !scene.has_curved_shapes()) return;
  if (!mesh_frame) {
    mesh_frame = std::make_shared<Frame>();
    mesh_frame->loaded = frame.loaded;
    mesh_frame->pose = frame.pose;
    mesh_frame->posed = frame.posed;
    mesh_frame->gbuffer = make_gbuffer(scene, frame.everything(Truth::mesh), g.view, g.width, g.height, Truth::mesh);
    mesh_frame->file = board_.write_shared(mesh_frame->gbuffer);
  }
  auto on_mesh = std::make_shared<ReferenceState>();
  on_mesh->mask = trace(frame.casters(light, Truth::mesh), scene, mesh_frame->gbuffer, light, {});
  on_mesh->frame = mesh_frame;
  reference.on_mesh = on_mesh;
}

/// Classes, nearest casters, and the mask on the meshes where the scene has curved shapes; under each light.
void ReferenceLane::complete_reference(ReferenceState reference, std::uint64_t ticket) {
  const std::shared_ptr<const Frame> frame = reference.frame;
  std::shared_ptr<Frame> mesh_frame;
  if (!frame->is_together()) {
    if (!refinement_.run(ticket, [&] { find_classes(*frame, frame->light, reference); })) return;
    publish(reference);
    if (!refinement_.run(ticket, [&] { find_nearest(*frame, frame->light, mesh_frame, reference); })) return;
    reference.is_complete = true;
    auto bare = std::make_shared<ReferenceState>(*publish(std::move(reference)));
    bare->frame.reset();
    remember(*frame, frame->light, bare);
    return;
  }
  for (const Light& light : frame->all_lights()) {
    std::shared_ptr<const ReferenceState> known = known_reference(*frame, light);
    if (!known) {
      auto own = std::make_shared<ReferenceState>();
      const bool is_done = refinement_.run(ticket, [&] {
        own->mask = trace_light(*frame, frame->gbuffer, 1, light);
        find_classes(*frame, light, *own);
        find_nearest(*frame, light, mesh_frame, *own);
      });
      if (!is_done) return;
      own->width = frame->gbuffer.width;
      own->height = frame->gbuffer.height;
      own->is_complete = true;
      remember(*frame, light, own);
      known = own;
    }
    reference.lights.push_back(known);
  }
  put_together(reference);
  traced_masks_.clear();
  reference.is_complete = true;
  publish(std::move(reference));
}

}  // namespace gnomon::viewer
