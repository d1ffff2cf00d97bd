#include "app/movies/animate_options.h"

#include <filesystem>
#include <set>
#include <stdexcept>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "app/movies/frame_record.h"
#include "app/movies/movie.h"
#include "files/output_file.h"

namespace relumine::app {

namespace fs = std::filesystem;

void AnimateOptions::add_to(Command& command) {
    scene.add_to(command);
    command
        .add_option(
            "FRAMES", frames,
            "environments: frames.%04d.exr, frames.####.exr or a glob in quotes, 'frames_*.hdr'")
        .file()
        .required();
    command.add_option("--frames", range,
                       "which of them: FIRST-LAST, or FIRST-LASTxSTEP for every STEP-th (all)");
    environment.add_conversion_to(command);
    command
        .add_option("--method", method,
                    "prt: clusters' transfer, exact; clusters: lights that live over many frames "
                    "(Staton et al.); "
                    "importance: a few lights chosen anew for every frame")
        .one_of({"prt", "clusters", "importance"})
        .show_default();
    command
        .add_option(
            "--bound", bound,
            "prt: update only clusters whose light changed by more than this part of it; 0: all "
            "that changed")
        .between(0.0, 1.0)
        .show_default();
    command.add_option("--lights", num_lights, "importance: lights in a frame")
        .between(1, 1000000)
        .show_default();
    command.add_option("--clusters", num_clusters, "clusters: lights of all frames together")
        .between(1, 1000000)
        .show_default();
    command.add_option("--samples", num_samples, "clusters: samples of a frame")
        .between(1, 1000000)
        .show_default();
    command.add_option("--fade", fade, "clusters: frames over which lights come and go")
        .between(0, 10000)
        .show_default();
    command.add_flag("--even", even,
                     "clusters: lights are equally strong over all their frames, as in the paper");
    command.add_option("--seed", seed, "of the random numbers").show_default();
    bounces.add_to(command);
    output.add_to(command).required(false).description(
        "what to write, the number's place in its name: lit.%04d.png, .exr (pictures), .npy "
        "(numbers), .ply, .glb");
    command
        .add_option("--vertices", vertices,
                    "all frames in one .npy [frames x receivers x 3]: radiance times albedo")
        .file();
    command
        .add_option("--measure", reference,
                    "another --vertices file of the same frames: says how much this one flickers "
                    "against it")
        .file();
    command.add_option("--plot", plot, "of --measure: flicker over frames, .svg").file();
    command.add_option("--mp4", movie, "a movie of the .png frames, where ffmpeg is installed")
        .file();
    command.add_option("--fps", frames_per_second, "frames per second of the movie")
        .between(0.01, 1000.0)
        .show_default();
    command.add_flag("--resume", resume,
                     "keep frames that are there already, from the same inputs");
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
    if (!plot.empty()) {
        if (reference.empty())
            throw UsageError("--plot", "expected --measure with it");
        require_extension("--plot", plot, {".svg"});
        check_output(plot, {scene.path, reference});
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

std::string AnimateOptions::settings(const cubemap::FrameSequence& sequence) const {
    std::string all = fmt::format(
        "{} {} {}\n{}\n{} {} {} {}\n{}\n{}\n{}", RELUMINE_VERSION, FrameRecord::stamp(scene.path),
        scene.clusters_only, environment.settings(), method, bound, num_lights, seed, output.path,
        output.settings(),
        bounces.limits().num_bounces ? fmt::format("{}", *bounces.limits().num_bounces) : "all");
    if (method == "clusters") { // every frame depends on all
        all += fmt::format("\n{} {} {} {}", num_clusters, num_samples, fade, even);
        for (const cubemap::FrameFile& frame : sequence.files())
            for (const fs::path& file : cubemap::environment_files(frame.path))
                all += '\n' + FrameRecord::stamp(file);
    }
    return all;
}

} // namespace relumine::app
