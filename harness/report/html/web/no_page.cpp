#include "report/html/html_parts.h"

namespace gnomon {

/// Built with GNOMON_REPORT=OFF.
std::string_view page_template() { return {}; }

}  // namespace gnomon
