#include <gnomon/error.h>
#include <gnomon/transmission.h>

#include <algorithm>

namespace gnomon {

Transmission::Transmission(const glm::vec3& everywhere) : Transmission(1, 1, 3, {everywhere.x, everywhere.y, everywhere.z}) {}

Transmission::Transmission(int width, int height, int channels, std::vector<float> values, Wrap wrap_u, Wrap wrap_v)
    : width_(width), height_(height), channels_(channels), wrap_u_(wrap_u), wrap_v_(wrap_v), values_(std::move(values)) {
  for (const int texels : {width, height})
    if (texels < 1 || texels > most_texels)
      throw Error("a transmission's side of {} texels is not within 1 .. {}", texels, most_texels);
  if (channels != 1 && channels != 3) throw Error("a transmission has 1 or 3 channels, not {}", channels);
  for (const Wrap wrap : {wrap_u, wrap_v})
    if (wrap > Wrap::clamp) throw Error("a transmission's wrap of {} is not within 0 .. 2", static_cast<std::uint32_t>(wrap));
  const std::size_t wanted = std::size_t(width) * height * channels;
  if (wanted > most_values)
    throw Error("a transmission of {} x {} texels has {} numbers; at most {} are allowed", width, height, wanted, most_values);
  if (values_.size() != wanted)
    throw Error("a transmission of {} x {} texels has {} numbers, not {}", width, height, values_.size(), wanted);
  for (const float value : values_)
    if (!(value >= 0 && value <= 1)) throw Error("a transmission of {} is not within 0 .. 1", value);
  for (float& value : values_) value += 0.0f;  // minus zero is zero
  bool is_gray = channels == 3, is_constant = true;
  for (std::size_t i = 0; is_gray && i < values_.size(); i += 3)
    is_gray = values_[i] == values_[i + 1] && values_[i] == values_[i + 2];
  if (is_gray) {
    for (std::size_t i = 0; i < values_.size() / 3; ++i) values_[i] = values_[3 * i];
    values_.resize(values_.size() / 3);
    channels_ = 1;
  }
  for (std::size_t i = channels_; is_constant && i < values_.size(); ++i) is_constant = values_[i] == values_[i - channels_];
  if (!is_constant) return;
  values_.resize(channels_);
  width_ = height_ = 1;
  wrap_u_ = wrap_v_ = Wrap::repeat;
}

}  // namespace gnomon
