#pragma once
// The fields of a Motion in the order in which they are written, for FieldWriter and FieldReader alike.
#include <gnomon/motion.h>

namespace gnomon {

void visit_motion(auto& io, auto& motion) {
  io.list(motion.nodes, [](auto& sub, auto& node) {
    sub(node.parent, node.matrix, node.translation, node.rotation, node.scale, node.weights);
  });
  io.list(motion.animations, [](auto& sub, auto& animation) {
    sub(animation.name);
    sub.list(animation.tracks, [](auto& inner, auto& track) {
      inner(track.node, track.property, track.interpolation, track.times, track.values);
    });
  });
  io.list(motion.skins, [](auto& sub, auto& skin) { sub(skin.joints, skin.inverse_bind); });
  io.list(motion.rigs, [](auto& sub, auto& rig) {
    sub(rig.mesh, rig.node, rig.skin, rig.placement.scale, rig.placement.rotate_degrees, rig.placement.translate, rig.base,
        rig.targets, rig.joints_per_vertex, rig.joints, rig.weights);
  });
}

}  // namespace gnomon
