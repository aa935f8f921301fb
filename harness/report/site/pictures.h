#pragma once
#include <map>
#include <optional>

#include "measure/images/image_files.h"
#include "measure/record/record.h"
#include "report/site/page.h"

namespace gnomon::site {

/// A row's pictures in the site: paths from its top; empty where the folder has none.
struct RowPictures {
  std::string mask, error;
  bool has_any() const { return !mask.empty() || !error.empty(); }
};

/// Masks and error pictures of rows, made small. Equal pictures are one file. What cannot be read is noted.
class Pictures {
 public:
  /// `row_count`: how many rows may have pictures; more are smaller.
  Pictures(Folder& folder, std::size_t row_count);
  /// The first call for a row makes them. `dir` is the folder of the row's run.
  const RowPictures& of(const Record& record, const std::filesystem::path& dir);
  /// Pixels across.
  int width() const { return width_; }

 private:
  std::string add_mask(const Record& record, const std::filesystem::path& dir);
  std::string add_error(const Record& record, const std::filesystem::path& dir);
  std::string keep(const Picture& whole);

  Folder& folder_;
  int width_;
  std::uintmax_t bytes_ = 0;
  bool is_full_ = false;
  std::map<const Record*, RowPictures> rows_;
};

/// The file of a run's folder that a record names; nothing where the name leaves the folder, or leads to no regular file.
std::optional<std::filesystem::path> file_of(const std::filesystem::path& dir, const std::optional<std::string>& name);

/// The picture with `width` pixels across, each the mean of those that it covers in 8-bit sRGB; a narrower one as it is.
Picture made_small(const Picture& picture, int width);

}  // namespace gnomon::site
