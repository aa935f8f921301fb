#include <gnomon/kit/pictures/exposure.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "analysis/in_order.h"
#include "measure/cause/own_causes.h"
#include "measure/paths.h"
#include "measure/picture/shading.h"
#include "measure/record/scene_place.h"
#include "measure/row/kept_row.h"
#include "measure/scene/blob.h"
#include "measure/scene/load.h"
#include "measure/worker/worker_frame_maker.h"
#include "report/html/html_parts.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

using Bytes = std::vector<std::uint8_t>;

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) three = three << 8 | (k < left ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= left ? digits[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

template <class Enums>
Bytes index_bytes(const Enums& values) {
  Bytes bytes;
  for (const auto value : values) bytes.push_back(static_cast<std::uint8_t>(value));
  return bytes;
}

/// Planes of differences deflate to a third of interleaved colors.
Bytes color_planes(const Picture& picture) {
  const std::size_t pixels = static_cast<std::size_t>(picture.width) * picture.height;
  Bytes bytes(3 * pixels);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    std::uint8_t left = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
      const std::uint8_t value = picture.rgb[3 * i + channel];
      bytes[channel * pixels + i] = static_cast<std::uint8_t>(value - left);
      left = value;
    }
  }
  return bytes;
}

/// The channels "WHAT.R", "WHAT.G", "WHAT.B" of a file as three values a pixel.
std::vector<float> colors_in(const fs::path& file, std::string_view what, int width, int height) {
  std::vector<float> rgb(3 * static_cast<std::size_t>(width) * height);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const std::vector<float> values = read_exr(file, fmt::format("{}.{}", what, "RGB"[channel]), width, height);
    for (std::size_t i = 0; i < values.size(); ++i) rgb[3 * i + channel] = values[i];
  }
  return rgb;
}

/// Radiance as sRGB, multiplied by the exposure.
Picture exposed_picture(std::span<const float> radiance, float exposure, int width, int height) {
  Picture picture{.width = width, .height = height, .rgb = {}};
  for (const float value : radiance) picture.rgb.push_back(srgb(static_cast<double>(value * exposure)));
  return picture;
}

/// The frames of one scene at a time: most runs list the groups of a scene in sequence.
class Frames {
 public:
  /// Throws Error when the scene cannot be loaded.
  void open(const std::string& reference) {
    if (scene_ && reference_ == reference) return;
    store_.reset();
    posed_.reset();
    hashes_.clear();
    scene_.reset();
    scene_ = std::make_unique<Scene>(load_scene(reference));
    posed_.emplace(*scene_);
    store_.emplace(*scene_, cache_root() / "frames", std::make_unique<WorkerFrameMaker>());
    reference_ = reference;
  }
  const Scene& scene() const { return *scene_; }
  FrameStore& store() { return *store_; }
  /// The place of a row's masks; the scene is then in the pose of that frame.
  KeptPlace place(const Record& r) { return kept_place(r, *scene_, r.truth, &*posed_); }
  /// What the record's scene_hash would be today.
  const std::string& hash(const Record& r) {
    const std::vector<std::string> lights = light_names(r);
    if (!r.start) return store_->scene_hash(lights);
    std::string& hash = hashes_[lights];
    if (!hash.empty()) return hash;
    posed_->go_to(std::nullopt);
    return hash = scene_hash(*scene_, lights, WithMotion::yes);
  }

 private:
  std::string reference_;
  std::unique_ptr<Scene> scene_;
  std::optional<PosedScene> posed_;
  std::optional<FrameStore> store_;
  std::map<std::vector<std::string>, std::string> hashes_;  ///< of rows whose geometry moves, by lights
};

class Collector {
  static constexpr std::size_t most_shown_lights = 8;  ///< that get pictures of their own, of several

 public:
  Collector(const fs::path& dir, std::vector<CauseInfo> causes, PictureSet& set)
      : dir_(dir), causes_(std::move(causes)), set_(set) {}

  void add(const Layout::Group& group) {
    Json base;
    std::vector<Json> rows(group.rows.size());
    const auto has_mask = [](const Layout::Row& row) { return row.record->status == Status::ok && row.record->mask; };
    const auto is_irradiance = [](const Layout::Row& row) {
      return row.record->answer == AnswerKind::fraction &&
             estimates_of(row.record->lights.front()) == LightShareKind::irradiance;
    };
    const auto masked = std::ranges::find_if(group.rows, has_mask);
    try {
      if (masked != group.rows.end()) {
        frames_.open(scene_reference(*group.rows.front().record, dir_));
        for (std::size_t k = 0; k < group.rows.size(); ++k)
          if (has_mask(group.rows[k])) rows[k] = row(*group.rows[k].record);
        if (!std::ranges::all_of(rows, &Json::is_null))
          base = frame(*masked->record, std::ranges::any_of(group.rows, is_irradiance));
      }
    } catch (const std::exception& error) {
      note(group.heading, error.what());
    }
    for (Json& json : rows) set_.rows.push_back(base.is_null() ? Json() : std::move(json));
    set_.groups.push_back(std::move(base));
  }

