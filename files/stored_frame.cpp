#include "files/stored_frame.h"

#include <algorithm>

namespace relumine::files {

namespace {

void append(std::vector<std::byte>& to, std::uint64_t value, std::size_t num_bytes) {
    for (std::size_t i = 0; i < num_bytes; ++i)
        to.push_back(static_cast<std::byte>(value >> (8 * i) & 0xFFu));
}

/// An empty frame has a block, too.
std::size_t num_blocks(std::size_t size) {
    return std::max<std::size_t>(1, (size + StoredFrame::BlockSize - 1) / StoredFrame::BlockSize);
}

} // namespace

std::size_t stored_frame_size(std::size_t size) {
    return StoredFrame::HeaderSize + num_blocks(size) * StoredFrame::BlockHeaderSize + size;
}

std::vector<std::byte> stored_frame(std::span<const std::byte> bytes) {
    std::vector<std::byte> frame;
    frame.reserve(stored_frame_size(bytes.size()));
    append(frame, StoredFrame::Magic, 4);
    append(frame, StoredFrame::Descriptor, 1);
    append(frame, bytes.size(), 8);
    for (std::size_t i = num_blocks(bytes.size()); i > 0; --i) {
        const auto block = bytes.first(std::min(StoredFrame::BlockSize, bytes.size()));
        append(frame, block.size() << 3 | static_cast<std::size_t>(i == 1), 3);
        frame.insert(frame.end(), block.begin(), block.end());
        bytes = bytes.subspan(block.size());
    }
    return frame;
}

} // namespace relumine::files
