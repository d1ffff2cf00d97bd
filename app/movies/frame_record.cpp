#include "app/movies/frame_record.h"

#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "app/command_line/command_line.h"
#include "files/output_file.h"
#include "relumine/in/environment_files.h"

namespace relumine::app {

namespace {

constexpr std::string_view Title = "relumine animate 1";
constexpr std::string_view Exposure = "exposure ";

/// FNV-1a, 64 bits.
template<typename Bytes>
std::uint64_t hash_of(const Bytes& bytes) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const auto byte : bytes) {
        hash ^= static_cast<std::uint8_t>(byte);
        hash *= 0x100000001b3u;
    }
    return hash;
}

/// One word for a frame's input and output.
std::string line_of(const std::filesystem::path& input, const std::filesystem::path& output) {
    const std::vector<std::byte> bytes = files::read(output);
    return fmt::format("{:016x} {} {:016x}", hash_of(FrameRecord::stamp(input)), bytes.size(),
                       hash_of(bytes));
}

} // namespace

FrameRecord::FrameRecord(std::filesystem::path path, const std::string& settings, bool resume)
    : path_(std::move(path)) {
    const std::string head = fmt::format("{}\nsettings {:016x}\n", Title, hash_of(settings));
    std::ostringstream kept;
    kept << head;
    if (std::error_code error; resume && std::filesystem::is_regular_file(path_, error)) {
        const std::vector<std::byte> bytes = files::read(path_);
        const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        std::istringstream lines(text.starts_with(head) ? text.substr(head.size()) : std::string());
        for (std::string line;
             std::getline(lines, line) && !lines.eof();) { // a line cut short does not count
            std::int64_t number = 0;
            std::istringstream words(line);
            if (line.starts_with(Exposure))
                exposure_ev_ = parse_number(line.substr(Exposure.size()));
            else if (std::string rest; words >> number && std::getline(words >> std::ws, rest))
                done_[number] = rest;
        }
        if (exposure_ev_)
            kept << Exposure << fmt::format("{}\n", *exposure_ev_);
        for (const auto& [number, rest] : done_)
            kept << number << ' ' << rest << '\n';
    }
    files::save_text(path_, kept.str());
}

bool FrameRecord::is_done(std::int64_t number, const std::filesystem::path& input,
                          const std::filesystem::path& output) const {
    const auto found = done_.find(number);
    std::error_code error;
    return found != done_.end() && std::filesystem::is_regular_file(output, error) &&
           line_of(input, output) == found->second;
}

void FrameRecord::add(std::int64_t number, const std::filesystem::path& input,
                      const std::filesystem::path& output) {
    const std::string line = line_of(input, output);
    files::append_text(path_, fmt::format("{} {}\n", number, line));
    done_[number] = line;
}

void FrameRecord::set_exposure_ev(double ev) {
    files::append_text(path_, fmt::format("{}{}\n", Exposure, ev));
    exposure_ev_ = ev;
}

std::string FrameRecord::stamp(const std::filesystem::path& path) {
    std::string stamp;
    for (const std::filesystem::path& file : cubemap::environment_files(path)) {
        std::error_code error;
        const auto size = std::filesystem::file_size(file, error);
        const auto time = std::filesystem::last_write_time(file, error);
        stamp += fmt::format("{} {} {}\n", file.string(), size, time.time_since_epoch().count());
    }
    return stamp;
}

} // namespace relumine::app
