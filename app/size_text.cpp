#include "app/size_text.h"

#include <charconv>
#include <system_error>

namespace relumine::app {

std::optional<std::uint32_t> parse_side(std::string_view text) {
    std::uint32_t side = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, side);
    if (error != std::errc() || stop != end)
        return std::nullopt;
    return side;
}

std::optional<SizeText> parse_size_text(std::string_view text) {
    const std::size_t cross = text.find('x');
    if (cross == std::string_view::npos)
        return std::nullopt;
    const auto width = parse_side(text.substr(0, cross));
    const auto height = parse_side(text.substr(cross + 1));
    if (!width || !height)
        return std::nullopt;
    return SizeText{*width, *height};
}

} // namespace relumine::app
