// Pictures of the frames of rows on a path, for the page's player.
#include <cmath>
#include <map>
#include <utility>

#include "analysis/in_order.h"
#include "measure/images/image_files.h"
#include "report/html/html_parts.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// Of one row's frames unpacked: a browser holds them all at once.
constexpr std::size_t most_bytes_of_row = std::size_t{1} << 28;

/// Of a path without a time of its own.
constexpr double usual_frame_rate = 60;

class FrameCollector {
 public:
  FrameCollector(const fs::path& dir, bool with_all, PictureSet& set) : dir_(dir), with_all_(with_all), set_(set) {}

  Json row(const Record& r) {
    if (!r.kept_frames)
      return because(r.error_picture ? "they were not kept: an older program made the row"
                     : r.mask        ? "they were not kept: the row was run with --pictures masks"
                                     : "they were not kept: the row was run with --pictures none");
    if (r.kept_frames->numbers.empty()) return because("the record names no frame");
    if (const std::size_t bytes = 3 * pixels(r) * r.kept_frames->numbers.size(); bytes > most_bytes_of_row)
      return because(fmt::format("they are {} MB, more than the {} MB that a page plays; their files are in {} and {}",
                                 bytes / 1'000'000, most_bytes_of_row / 1'000'000, r.kept_frames->mask,
                                 r.kept_frames->reference));
    if (is_full_) return because(full());
    try {
      return frames(r);
    } catch (const std::exception& error) {
      add_once(set_.notes, fmt::format("no frames of {}, light {}, {}: {}", r.scene, r.light, setting_name(r), error.what()));
      return because(error.what());
    }
  }

 private:
  static Json because(const std::string& reason) { return {{"reason", reason}}; }

  static std::string full() {
    return fmt::format(
        "the page has {} MB of frames already, the most that it gets unless all are asked for; "
        "gnomon report DIR --all-frames puts them in",
        most_frame_bytes / 1'000'000);
  }

  static std::size_t pixels(const Record& r) { return static_cast<std::size_t>(r.width) * static_cast<std::size_t>(r.height); }

  Json frames(const Record& r) {
    const std::string reference = r.kept_frames->reference;
    const auto known = references_.find(reference);
    std::string mask_blob = packed(planes(r, r.kept_frames->mask, {"Y"}));
    std::string reference_blob = known == references_.end() ? packed(planes(r, reference, {"Y", "A"})) : "";
    const std::size_t size = mask_blob.size() + reference_blob.size();
    if (!with_all_ && size_ + size > most_frame_bytes) {
      is_full_ = true;
      add_once(set_.notes, fmt::format("no frames of {}, light {}, {}, and of rows after it: {}", r.scene, r.light,
                                       setting_name(r), full()));
      return because(full());
    }
    size_ += size;
    if (known == references_.end()) references_[reference] = keep(std::move(reference_blob));
    return {{"numbers", r.kept_frames->numbers},
            {"start", r.start ? Json(*r.start) : Json()},
            {"frame_rate", r.frame_rate.value_or(usual_frame_rate)},
            {"mask", keep(std::move(mask_blob))},
            {"reference", references_.at(reference)}};
  }

  std::size_t keep(std::string blob) {
    set_.blobs.push_back(std::move(blob));
    return set_.blobs.size() - 1;
  }

  /// The channels of all frames in a folder, less those of the frame before.
  std::vector<std::uint8_t> planes(const Record& r, const std::string& folder,
                                   std::initializer_list<const char*> channels) const {
    std::vector<std::uint8_t> bytes;
    for (const int frame : r.kept_frames->numbers)
      for (const char* const channel : channels)
        for (const float share : read_exr(dir_ / frame_picture(folder, frame), channel, r.width, r.height))
          bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * share)));
    for (std::size_t k = bytes.size(), step = pixels(r) * channels.size(); k-- > step;)
      bytes[k] = static_cast<std::uint8_t>(bytes[k] - bytes[k - step]);
    return bytes;
  }

  const fs::path& dir_;
  const bool with_all_;
  PictureSet& set_;
  std::map<std::string, std::size_t> references_;  ///< numbers of blobs by folder
  std::size_t size_ = 0;                           ///< base64 of all blobs of frames
  bool is_full_ = false;
};

}  // namespace

Json collect_frames(const fs::path& dir, const Layout& layout, bool with_pictures, bool with_all_frames, PictureSet& set) {
  FrameCollector collector(dir, with_all_frames, set);
  Json rows = Json::array();
  for (const Layout::Group& group : layout.groups)
    for (const Layout::Row& row : group.rows) {
      const Record& r = *row.record;
      if (r.path.empty() || r.status != Status::ok)
        rows.push_back(Json());
      else if (!with_pictures)
        rows.push_back(Json{{"reason", "pictures were left out on demand"}});
      else
        rows.push_back(collector.row(r));
    }
  return rows;
}

}  // namespace gnomon
