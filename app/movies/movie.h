// Pictures put together to a movie by ffmpeg, where the system has it.
#pragma once

#include <filesystem>
#include <span>
#include <stop_token>
#include <string>

namespace relumine::app {

/// The ffmpeg on the PATH. Throws std::runtime_error "MOVIE: expected ffmpeg on the PATH to make
/// it, found none".
[[nodiscard]] std::filesystem::path find_ffmpeg(const std::string& movie);

/// An H.264 movie of PNG pictures, one frame each. Whole or not at all. Throws std::runtime_error
/// with ffmpeg's last line, or prt::Cancelled.
void make_movie(const std::filesystem::path& ffmpeg, const std::string& movie,
                std::span<const std::string> pictures, double frames_per_second,
                const std::stop_token& stop);

} // namespace relumine::app
