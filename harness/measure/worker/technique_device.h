#pragma once
#include <gnomon/technique.h>

#include <memory>
#include <set>

#include "measure/worker/protocol.h"

namespace gnomon {

class DeviceStopwatch;

/// What a technique is drawn by, as About::device names it: its state, clock, limits and inputs. All that the harness knows of
/// a device stands behind this; a further one derives from it and has a line in `device_of`. As it is, it is the processor,
/// which needs none of it. Calls come from the thread that made it, on which stages may be called from then on.
class TechniqueDevice {
 public:
  using Scenes = std::set<const Scene*>;

  TechniqueDevice() = default;
  TechniqueDevice(const TechniqueDevice&) = delete;
  TechniqueDevice& operator=(const TechniqueDevice&) = delete;
  virtual ~TechniqueDevice() = default;

  /// Why there is no such device on this machine; empty: there is one. No stage may be called where it is missing.
  virtual std::string missing() const { return {}; }
  /// What draws, for records; nothing where the processor alone works.
  virtual std::optional<WorkerGl> description() const { return {}; }
  /// Present state of the card: WorkerGl::card.
  virtual std::optional<Json> card() const { return {}; }
  /// Textures and buffers lie in memory of its own, which is none of the process.
  virtual bool has_own_memory() const { return false; }
  /// Whether the inputs of such a picture have room there.
  virtual Support within_limits([[maybe_unused]] const Scene& scene, [[maybe_unused]] int width,
                                [[maybe_unused]] int height) const {
    return Support::full();
  }

  /// Waits for all work that was begun.
  virtual void finish() {}
  /// By its own clock; null where that is missing or unreliable.
  virtual DeviceStopwatch* stopwatch() { return nullptr; }

  /// Before the clock of a stage starts. All geometry is uploaded by the technique's build, positions that moved by its update,
  /// which finds the rest where it was; the inputs of the picture are uploaded before resolve.
  virtual void prepare([[maybe_unused]] Stage stage, [[maybe_unused]] const Scenes& scenes,
                       [[maybe_unused]] const GBuffer& gbuffer) {}
  /// After that clock has stopped. Throws Error on what went wrong since the last call.
  virtual void end_stage() {}
  /// Lets go of these scenes and of all that is of the frame.
  virtual void forget([[maybe_unused]] const Scenes& scenes) {}
  /// What was uploaded; nothing where the processor alone works.
  virtual std::optional<GlInputs> inputs([[maybe_unused]] const Scenes& scenes, [[maybe_unused]] const GBuffer& gbuffer) const {
    return {};
  }

  /// The bare pass of such a frame so many times in a row, 1 .. most_floor_times, by the host's clock and by that of the
  /// device. The scene's triangles are gone after it unless they were there before. Throws Error where nothing draws.
  virtual FloorRequest::Reply draw_floor(Floor floor, const Scene& scene, const GBuffer& gbuffer, int times);
  /// Another frame: what the bare pass was made ready with is gone.
  virtual void forget_floor() {}

  /// Uploads all that is no technique's: triangles, G-buffer and mask.
  virtual void upload([[maybe_unused]] const Scene& scene, [[maybe_unused]] const GBuffer& gbuffer,
                      [[maybe_unused]] VisibilityMask& mask) {}
  /// Writes this value everywhere in the mask, wherever the technique may write.
  virtual void fill(VisibilityMask& mask, float value);
  /// Has the driver free what was deleted, so that the memory of the process can be read.
  virtual void settle() {}
};

/// The device that a technique with this data sheet is called with; makes it ready. Where this machine has none it throws
/// Error, or the device's `missing` says why.
std::unique_ptr<TechniqueDevice> device_of(const About& about);

}  // namespace gnomon
