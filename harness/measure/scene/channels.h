#pragma once
#include <gnomon/scene.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace gnomon {

// Glass that colors the light. A technique multiplies one number, so that each channel is a question of its own: in a scene
// with colored transmission every light is three lights, NAME.red, NAME.green and NAME.blue, and what answers for one of them
// gets a scene whose transmissions have that channel alone.

enum class Channel { red, green, blue };
inline constexpr Channel all_channels[] = {Channel::red, Channel::green, Channel::blue};
inline constexpr std::string_view channel_names[] = {"red", "green", "blue"};
constexpr std::string_view name(Channel channel) { return channel_names[static_cast<std::size_t>(channel)]; }

/// The channel of a light that `split_lights` made, by its name: names that files give have no dot. Nothing of another.
std::optional<Channel> channel_of(std::string_view light);
/// The light that it is a channel of: "sun" of "sun.red"; another light's own name.
std::string_view whole_name(std::string_view light);

/// Makes three lights of each, next to each other, where the scene has colored transmission; else nothing.
void split_lights(Scene& scene);
/// The lights before that.
std::vector<Light> whole_lights(const std::vector<Light>& lights);
/// How many whole lights these are channels of.
std::size_t whole_count(const std::vector<std::string>& names);

/// The scene with one channel of each transmission; all else is a copy.
Scene in_channel(const Scene& scene, Channel channel);

/// A scene by what each of its lights finds: the scene itself, or where its glass colors the light that in one channel, made
/// on first use. That follows the scene's pose: `of` moves its vertices in place, at their addresses, where the scene's were
/// moved since the call before. Not for two threads at once.
class ChannelScenes {
 public:
  /// The scene must outlive this.
  explicit ChannelScenes(const Scene& scene) : scene_(scene), is_colored_(scene.has_colored_transmission()) {}
  const Scene& of(const Light& light);

 private:
  const Scene& scene_;
  bool is_colored_;
  std::array<std::unique_ptr<Scene>, std::size(all_channels)> made_;
};

}  // namespace gnomon
