#include "app/environments/generate_sequence.h"

#include <filesystem>
#include <future>
#include <utility>

#include <fmt/format.h>

#include "app/options/environment_options.h"
#include "data_gen/sequences.h"
#include "files/output_file.h"
#include "relumine/in/environment_files.h"

namespace relumine::app {

namespace {

const data_gen::Sequence& named(const std::string& kind) {
    for (const data_gen::Sequence& sequence : data_gen::sequences())
        if (sequence.name == kind)
            return sequence;
    throw UsageError("KIND", kind.empty() ? "expected what sequence to make, got none"
                                          : fmt::format("expected a sequence, got '{}'", kind));
}

data_gen::SequenceOptions sequence_options(const GenerateSequenceOptions& options,
                                           const data_gen::Sequence& sequence,
                                           std::optional<std::uint32_t> face_resolution,
                                           Session& session) {
    data_gen::SequenceOptions result{.num_frames = options.num_frames};
    if (face_resolution)
        result.face_resolution = *face_resolution;
    if (sequence.needs_probe != !options.environment.empty())
        throw UsageError("ENV", fmt::format("expected {} for `{}`",
                                            sequence.needs_probe ? "an environment" : "none",
                                            sequence.name));
    if (sequence.needs_probe) {
        EnvironmentOptions environment;
        environment.path = options.environment;
        environment.face_resolution = face_resolution.value_or(0);
        result.probe = load_environment(environment, session).map;
    }
    return result;
}

} // namespace

void GenerateSequenceOptions::add_to(Command& command) {
    command.add(row("KIND", kind, "after `sequence`: which one, see below", {.type = "KIND"}));
    command.add(
        row("ENV", environment, "the environment that `sequence turn` turns", {.file = true}));
    command.add(row("--frames", num_frames, "frames of a sequence", {.min = 1, .max = 1000000}));
    command.add(row("--layout", layout,
                    "of a sequence's frames: cross (texels as they are), cube or latlong",
                    {.choices = {"cross", "cube", "latlong"}}));
}

void generate_sequence(const GenerateSequenceOptions& options, const std::string& folder,
                       std::optional<std::uint32_t> face_resolution, Session& session) {
    const data_gen::Sequence& sequence = named(options.kind);
    const data_gen::FrameMaker make =
        sequence.make(sequence_options(options, sequence, face_resolution, session));
    const std::string name =
        (std::filesystem::path(folder) / fmt::format("{}.%04d.exr", sequence.name)).string();
    const std::optional<cubemap::FramePattern> pattern = cubemap::FramePattern::parse(name);
    const cubemap::Layout layout = LayoutText::read(options.layout);
    files::make_folder(folder);
    const auto progress = session.progress("frames");
    std::uint32_t resolution = 0;
    // A frame is compressed and written by one thread while the next one is made. The future waits
    // for it even where making fails.
    std::future<void> saved;
    const auto wait = [&](std::size_t num_frames) {
        if (saved.valid())
            saved.get();
        if (progress)
            progress(static_cast<double>(num_frames) / static_cast<double>(options.num_frames));
    };
    for (std::size_t frame = 0; frame < options.num_frames; ++frame) {
        session.poll();
        cubemap::CubeMap map = make(frame);
        resolution = map.resolution;
        wait(frame);
        saved = std::async(std::launch::async, [&pattern, layout, frame, map = std::move(map)] {
            cubemap::save_environment(pattern->name(static_cast<std::int64_t>(frame)), map, layout);
        });
    }
    wait(options.num_frames);
    session.end_progress();
    session.say(fmt::format("{}: {} frames, {}, R = {}", name, options.num_frames,
                            cubemap::name(layout), resolution));
    session.report(
        {{"frames", name}, {"num_frames", options.num_frames}, {"face_resolution", resolution}});
}

} // namespace relumine::app
