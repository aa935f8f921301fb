#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace gnomon {

/// A number and what it counts. Words in braces are those of one and of many: counted(1, "row{s}") is "1 row",
/// counted(3, "mesh{es} {has|have} no name") is "3 meshes have no name".
std::string counted(std::size_t count, std::string_view words);

}  // namespace gnomon
