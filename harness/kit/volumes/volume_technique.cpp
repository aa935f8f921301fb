#include <gnomon/kit/volumes/volume_technique.h>

namespace gnomon {

std::vector<DebugLayer> VolumeTechnique::debug_layers() const {
  std::vector<DebugLayer> layers = volume_layers();
  layers.push_back(silhouette_layer());
  return layers;
}

std::vector<float> VolumeTechnique::draw_debug(std::string_view layer) const {
  if (layer != "volumes" && layer != "counts" && layer != "silhouette") return Technique::draw_debug(layer);
  const StateGuard guard;
  std::vector<float> picture;
  if (layer == "counts") {
    draw(Pass::wide);
    std::vector<float> counts;
    for (const VolumeCounter::WideCount& pixel : made_->counter.wide_counts()) counts.push_back(pixel.count);
    picture = heat_layer(*gbuffer_, counts);
    made_->counter.end();
  } else {
    VisibilityMask mask(gbuffer_->width, gbuffer_->height);
    {
      const StateGuard of_mask;
      answer(mask);
    }
    picture = shaded_layer(*made_->scene, *gbuffer_, light_, mask.read());
    if (layer == "silhouette") {
      draw_lines(outlines(), *gbuffer_, picture);
    } else {
      draw(Pass::layer);
      paint_volumes(made_->counter.layer_faces(), gbuffer_->width, picture);
      made_->counter.end();
    }
  }
  if (!keeps_wide()) made_->counter.drop_pictures();
  return picture;
}

void VolumeTechnique::answer(VisibilityMask& mask) const {
  draw(mask_pass());
  made_->counter.write_mask(gbuffer_textures(*gbuffer_, *made_->scene), light_, mask);
  glFinish();
}

VolumeCounter::Work VolumeTechnique::measure_work() const {
  const StateGuard guard;
  draw(Pass::wide);
  const VolumeCounter::Work work = made_->counter.work();
  made_->counter.end();
  if (!keeps_wide()) made_->counter.drop_pictures();
  return work;
}

void VolumeTechnique::bind_faces(const Buffer& positions, const FaceBuffers& faces) const {
  const glm::mat4 clip(clip_from_world(*gbuffer_, *made_->scene));
  made_->drawer.bind(positions, faces, clip, homogeneous(light_), ends(), made_->adjacency.has_meeting_vertices());
}

}  // namespace gnomon
