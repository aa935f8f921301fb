#include "measure/formats/gltf_motion.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace gnomon::importing {

GltfMotion::GltfMotion(const GltfFile& file, const GltfTree& tree)
    : file_(file),
      tree_(tree),
      read_(read_animations(file)),
      is_moved_(tree.size()),
      is_morphed_(tree.size()),
      is_used_(tree.size()),
      has_weights_(tree.size()) {
  bool has_tracks = false;
  for (const GltfAnimations::Item& item : read_.items)
    for (const Track& track : item.animation.tracks) {
      (track.property == Track::Property::weights ? is_morphed_ : is_moved_)[track.node] = true;
      has_tracks = true;
    }
  if (!has_tracks) return;
  for (const std::size_t n : tree.all())
    if (tree.parent(n) != GltfTree::none && is_moved_[tree.parent(n)]) is_moved_[n] = true;
  for (const std::size_t n : tree.scene()) {
    if (tree.is_hidden(n)) continue;
    const auto mesh = file.index(file.item("nodes", n), fmt::format("node {}", n), "mesh");
    if (mesh && (morphs(n) || moves(n))) moved_meshes_.insert(*mesh);
  }
}

const GltfSkin& GltfMotion::skin(std::size_t skin) {
  const auto known = skins_.find(skin);
  return known != skins_.end() ? known->second : skins_.emplace(skin, read_skin(file_, skin)).first->second;
}

bool GltfMotion::moves(std::size_t node) {
  const auto index = file_.index(file_.item("nodes", node), fmt::format("node {}", node), "skin");
  if (!index) return is_moved_[node];
  return std::ranges::any_of(skin(*index).joints, [&](std::size_t joint) -> bool { return is_moved_[joint]; });
}

std::uint32_t GltfMotion::number_of_skin(std::size_t skin) {
  return number_of_skin_.emplace(skin, static_cast<std::uint32_t>(number_of_skin_.size())).first->second;
}

void GltfMotion::add_nodes() {
  number_.resize(tree_.size());
  motion_.nodes.reserve(tree_.size());
  for (const std::size_t n : tree_.all()) {
    number_[n] = static_cast<std::uint32_t>(motion_.nodes.size());
    MotionNode& node = motion_.nodes.emplace_back(tree_.local(n));
    if (tree_.parent(n) != GltfTree::none) node.parent = number_[tree_.parent(n)];
  }
}

/// The nodes of the motion that place a mesh: the node itself, or a leaf below it for each instance.
GltfMotion::Block GltfMotion::block(std::size_t node, bool has_skin) {
  const Block itself{number_[node], 1};
  if (has_skin) return itself;
  if (const auto known = instances_.find(node); known != instances_.end()) return known->second;
  const auto matrices = tree_.instances(node);
  if (!matrices) return itself;
  const Block leaves{static_cast<std::uint32_t>(motion_.nodes.size()), static_cast<std::uint32_t>(matrices->size())};
  for (const glm::dmat4& matrix : *matrices) {
    MotionNode& leaf = motion_.nodes.emplace_back();
    leaf.parent = number_[node];
    leaf.matrix = matrix;
  }
  return instances_[node] = leaves;
}

void GltfMotion::place(std::size_t node, ImportedMesh& mesh) {
  if (motion_.nodes.empty()) add_nodes();
  const bool has_skin = mesh.skin != Rig::no_skin;
  const Block places = block(node, has_skin);
  if (places.count == 0) return;
  for (std::uint32_t k = 0; k < places.count; ++k) mesh.nodes.push_back(places.first + k);
  if (!has_skin) is_used_[node] = true;
  if (!mesh.targets.empty()) add_weights(node, places, mesh);
}

void GltfMotion::add_weights(std::size_t node, const Block& places, const ImportedMesh& mesh) {
  const Json& json = file_.item("nodes", node);
  const std::string where = fmt::format("node {}", node);
  const std::size_t count = mesh.targets.size() / mesh.base.size(), first = morph_target_count(file_, json, where);
  if (count != first)
    throw Error("{}: {}: primitives of its mesh have {} and {} morph targets; those that an animation moves have equally many",
                file_.name(), where, first, count);
  if (has_weights_[node]) return;
  has_weights_[node] = true;
  const Json& owner = file_.item("meshes", *file_.index(json, where, "mesh"));
  const std::vector<double> weights = morph_weights(file_, json, owner, where, count);
  for (std::uint32_t k = 0; k < places.count; ++k) motion_.nodes[places.first + k].weights = weights;
}

