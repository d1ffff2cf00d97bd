#include "app/options/size_text.h"

#include "app/command_line/command_line.h"

namespace relumine::app {

std::optional<SizeText> parse_size_text(std::string_view text) {
    const std::size_t cross = text.find('x');
    if (cross == std::string_view::npos)
        return std::nullopt;
    const auto width = parse_count(text.substr(0, cross));
    const auto height = parse_count(text.substr(cross + 1));
    if (!width || !height)
        return std::nullopt;
    return SizeText{*width, *height};
}

} // namespace relumine::app
