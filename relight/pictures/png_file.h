// PNG files in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace relumine::relight {

/// Returns a PNG file of 8 bits per channel.
///
/// Shape:   bytes are [height * width * num_channels] row by row; 3 channels are RGB, 4 are RGBA.
/// Cost:    parallel; 40 ms of processor time for 1024 x 768 RGB.
/// Threads: parallel (TBB); the result is bitwise independent of the number of threads.
[[nodiscard]] std::vector<std::byte> encode_png(std::uint32_t width, std::uint32_t height,
                                                std::size_t num_channels,
                                                std::span<const std::uint8_t> bytes);

} // namespace relumine::relight