/// Whether a track of the file's nodes moves or morphs a mesh of the answer.
bool GltfMotion::moves(const Track& track) const {
  return track.property == Track::Property::weights ? has_weights_[track.node] : is_used_[track.node];
}

/// Tracks that move meshes of the answer, with the numbers of the motion. Instances carry the weights of their node each.
std::vector<Track> GltfMotion::used_tracks(std::vector<Track>& tracks) const {
  std::vector<Track> used;
  for (Track& track : tracks) {
    if (!moves(track)) continue;
    const auto instances = instances_.find(track.node);
    track.node = number_[track.node];
    if (track.property != Track::Property::weights || instances == instances_.end()) {
      used.push_back(std::move(track));
      continue;
    }
    for (std::uint32_t k = 0; k < instances->second.count; ++k) {
      used.push_back(track);
      used.back().node = instances->second.first + k;
    }
  }
  return used;
}

void GltfMotion::add_skins() {
  motion_.skins.resize(number_of_skin_.size());
  for (const auto& [index, number] : number_of_skin_) {
    const GltfSkin& read = skin(index);
    Skin& made = motion_.skins[number];
    made.inverse_bind = read.inverse_bind;
    for (std::size_t j = 0; j < read.joints.size(); ++j) {
      is_used_[read.joints[j]] = true;
      made.joints.push_back(number_[read.joints[j]]);
      for (int i = 0; i < 16; ++i)
        if (const double value = read.inverse_bind[j][i / 4][i % 4]; !std::isfinite(value))
          throw Error("{}: skin {}, joint {}: its inverse bind matrix holds {}, which is not finite", file_.name(), index, j,
                      value);
    }
  }
}

/// The nearest name of the form [a-z0-9_]+ that no animation before has.
std::string GltfMotion::free_name(std::string name) {
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? static_cast<char>(std::tolower(c)) : '_';
  if (name.find_first_not_of('_') == std::string::npos) name = "animation";
  std::string candidate = name;
  std::size_t& number = numbers_.try_emplace(name, 1).first->second;
  while (!names_.insert(candidate).second) candidate = fmt::format("{}_{}", name, ++number);
  return candidate;
}

void GltfMotion::finish(MeshFile& answer) {
  add_skins();
  for (auto n = tree_.all().rbegin(); n != tree_.all().rend(); ++n)
    if (is_used_[*n] && tree_.parent(*n) != GltfTree::none) is_used_[tree_.parent(*n)] = true;
  std::size_t idle_animations = 0, idle_channels = 0, repeated_keys = 0;
  for (GltfAnimations::Item& item : read_.items) {
    std::vector<Track>& tracks = item.animation.tracks;
    const std::size_t channels = tracks.size() + item.without_target;
    const auto used = static_cast<std::size_t>(std::ranges::count_if(tracks, [&](const Track& track) { return moves(track); }));
    if (used == 0) {
      ++idle_animations;
      continue;
    }
    idle_channels += channels - used;
    for (const Track& track : tracks)
      for (std::size_t k = 1; moves(track) && k < track.times.size(); ++k)
        repeated_keys += track.times[k] == track.times[k - 1];
    tracks = used_tracks(tracks);
    item.animation.name = free_name(std::move(item.animation.name));
    motion_.animations.push_back(std::move(item.animation));
  }
  answer.note(motion_.animations.size(), "animation{s} {moves|move} meshes; SCENE@SECONDS is a still at a time");
  answer.note(idle_animations, "animation{s} {moves|move} no mesh and {is|are} left out");
  answer.note(idle_channels, "channel{s} of animations {moves|move} no mesh and {is|are} left out");
  answer.note(read_.without_node, "channel{s} of animations {has|have} no node and {is|are} left out");
  answer.note(read_.pointers, "channel{s} of animations {is|are} of KHR_animation_pointer and {is|are} left out");
  answer.note(repeated_keys,
              "key{s} of animations {has|have} the time of the key before, and {counts|count} from that time on");
  if (!motion_.animations.empty()) answer.motion = std::move(motion_);
}

}  // namespace gnomon::importing
