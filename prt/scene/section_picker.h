// Parts of a section that is too long to be kept whole.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

namespace relumine::prt {

/// Picks ranges out of the bytes of a section, as stream_section() gives them. Ranges ascend.
class SectionPicker {
public:
    struct Range {
        std::uint64_t begin = 0, end = 0;
    };
    explicit SectionPicker(std::vector<Range> ranges) : ranges_(std::move(ranges)) {
        std::uint64_t size = 0;
        for (const Range& range : ranges_)
            size += range.end - range.begin;
        picked_.reserve(static_cast<std::size_t>(size));
    }

    void take(std::span<const std::byte> piece) {
        const std::uint64_t end = done_ + piece.size();
        for (; next_ < ranges_.size() && ranges_[next_].begin < end; ++next_) {
            const Range& range = ranges_[next_];
            const auto first = static_cast<std::size_t>(std::max(range.begin, done_) - done_);
            const auto last = static_cast<std::size_t>(std::min(range.end, end) - done_);
            picked_.insert(picked_.end(), piece.begin() + static_cast<std::ptrdiff_t>(first),
                           piece.begin() + static_cast<std::ptrdiff_t>(last));
            if (range.end > end)
                break; // goes on in the next piece
        }
        done_ = end;
    }

    template<typename Element>
    [[nodiscard]] std::vector<Element> elements() const {
        std::vector<Element> result(picked_.size() / sizeof(Element));
        if (!result.empty())
            std::memcpy(result.data(), picked_.data(), picked_.size());
        return result;
    }

private:
    std::vector<Range> ranges_;
    std::vector<std::byte> picked_;
    std::size_t next_ = 0;
    std::uint64_t done_ = 0;
};

} // namespace relumine::prt
