#include "app/movies/animate_options.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/movies/frame_record.h"
#include "app/movies/movie.h"
#include "files/output_file.h"
#include "relumine/version.h"

namespace relumine::app {

namespace fs = std::filesystem;

namespace {

/// By Turning
constexpr std::array<std::string_view, 3> TurningWords = {"camera", "object", "environment"};

/// "48" or "48,object"
struct TurntableText {
    static constexpr const char* Type = "TEXT";
    static Turntable read(const std::string& text) {
        const std::size_t comma = std::min(text.find(','), text.size());
        const std::optional<std::uint32_t> frames = parse_count(text.substr(0, comma));
        if (!frames || *frames > 100000)
            refuse_text("N or N,WHAT with 0 to 100000 frames", text);
        if (comma == text.size())
            return {*frames};
        return {*frames,
                static_cast<Turning>(option_text::word(TurningWords, text.substr(comma + 1)))};
    }
    static std::string show(const Turntable& table) {
        return fmt::format("{},{}", table.num_frames,
                           TurningWords[static_cast<std::size_t>(table.turns)]);
    }
};

} // namespace

void AnimateOptions::add_to(Command& command) {
    command_ = command;
    scene.add_to(command);
    command.add(
        row("FRAMES", frames,
            "environments: frames.%04d.exr, frames.####.exr or a glob in quotes, 'frames_*.hdr'",
            {.file = true, .required = true, .shapes_frames = false}));
    command.add(row("--frames", range,
                    "which of them: FIRST-LAST, or FIRST-LASTxSTEP for every STEP-th (all)",
                    {.shapes_frames = false}));
    command.add_all(
        {row<TurntableText>(
             "--turntable", turntable,
             "N[,WHAT]: one environment, and the camera turns once about the mesh in N frames, or "
             "the object, whose environment stays, or the environment",
             {.example = "4,object", .shows_default = false}),
         row("--camera-path", camera_file,
             "the camera moves: a .json of key frames of eye, target and fov_degrees; one "
             "environment lights all frames up to the last key",
             {.file = true})});
    command.add_all(options_of(environment));
    command.add_all(
        {row("--method", method,
             "prt: clusters' transfer, exact; clusters: lights that live over many frames (Staton "
             "et al.); importance: a few lights chosen anew for every frame",
             {.choices = {"prt", "clusters", "importance"}}),
         row("--lights", num_lights,
             "importance: lights in a frame (64); clusters: lights of all frames together (512)",
             {.min = 1, .max = 1000000})});
    bounces.add_to(command);
    output.add_to(command).required(false).description(
        "what to write, the number's place in its name: lit.%04d.png, .exr (pictures), .npy "
        "(numbers), .ply, .glb");
    const auto file = [&](const char* name, std::string& where, const char* help) {
        command.add(row(name, where, help, {.file = true, .shapes_frames = false}));
    };
    file("--vertices", vertices,
         "all frames in one .npy [frames x receivers x 3]: radiance times albedo");
    file("--measure", reference,
         "another --vertices file of the same frames: says how much this one flickers against it");
    file("--mp4", movie, "a movie of the .png frames, where ffmpeg is installed");
    command.add(row("--fps", frames_per_second, "frames per second of the movie",
                    {.min = 0.01, .max = 1000, .shapes_frames = false}));
    command.add(row("--resume", resume, "keep frames that are there already, from the same inputs",
                    {.shapes_frames = false}));
}

void AnimateOptions::load_camera() {
    if (camera_file.empty())
        return;
    const relumine::OutputOptions& picture = output.picture;
    const auto refuse_beside = [](bool is_given, const char* option) {
        if (is_given)
            throw UsageError("--camera-path",
                             fmt::format("expected either it or {}, got both", option));
    };
    refuse_beside(turntable.num_frames > 0, "--turntable");
    refuse_beside(picture.camera_place.has_value(), "--camera");
    refuse_beside(picture.eye.has_value(), "--eye");
    refuse_beside(picture.target.has_value(), "--target");
    const std::string extension = extension_of(output.path);
    if (extension != ".png" && extension != ".exr")
        throw UsageError(
            "--camera-path",
            fmt::format("expected --output with .png or .exr frames, got '{}'", output.path));
    camera_path = load_camera_path(camera_file);
    refuse_beside(camera_path->names_fov && picture.fov_degrees.has_value(),
                  "--fov where the file has fov_degrees");
}

PlacedCamera AnimateOptions::camera_on_path(std::int64_t number, const Camera& other) const {
    PlacedCamera camera = camera_at(camera_path.value(), static_cast<double>(number));
    if (!camera_path->names_fov)
        camera.fov_degrees = other.fov_degrees;
    return camera;
}

std::vector<cubemap::FrameFile> AnimateOptions::frame_files() const {
    std::optional<cubemap::FrameRange> chosen;
    try {
        if (!range.empty())
            chosen = cubemap::FrameRange::parse(range);
    } catch (const std::runtime_error& error) {
        throw UsageError("--frames", error.what());
    }
    std::vector<cubemap::FrameFile> files = cubemap::find_frames(frames, chosen);
    // One environment is numbered from 0 on; a sequence keeps its numbers, which a path means.
    if (camera_path ? files.size() != 1
                    : turntable.num_frames == 0 || files.size() == turntable.num_frames)
        return files;
    if (files.size() != 1)
        throw UsageError("--turntable", fmt::format("expected one environment or {}, got {}",
                                                    turntable.num_frames, files.size()));
    files.resize(camera_path ? camera_path->num_frames() : turntable.num_frames, files.front());
    for (std::size_t i = 0; i < files.size(); ++i)
        files[i].number = static_cast<std::int64_t>(i);
    return files;
}

double AnimateOptions::turn_degrees(std::size_t frame) const {
    const double degrees = 360.0 * static_cast<double>(frame) /
                           static_cast<double>(std::max<std::size_t>(turntable.num_frames, 1));
    // An object that turns is a camera and an environment that turn the other way.
    return turntable.turns == Turning::Object ? -degrees : degrees;
}

EnvironmentOptions AnimateOptions::environment_at(std::size_t frame) const {
    EnvironmentOptions result = environment;
    if (turns_environment())
        result.rotate_degrees += turn_degrees(frame);
    return result;
}

std::optional<cubemap::FramePattern> AnimateOptions::output_pattern() const {
    if (output.path.empty())
        return std::nullopt;
    return frame_names(output.path);
}

void AnimateOptions::check(const cubemap::FrameSequence& sequence) const {
    if (output.path.empty() && vertices.empty())
        throw UsageError("--output", "expected it or --vertices, got neither");
    const auto pattern = output_pattern();
    if (pattern) {
        output.check({scene.path});
        std::set<fs::path> inputs;
        for (const cubemap::FrameFile& frame : sequence.files())
            for (const fs::path& file : cubemap::environment_files(frame.path))
                inputs.insert(fs::weakly_canonical(file));
        for (const cubemap::FrameFile& frame : sequence.files())
            if (const std::string path = pattern->name(frame.number);
                inputs.contains(fs::weakly_canonical(path)))
                throw std::runtime_error(
                    fmt::format("{}: expected an output other than the input frames", path));
    }
    check_cameras(sequence);
    if (!vertices.empty()) {
        require_extension("--vertices", vertices, {".npy"});
        check_output(vertices, {scene.path});
    }
    if (!reference.empty()) {
        if (vertices.empty())
            throw UsageError("--measure", "expected --vertices with it");
        static_cast<void>(files::size(reference));
        require_extension("--measure", reference, {".npy"});
        check_output(vertices, {reference});
    }
    if (!movie.empty()) {
        require_extension("--mp4", movie, {".mp4"});
        if (fs::path(output.path).extension() != ".png")
            throw UsageError("--mp4",
                             fmt::format("expected --output with .png frames to make it of, got "
                                         "'{}'",
                                         output.path));
        static_cast<void>(find_ffmpeg(movie));
        check_output(movie, {scene.path});
    }
}

void AnimateOptions::check_cameras(const cubemap::FrameSequence& sequence) const {
    if (!camera_path)
        return;
    for (const cubemap::FrameFile& frame : sequence.files())
        if (!has_direction(camera_on_path(frame.number, {})))
            throw std::runtime_error(fmt::format("{}: expected eye and target apart at all frames, "
                                                 "got the same point at frame {}",
                                                 camera_file, frame.number));
}

std::string AnimateOptions::settings(const cubemap::FrameSequence& sequence) const {
    std::string all =
        fmt::format("{}\n{}\n{}", version(), FrameRecord::stamp(scene.path), command_->settings());
    if (camera_path)
        all += '\n' + FrameRecord::stamp(camera_file);
    if (method == "clusters") // every frame depends on all
        for (const cubemap::FrameFile& frame : sequence.files())
            for (const fs::path& file : cubemap::environment_files(frame.path))
                all += '\n' + FrameRecord::stamp(file);
    return all;
}

} // namespace relumine::app
