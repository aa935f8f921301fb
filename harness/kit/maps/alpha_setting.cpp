#include <gnomon/kit/maps/alpha_setting.h>

#include <cmath>

namespace gnomon {

AlphaDifference::AlphaDifference(AlphaRule rule, std::span<const float> answer, std::span<const float> by_texel,
                                 bool has_shares)
    : cause_(alpha_causes[rule == AlphaRule::hashed ? 1 : 0].id) {
  for (std::size_t i = 0; i < answer.size(); ++i)
    differs_.push_back(has_shares ? std::abs(answer[i] - by_texel[i]) > 1.0f / 16 : (answer[i] > 0.5f) != (by_texel[i] > 0.5f));
}

}  // namespace gnomon
