#include "cubemap/image/frame_pattern.h"

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace relumine::cubemap {

namespace {

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// Returns the number if the whole text is one, digits only.
std::optional<std::int64_t> whole_number(std::string_view text) {
    std::int64_t value = 0;
    const char* end = text.data() + text.size();
    if (text.empty() || !std::all_of(text.begin(), text.end(), is_digit) ||
        std::from_chars(text.data(), end, value).ec != std::errc())
        return std::nullopt;
    return value;
}

/// The place of the number in a name.
struct Place {
    std::size_t begin = 0, end = 0, digits = 0;
};

std::optional<Place> place_at(std::string_view text, std::size_t begin) {
    std::size_t end = begin;
    if (text[begin] == '#') {
        while (end < text.size() && text[end] == '#')
            ++end;
        return Place{begin, end, end - begin};
    }
    if (text[begin] != '%')
        return std::nullopt;
    // %d and %04d are allowed. A width without the zero would fill up with spaces.
    ++end;
    const std::size_t width_begin = end;
    while (end < text.size() && is_digit(text[end]))
        ++end;
    const std::string_view width = text.substr(width_begin, end - width_begin);
    if (end == text.size() || text[end] != 'd' || (!width.empty() && width.front() != '0') ||
        width.size() > 3)
        return std::nullopt;
    return Place{begin, end + 1, static_cast<std::size_t>(whole_number(width).value_or(1))};
}

} // namespace

FramePattern::FramePattern(std::string prefix, std::size_t digits, std::string suffix)
    : prefix_(std::move(prefix)), digits_(digits), suffix_(std::move(suffix)) {}

std::optional<FramePattern> FramePattern::parse(const std::string& text) {
    std::optional<Place> found;
    const std::size_t slash = text.rfind('/');
    for (std::size_t i = slash == std::string::npos ? 0 : slash + 1; i < text.size();) {
        const std::optional<Place> place = place_at(text, i);
        if (place && found)
            throw std::runtime_error(
                fmt::format("{}: expected one place for the frame's number, got two", text));
        if (place)
            found = place;
        i = place ? place->end : i + 1;
    }
    if (!found)
        return std::nullopt;
    return FramePattern(text.substr(0, found->begin), std::max<std::size_t>(found->digits, 1),
                        text.substr(found->end));
}

std::string FramePattern::name_of_all(std::string_view text) const {
    return fmt::format("{}{}{}", prefix_, text, suffix_);
}

std::string FramePattern::name(std::int64_t number) const {
    return fmt::format("{}{:0{}}{}", prefix_, number, digits_, suffix_);
}

std::optional<std::int64_t> FramePattern::number(std::string_view path) const {
    if (path.size() <= prefix_.size() + suffix_.size() || !path.starts_with(prefix_) ||
        !path.ends_with(suffix_))
        return std::nullopt;
    const std::optional<std::int64_t> number =
        whole_number(path.substr(prefix_.size(), path.size() - prefix_.size() - suffix_.size()));
    return number && name(*number) == path ? number : std::nullopt;
}

FrameRange FrameRange::parse(const std::string& text) {
    const auto fail = [&] {
        throw std::runtime_error(
            fmt::format("expected FIRST-LAST or FIRST-LASTxSTEP, got '{}'", text));
    };
    const std::size_t dash = text.find('-');
    const std::size_t cross = text.find('x');
    const auto first = whole_number(std::string_view(text).substr(0, std::min(dash, cross)));
    if (!first)
        fail();
    FrameRange range{.first = *first, .last = *first};
    if (dash != std::string::npos) {
        const auto last = whole_number(std::string_view(text).substr(
            dash + 1, cross == std::string::npos ? cross : cross - dash - 1));
        if (!last || *last < *first)
            fail();
        range.last = *last;
    }
    if (cross != std::string::npos) {
        const auto step = whole_number(std::string_view(text).substr(cross + 1));
        if (!step || *step == 0 || dash == std::string::npos)
            fail();
        range.step = *step;
    }
    return range;
}

} // namespace relumine::cubemap