 private:
  /// The number of a new blob with these bytes; null without bytes.
  Json keep(std::span<const std::uint8_t> bytes) {
    if (bytes.empty()) return {};
    set_.blobs.push_back(packed(bytes));
    return set_.blobs.size() - 1;
  }

  void note(const std::string& what, const std::string& why) { say(fmt::format("no pictures of {}: {}", what, why)); }

  void say(const std::string& text) { add_once(set_.notes, text); }

  /// The pictures that all rows of a group share; under several lights those of all together and those of each light.
  Json frame(const Record& r, bool with_irradiance) {
    const Scene& scene = frames_.scene();
    MeasuredRow row = kept_row(r, dir_ / *r.mask, "V", frames_.place(r), frames_.store());
    put_together(row, scene, true);
    if (!row.together) return frame_of(row.lights.front(), with_irradiance);
    const Together& all = *row.together;
    Json json = shadings(row.gbuffer(), all.received);
    json["bits"] = bits_of_shares(AnswerKind::received);
    json["reference"] = keep(share_bytes(all.reference, bits_of_shares(AnswerKind::received)));
    json["reference_error"] = keep(error_bytes(all.reference_error));
    json["irradiance"] = json["irradiance_error"] = nullptr;
    json["classes"] = keep(index_bytes(all.classes));
    for (const MeasuredLight& light : shown_lights(row)) {
      Json& one = json["lights"].emplace_back(frame_of(light, false));
      one["name"] = light.light.name;
      one["is_fraction"] = light.answer.reference.kind != AnswerKind::binary;  // behind glass, too
    }
    if (row.lights.size() > most_shown_lights)
      say(fmt::format("{}, light {}: pictures of each are of the first {} of {} lights", r.scene, r.light, most_shown_lights,
                      row.lights.size()));
    return json;
  }

  /// The scene with all direct light and without any, and the light above white that the first picture cuts off.
  Json shadings(const GBuffer& gbuffer, std::span<const double> received) {
    const std::vector<float> all(gbuffer.size(), 1.0f), none(gbuffer.size(), 0.0f);
    const auto shaded = [&](std::span<const float> shares, double white) {
      return keep(color_planes(shade(frames_.scene(), gbuffer, received, shares, white)));
    };
    const double white = brightest(frames_.scene(), gbuffer, received);
    Json json = {{"lit", shaded(all, 1)}, {"dark", shaded(none, 1)}, {"bright", nullptr}, {"white", std::max(white, 1.0)}};
    if (white > 1) json["bright"] = shaded(all, white);
    return json;
  }

  static std::span<const MeasuredLight> shown_lights(const MeasuredRow& row) {
    return std::span(row.lights).first(std::min(row.lights.size(), most_shown_lights));
  }

  Json frame_of(const MeasuredLight& of, bool with_irradiance) {
    const Reference& reference = of.answer.reference;
    Json json = shadings(of.answer.gbuffer, received_light(of.answer.gbuffer, of.light));
    const int bits = bits_of_shares(reference.kind);
    json["bits"] = bits;
    const auto truth = [&](const std::string& name, std::span<const float> shares, std::span<const float> errors) {
      json[name] = keep(share_bytes(shares, bits));
      json[name + "_error"] = keep(error_bytes(shares.empty() ? shares : errors));
    };
    truth("reference", reference.mask, reference.error);
    truth("irradiance", with_irradiance ? reference.irradiance : std::span<const float>(), reference.irradiance_error);
    json["classes"] = keep(index_bytes(reference.classes));
    return json;
  }

  /// The mask of one row; null with a note when it does not belong to the scene as it is now, or cannot be read.
  Json row(const Record& r) {
    const std::string what = fmt::format("{}, light {}, {}", r.scene, r.light, r.label.value_or(r.technique));
    const std::string hash = context_text(r, "scene_hash");
    if (hash != frames_.hash(r)) {
      note("scene " + r.scene, hash.empty() ? "its records do not say which scene was measured"
                                            : "the scene is not the one that was measured: its content has changed");
      return {};
    }
    try {
      MeasuredRow row = kept_row(r, dir_ / *r.mask, "V", frames_.place(r), frames_.store());
      for (std::size_t k = 0; k < r.lights.size(); ++k)
        if (r.lights[k].causes) take_causes(r, row.lights[k].answer, r.lights[k]);
      put_together(row, frames_.scene(), true);
      Json json;
      if (!row.together) json = mask_of(row.lights.front());
      add_global(r, json);
      if (!row.together) return json;
      json.update(mask_json(row.together->evidence(), AnswerKind::received));
      for (const MeasuredLight& light : shown_lights(row)) json["lights"].push_back(mask_of(light));
      return json;
    } catch (const std::exception& error) {
      note(what, error.what());
      return {};
    }
  }

