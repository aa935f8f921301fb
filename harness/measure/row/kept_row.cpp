#include "measure/row/kept_row.h"

#include "measure/scene/motion.h"
#include "measure/scene/names.h"
#include "measure/score/record_causes.h"

namespace gnomon {

namespace {

template <class Item>
const Item& named(const std::vector<Item>& items, const std::string& name, const char* what) {
  if (const Item* found = find_named(items, name)) return *found;
  throw Error("the scene has no {} {} any more", what, name);
}

/// The target of the light's reference.
AreaTarget target_of(const Record::LightFacts& light) {
  if (!light.reference) return {};
  return {.error = light.reference->target, .cap = static_cast<std::uint32_t>(light.reference->cap)};
}

/// Of the OpenGL that drew the row; of other techniques the usual ones.
int subpixel_bits_of(const Record& record) {
  const auto bits = record.context.find("gl_subpixel_bits");
  return bits != record.context.end() && bits->is_number_integer() ? bits->get<int>() : usual_subpixel_bits;
}

}  // namespace

int frame_count(const Record& record) {
  if (record.frame_count) return *record.frame_count;
  std::size_t most = 1;
  for (const auto& [metric, values] : record.frames) most = std::max(most, values.size());
  return static_cast<int>(most);
}

KeptPlace kept_place(const Record& record, const Scene& scene, Truth truth, PosedScene* posed) {
  const bool moves_geometry = record.start && record.frame_rate;
  if (moves_geometry && !posed) throw Error("the scene of row {} is at rest, and its geometry moves", record.job);
  // A slide is made for the scene at rest.
  if (posed && !moves_geometry) posed->go_to(std::nullopt);
  KeptPlace place{.key = {named(scene.views, record.view, "view"), record.width, record.height,
                          scene.has_curved_shapes() ? truth : Truth::shape},
                  .lights = {}};
  for (const std::string& light : light_names(record)) place.lights.push_back(named(scene.lights, light, "light"));
  if (record.path.empty()) return place;
  Path path = find_path(scene, record.path, place.lights.front(), place.key.view);
  if (moves_geometry) {
    path.start = *record.start;
    path.frame_rate = *record.frame_rate;
    path.frame_count = frame_count(record);
    posed->go_to(pose_at(path, path.frame_count - 1));
    place.key.pose = WantedPose{*posed->now(), posed->hash()};
    place.key.truth = scene.has_curved_shapes() ? truth : Truth::shape;
  }
  for (Light& light : place.lights) light = light_at(path, light, path.frame_count - 1);
  place.key.view = view_at(path, place.key.view, path.frame_count - 1);
  return place;
}

LightShareKind estimates_of(const Record::LightFacts& light) {
  return light.reference ? light.reference->estimates : LightShareKind::area;
}

MeasuredRow kept_row(const Record& record, const std::filesystem::path& file, std::string_view what, const KeptPlace& place,
                     FrameStore& frames) {
  MeasuredRow row;
  auto facts = record.lights.begin();
  for (const Light& light : place.lights) {
    const std::string channel = fmt::format("{}.{}", light.name, what);
    // First of all, since it finds a size that is not the record's: a frame of that size may be far larger than the mask.
    std::vector<float> mask = read_exr(file, channel, record.width, record.height);
    const auto is_wild = [](float v) { return !(v >= 0 && v <= 1); };
    if (const auto wild = std::ranges::find_if(mask, is_wild); wild != mask.end())
      throw Error("{}: {} at pixel {} is {}; a visibility is 0 .. 1", file.string(), channel, wild - mask.begin(), *wild);
    Answer answer{frames.gbuffer(place.key), frames.reference(place.key, light, target_of(*facts), subpixel_bits_of(record)),
                  std::move(mask),           {},
                  estimates_of(*facts++),    own_causes(record)};
    row.lights.push_back({light, std::move(answer)});
  }
  return row;
}

std::vector<Cause> kept_causes(const Record& record, const std::filesystem::path& file, const Record::LightFacts& light) {
  const std::string channel = light.name + ".cause";
  const std::vector<float> numbers = read_exr(file, channel, record.width, record.height);
  try {
    return causes_from_numbers(numbers, light.causes, own_causes(record));
  } catch (const Error& error) {
    throw Error("{}: channel {}: {}", file.string(), channel, error.what());
  }
}

}  // namespace gnomon
