#include "measure/run/kept_row.h"

#include <gnomon/error.h>

#include <algorithm>

#include "measure/scene/motion.h"
#include "measure/score/record_causes.h"

namespace gnomon {

namespace {

template <class Item>
const Item& named(const std::vector<Item>& items, const std::string& name, const char* what) {
  if (const Item* found = find_named(items, name)) return *found;
  throw Error("the scene has no {} {} any more", what, name);
}

const std::optional<Record::ReferenceFacts>& facts_of(const Record& record, std::size_t light) {
  return record.lights.empty() ? record.reference : record.lights[light].reference;
}

/// Of what drew the row; of other techniques and older records the usual ones.
int subpixel_bits_of(const Record& record) {
  const auto bits = record.context.find("gl_subpixel_bits");
  return bits != record.context.end() && bits->is_number_integer() ? bits->get<int>() : usual_subpixel_bits;
}

}  // namespace

KeptPlace kept_place(const Record& record, const Scene& scene, Truth truth) {
  KeptPlace place{.key = {named(scene.views, record.view, "view"), record.width, record.height,
                          scene.has_curved_shapes() ? truth : Truth::shape},
                  .lights = {}};
  for (const std::string& light : light_names(record)) place.lights.push_back(named(scene.lights, light, "light"));
  if (record.path.empty()) return place;
  const Path path = find_path(scene, record.path, place.lights.front(), place.key.view);
  place.lights.front() = light_at(path, place.lights.front(), path.frame_count - 1);
  place.key.view = view_at(path, place.key.view, path.frame_count - 1);
  return place;
}

AreaTarget target_of(const Record& record, std::size_t light) {
  const auto& facts = facts_of(record, light);
  if (!facts) return {};
  return {.error = facts->target, .cap = static_cast<std::uint32_t>(facts->cap)};
}

LightShareKind estimates_of(const Record& record, std::size_t light) {
  const auto& facts = facts_of(record, light);
  return facts ? facts->estimates : LightShareKind::area;
}

const std::optional<std::map<std::string, std::uint64_t>>& known_causes(const Record& record, std::size_t light) {
  return record.lights.empty() ? record.causes : record.lights[light].causes;
}

MeasuredRow kept_row(const Record& record, const std::filesystem::path& file, std::string_view what, const KeptPlace& place,
                     FrameStore& frames) {
  MeasuredRow row;
  for (std::size_t k = 0; k < place.lights.size(); ++k) {
    const Light& light = place.lights[k];
    const std::string channel = fmt::format("{}.{}", light.name, what);
    Answer answer{frames.gbuffer(place.key),
                  frames.reference(place.key, light, target_of(record, k), subpixel_bits_of(record)),
                  read_exr(file, channel, record.width, record.height),
                  {},
                  estimates_of(record, k),
                  own_causes(record)};
    const auto is_wild = [](float v) { return !(v >= 0 && v <= 1); };
    if (const auto wild = std::ranges::find_if(answer.mask, is_wild); wild != answer.mask.end())
      throw Error("{}: {} at pixel {} is {}; a visibility is 0 .. 1", file.string(), channel, wild - answer.mask.begin(),
                  *wild);
    row.lights.push_back({light, std::move(answer), {}});
  }
  return row;
}

std::vector<Cause> kept_causes(const Record& record, const std::filesystem::path& file, std::size_t light) {
  const std::string channel = light_names(record)[light] + ".cause";
  const std::vector<float> numbers = read_exr(file, channel, record.width, record.height);
  try {
    return causes_from_numbers(numbers, known_causes(record, light), own_causes(record));
  } catch (const Error& error) {
    throw Error("{}: channel {}: {}", file.string(), channel, error.what());
  }
}

}  // namespace gnomon