  /// The row's pictures of all light, if any, in the exposure that fits the reference.
  void add_global(const Record& r, Json& json) {
    if (!r.metric("radiosity_error")) return;
    const fs::path file = dir_ / *r.mask;
    const std::vector<float> reference = colors_in(file, global_reference_channel, r.width, r.height);
    const float bright = exposure(reference);
    const auto picture = [&](std::span<const float> rgb) {
      return keep(color_planes(exposed_picture(rgb, bright, r.width, r.height)));
    };
    json["global"] = picture(colors_in(file, global_channel, r.width, r.height));
    // One scene, light and view have one reference, however many rows show it.
    if (reference != global_reference_) {
      global_reference_ = reference;
      global_reference_blob_ = picture(reference);
    }
    json["global_reference"] = global_reference_blob_;
  }

  Json mask_json(const Evidence& evidence, AnswerKind kind) {
    Json json;
    json["mask"] = keep(share_bytes(evidence.mask, bits_of_shares(kind)));
    json["causes"] = evidence.causes.empty() ? Json() : keep(page_numbers(evidence));
    return json;
  }

  Json mask_of(const MeasuredLight& of) { return mask_json(of.answer.evidence(), of.answer.reference.kind); }

  /// Its causes as numbers of the page's list. A technique's own causes have another number in every record.
  Bytes page_numbers(const Evidence& evidence) const {
    if (causes_.size() > 255) throw Error("the rows have {} causes; a picture of them holds 255", causes_.size());
    std::vector<std::uint8_t> number{0};
    for (const CauseInfo& info : with_common(evidence.own_causes)) {
      const auto found = std::ranges::find(causes_, info.name, &CauseInfo::name);
      number.push_back(static_cast<std::uint8_t>(found - causes_.begin() + 1));
    }
    Bytes bytes;
    for (const Cause cause : evidence.causes) bytes.push_back(number[static_cast<std::size_t>(cause)]);
    return bytes;
  }

  /// Reads the causes of a mask; none, with a note, when they were found on another reference than the page shows.
  void take_causes(const Record& r, Answer& answer, const Record::LightFacts& light) {
    // A version is that of the whole run: one note for each scene.
    if (const std::string obstacle = causes_obstacle(r); !obstacle.empty())
      return say(fmt::format("no causes of {}: {}", scene_in_words(r.scene), obstacle));
    answer.causes = kept_causes(r, dir_ / *r.mask, light);
  }

  const fs::path& dir_;
  const std::vector<CauseInfo> causes_;
  PictureSet& set_;
  Frames frames_;
  std::vector<float> global_reference_;  ///< the last one that was kept
  Json global_reference_blob_;           ///< the number of its blob
};

}  // namespace

int bits_of_shares(AnswerKind kind) { return kind == AnswerKind::binary ? 8 : 12; }

std::vector<std::uint8_t> share_bytes(std::span<const float> shares, int bits) {
  const float largest = static_cast<float>((1 << bits) - 1);
  const auto code = [&](std::size_t i) { return std::lround(largest * (shares[i] > 0 ? std::min(shares[i], 1.0f) : 0.0f)); };
  Bytes bytes(shares.size());
  for (std::size_t i = 0; i < shares.size(); ++i) bytes[i] = static_cast<std::uint8_t>(code(i) >> (bits - 8));
  if (bits == 8) return bytes;
  // The upper bits of neighbors are alike, the lower ones hardly are: in separate planes they deflate better.
  for (std::size_t i = 0; i < shares.size(); i += 2) {
    const long next = i + 1 < shares.size() ? code(i + 1) & 15 : 0;
    bytes.push_back(static_cast<std::uint8_t>((code(i) & 15) << 4 | next));
  }
  return bytes;
}

std::vector<std::uint8_t> error_bytes(std::span<const float> errors) {
  Bytes bytes(errors.size());
  for (std::size_t i = 0; i < errors.size(); ++i)
    if (errors[i] > 0)
      bytes[i] = static_cast<std::uint8_t>(std::clamp(std::lround(255 + 254 * std::log10(errors[i]) / 6), 1L, 255L));
  return bytes;
}

std::string packed(std::span<const std::uint8_t> bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  Bytes deflated(size);
  if (compress2(deflated.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), Z_DEFAULT_COMPRESSION) != Z_OK)
    throw Error("a picture of {} bytes cannot be deflated: out of memory", bytes.size());
  return base64(std::span(deflated).first(size));
}

PictureSet collect_pictures(const fs::path& dir, const Layout& layout) {
  PictureSet set;
  Collector collector(dir, page_causes(layout), set);
  for (const Layout::Group& group : layout.groups) collector.add(group);
  return set;
}

}  // namespace gnomon
