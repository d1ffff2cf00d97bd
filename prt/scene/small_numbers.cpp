#include "prt/scene/small_numbers.h"

#include <algorithm>

#include "files/parallel.h"

namespace relumine::prt {

NumberPieces::NumberPieces(std::span<const std::byte> bytes) : bytes_(bytes) {
    constexpr std::size_t PieceBytes = std::size_t{1} << 20;
    const std::size_t num_pieces = (bytes.size() + PieceBytes - 1) / PieceBytes;
    std::vector<std::uint64_t> num_ends(num_pieces);
    files::parallel_for(std::size_t{0}, num_pieces, [&](std::size_t piece) {
        const std::span<const std::byte> rest = bytes.subspan(piece * PieceBytes);
        const auto own = rest.first(std::min(PieceBytes, rest.size()));
        num_ends[piece] = static_cast<std::uint64_t>(std::count_if(own.begin(), own.end(), is_end));
    });
    std::uint64_t before = 0;
    for (std::size_t piece = 0; piece < num_pieces; ++piece) {
        Place begin{.byte = piece * PieceBytes, .number = before};
        if (begin.byte != 0 && !is_end(bytes[begin.byte - 1]))
            skip(1, begin); // the number that began before
        begins_.push_back(begin);
        before += num_ends[piece];
    }
    begins_.push_back({.byte = bytes.size(), .number = before});
}

void NumberPieces::skip(std::uint64_t count, Place& at) const {
    for (; count != 0 && at.byte < bytes_.size(); ++at.byte)
        if (is_end(bytes_[at.byte])) {
            --count;
            ++at.number;
        }
}

} // namespace relumine::prt
