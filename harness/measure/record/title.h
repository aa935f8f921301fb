#pragma once
#include <string>
#include <string_view>

namespace gnomon {

/// "SCENE LIGHT [VIEW] [PATH] ", with which the title of a row begins. A view of the name `view`, the only one of most scenes,
/// is left out.
std::string title_of_place(std::string_view scene, std::string_view light, std::string_view view, std::string_view path);

}  // namespace gnomon
