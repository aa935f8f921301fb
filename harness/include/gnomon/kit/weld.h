#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace gnomon {

/// For each vertex the first one at exactly its position; minus zero is zero. Where `wanted` is given, one for each vertex,
/// only those count that are: the others are left alone.
std::vector<std::uint32_t> weld(std::span<const glm::vec3> positions, std::span<const std::uint8_t> wanted = {});

}  // namespace gnomon
