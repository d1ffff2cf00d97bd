// Sizes of pictures as options spell them.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace relumine::app {

/// A picture's width and height in pixels.
struct SizeText {
    std::uint32_t width = 0, height = 0;
    bool operator==(const SizeText&) const = default;
};

/// Reads WxH: two sides with a small x between them. Sides of 0 are the caller's to refuse.
[[nodiscard]] std::optional<SizeText> parse_size_text(std::string_view text);

} // namespace relumine::app
