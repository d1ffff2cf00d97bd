#include "cubemap/image/frame_sequence.h"

#include <charconv>
#include <map>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <glob.h>

namespace relumine::cubemap {

namespace {

namespace fs = std::filesystem;

/// More frames than any sequence has. A larger range is taken for a mistake before a list of it is
/// made.
constexpr std::int64_t MaxFrames = 10'000'000;

[[noreturn]] void fail(const std::string& name, const std::string& expected,
                       const std::string& got) {
    throw std::runtime_error(fmt::format("{}: expected {}, got {}", name, expected, got));
}

/// Returns a text such as "7, 9-11 and 20 more".
std::string list_of(const std::vector<std::int64_t>& numbers) {
    constexpr std::size_t MaxRuns = 5;
    std::string list;
    std::size_t num_runs = 0;
    for (std::size_t i = 0; i < numbers.size();) {
        std::size_t end = i + 1;
        while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1)
            ++end;
        if (num_runs == MaxRuns)
            return fmt::format("{} and {} more", list, numbers.size() - i);
        list += fmt::format("{}{}", list.empty() ? "" : ", ", numbers[i]);
        if (end - i > 1)
            list += fmt::format("-{}", numbers[end - 1]);
        ++num_runs;
        i = end;
    }
    return list;
}

std::vector<FrameFile> frames_of(const std::string& name, const FramePattern& pattern,
                                 const std::optional<FrameRange>& range) {
    const fs::path folder = fs::path(name).parent_path();
    // With six files per frame, the first one stands for all. Loading finds missing others.
    const FramePattern first_file = *FramePattern::parse(environment_files(name).front().string());
    std::map<std::int64_t, fs::path> found;
    std::error_code error;
    for (fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, error), end;
         !error && entry != end; entry.increment(error)) {
        // The path is spelled as in the pattern: `frames` and `./frames` are the same folder.
        const std::string path = (folder / entry->path().filename()).string();
        if (const auto number = first_file.number(path))
            found.emplace(*number, pattern.name(*number));
    }
    if (error)
        throw std::runtime_error(
            fmt::format("{}: cannot read the folder: {}", name, error.message()));
    if (found.empty())
        fail(name, "frames", "no file of such a name");

    const FrameRange all = range.value_or(FrameRange{found.begin()->first, found.rbegin()->first});
    if ((all.last - all.first) / all.step >= MaxFrames)
        fail(name, fmt::format("at most {} frames", MaxFrames),
             fmt::format("{} to {}", all.first, all.last));
    std::vector<FrameFile> frames;
    std::vector<std::int64_t> missing;
    for (std::int64_t number = all.first; number <= all.last; number += all.step) {
        const auto file = found.find(number);
        if (file == found.end())
            missing.push_back(number);
        else
            frames.push_back({number, file->second});
    }
    if (!missing.empty())
        fail(name, fmt::format("frames {} to {} without a gap", all.first, all.last),
             fmt::format("none for {}", list_of(missing)));
    return frames;
}

/// Returns the last number in a file's name without extension.
std::optional<std::int64_t> last_number(const fs::path& path) {
    const std::string stem = path.stem().string();
    const std::size_t last = stem.find_last_of("0123456789");
    if (last == std::string::npos)
        return std::nullopt;
    const std::size_t before = stem.find_last_not_of("0123456789", last);
    const std::size_t first = before == std::string::npos ? 0 : before + 1;
    std::int64_t number = 0;
    if (std::from_chars(stem.data() + first, stem.data() + last + 1, number).ec != std::errc())
        return std::nullopt;
    return number;
}

std::vector<FrameFile> frames_of_glob(const std::string& name,
                                      const std::optional<FrameRange>& range) {
    glob_t matches{};
    const int status = ::glob(name.c_str(), 0, nullptr, &matches);
    std::vector<fs::path> paths(matches.gl_pathv,
                                matches.gl_pathv + matches.gl_pathc); // sorted by name
    ::globfree(&matches);
    if (status != 0 || paths.empty())
        fail(name, "frames", "no file of such a name");

    std::map<std::int64_t, fs::path> numbered;
    for (const fs::path& path : paths)
        if (const auto number = last_number(path))
            numbered.emplace(*number, path);
    if (numbered.size() != paths.size()) {
        numbered.clear();
        for (std::size_t i = 0; i < paths.size(); ++i)
            numbered.emplace(static_cast<std::int64_t>(i) + 1, paths[i]);
    }
    std::vector<FrameFile> frames;
    for (const auto& [number, path] : numbered)
        if (!range || range->contains(number))
            frames.push_back({number, path});
    if (frames.empty())
        fail(name, fmt::format("a frame from {} to {}", range->first, range->last),
             fmt::format("only {} to {}", numbered.begin()->first, numbered.rbegin()->first));
    return frames;
}

} // namespace

std::vector<FrameFile> find_frames(const std::string& name,
                                   const std::optional<FrameRange>& range) {
    std::error_code error;
    const bool is_file = fs::is_regular_file(name, error); // its name may hold any characters
    if (!is_file)
        if (const std::optional<FramePattern> pattern = FramePattern::parse(name))
            return frames_of(name, *pattern, range);
    if (!is_file && name.find_first_of("*?[") != std::string::npos)
        return frames_of_glob(name, range);
    const FrameFile frame{last_number(name).value_or(1), name};
    if (range && !range->contains(frame.number))
        fail(name, fmt::format("a frame from {} to {}", range->first, range->last),
             fmt::format("frame {}", frame.number));
    return {frame};
}

FrameSequence::FrameSequence(std::vector<FrameFile> files, Loader loader)
    : files_(std::move(files)), loader_(std::move(loader)),
      ahead_(files_.size(), [this](std::size_t frame) { return read(frame); }) {
    for (std::size_t frame = 0; frame < files_.size(); ++frame) {
        const ImageSize size = read_image_size(files_[frame].path);
        if (frame == 0)
            size_ = size;
        else if (size != size_)
            fail(files_[frame].path.string(),
                 fmt::format("{}x{} as the first frame, {}", size_.width, size_.height,
                             files_[0].path.string()),
                 fmt::format("{}x{}", size.width, size.height));
    }
}

FrameSequence::Loader FrameSequence::default_loader() {
    return [](const fs::path& path) {
        return load_environment(path);
    };
}

} // namespace relumine::cubemap
