#include "measure/row/row_frames.h"

#include <algorithm>
#include <cmath>

#include "measure/part_file.h"
#include "measure/picture/picture.h"
#include "measure/scene/blob.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

std::uint8_t alpha_of(PixelClass of) {
  return of == PixelClass::T ? tested_alpha : of > PixelClass::F ? facing_alpha : other_alpha;
}

}  // namespace

std::vector<int> kept_frame_numbers(int frame_count) {
  const int count = std::min(frame_count, most_kept_frames);
  std::vector<int> numbers;
  for (int k = 0; k < count; ++k)
    numbers.push_back(count == frame_count ? k : static_cast<int>(std::lround(k * (frame_count - 1.0) / (count - 1))));
  return numbers;
}

std::uint8_t byte_of_share(float share) { return static_cast<std::uint8_t>(std::lround(255 * std::clamp(share, 0.0f, 1.0f))); }

RowFrames::RowFrames(Record& record, fs::path out, int frame_count)
    : record_(record),
      out_(std::move(out)),
      numbers_(kept_frame_numbers(frame_count)),
      part_(part_of(out_ / "frames" / "reference")) {
  const std::string folder = "frames/" + picture_stem(record);
  std::error_code ignored;
  fs::remove_all(out_ / folder, ignored);
  fs::remove_all(part_, ignored);
  record_.kept_frames = {.numbers = numbers_, .mask = folder, .reference = ""};
}

RowFrames::~RowFrames() {
  std::error_code ignored;
  fs::remove_all(part_, ignored);
}

void RowFrames::add(int frame, const MeasuredRow& row, const Scene& scene) {
  if (!std::ranges::binary_search(numbers_, frame)) return;
  const Evidence evidence = row.evidence(scene);
  if (evidence.channels.empty()) return write(frame, evidence);
  // Rows of one reference share it: a pixel's worst channel is another one in each of them.
  std::vector<Evidence> lights;
  for (const MeasuredLight& light : row.lights) lights.push_back(light.answer.evidence(scene, light.light));
  const Together gray = together_in_gray(lights);
  write(frame, gray.evidence());
}

void RowFrames::write(int frame, const Evidence& evidence) {
  std::vector<std::uint8_t> mask, reference;
  for (std::size_t i = 0; i < evidence.mask.size(); ++i) {
    mask.push_back(byte_of_share(evidence.mask[i]));
    reference.push_back(byte_of_share(evidence.reference[i]));
    reference.push_back(alpha_of(evidence.classes[i]));
  }
  write_gray_png(out_ / frame_picture(record_.kept_frames->mask, frame), evidence.width, evidence.height, mask);
  write_gray_png(frame_picture(part_.string(), frame), evidence.width, evidence.height, reference, true);
  content_ = content_hash(fmt::format("{} {} {} {} {}", content_, frame, evidence.width, evidence.height,
                                      content_hash(std::as_bytes(std::span(reference)))));
}

void RowFrames::finish() {
  const std::string folder = "frames/reference-" + content_.substr(0, 16);
  // Another row's are the same, unless some of them are gone.
  fs::remove_all(out_ / folder);
  fs::rename(part_, out_ / folder);
  record_.kept_frames->reference = folder;
}

}  // namespace gnomon
