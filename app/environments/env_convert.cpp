#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/environments/split_sun.h"
#include "app/options/environment_options.h"
#include "app/options/output_options.h"
#include "files/joined.h"
#include "files/nearest_name.h"
#include "relumine/ask/environment_doctor.h"
#include "relumine/in/environment_files.h"
#include "relumine/light/light_lists.h"

namespace relumine::app {

namespace {

struct ConvertArguments {
    EnvironmentOptions input;
    std::string output;
    /// Empty: what `to` usually reads
    std::optional<cubemap::Layout> to_layout;
    std::string to = "openexr";

    /// --to: a convention, a layout, or both
    void read_to(const std::string& text);
    std::optional<cubemap::ImageSize> size;
    std::uint32_t face_resolution = 0;
    bool split_sun = false;
};

void ConvertArguments::read_to(const std::string& text) {
    const std::span<const std::string_view> layouts = LayoutText::choices();
    to = ConvertArguments().to;
    to_layout.reset();
    for (const std::string& word : split(text, ',')) {
        if (cubemap::find_convention(word) != nullptr) {
            to = word;
        } else if (std::find(layouts.begin(), layouts.end(), word) != layouts.end()) {
            to_layout = LayoutText::read(word);
        } else {
            std::vector<std::string> known(layouts.begin(), layouts.end());
            for (const std::string_view name : ConventionText::choices())
                known.emplace_back(name);
            throw std::invalid_argument(fmt::format("expected a layout ({}) or a program ({}), got "
                                                    "'{}'{}",
                                                    files::joined(layouts, ", "),
                                                    files::joined(ConventionText::choices(), ", "),
                                                    word, files::did_you_mean(word, known)));
        }
    }
}

/// W, or WxH
struct ImageSizeText {
    static constexpr const char* Type = "TEXT";
    static cubemap::ImageSize read(const std::string& text) {
        if (const auto sides = parse_sides(text))
            return {sides->first, sides->second};
        const auto width = parse_count(text);
        if (!width)
            refuse_text("W or WxH", text);
        return {*width, 0};
    }
    static std::string show(const cubemap::ImageSize& size) {
        return fmt::format("{}x{}", size.width, size.height);
    }
};

/// Throws what a layout cannot be.
cubemap::ImageSize checked(const cubemap::ImageSize& size, cubemap::Layout layout) {
    constexpr std::uint64_t MostPixels = std::uint64_t{1} << 28; // 3 GB
    if (!cubemap::fits(layout, size.width, size.height))
        throw UsageError("--size", fmt::format("expected the proportions of a {}, got {}x{}",
                                               cubemap::name(layout), size.width, size.height));
    if (std::uint64_t{size.width} * size.height > MostPixels)
        throw UsageError("--size", fmt::format("expected at most {} pixels, got {}x{}", MostPixels,
                                               size.width, size.height));
    return size;
}

cubemap::ImageSize target_size(const ConvertArguments& options,
                               const cubemap::EnvironmentImage& image, cubemap::Layout layout) {
    const std::optional<cubemap::ImageSize>& size = options.size;
    if (size && options.face_resolution != 0)
        throw UsageError("--size", "expected either --size or --face-resolution");
    if (size) {
        if (size->height != 0)
            return checked(*size, layout);
        // The height that belongs to a width.
        const cubemap::ImageSize unit =
            layout == cubemap::Layout::LatLong ? cubemap::ImageSize{2, 1}
            : cubemap::has_faces(layout)       ? cubemap::natural_size(layout, 1)
                                               : cubemap::ImageSize{1, 1};
        if (size->width % unit.width != 0)
            throw UsageError("--size",
                             fmt::format("expected a multiple of {} as the width of a {}, got {}",
                                         unit.width, cubemap::name(layout), size->width));
        const std::uint64_t height = std::uint64_t{size->width} / unit.width * unit.height;
        return checked({size->width, static_cast<std::uint32_t>(std::min<std::uint64_t>(
                                         height, std::numeric_limits<std::uint32_t>::max()))},
                       layout);
    }
    if (options.face_resolution != 0) {
        return checked(cubemap::natural_size(layout, options.face_resolution), layout);
    }
    return cubemap::conversion_size(image, layout);
}

cubemap::Layout target_layout(const ConvertArguments& options,
                              const cubemap::EnvironmentImage& image,
                              const cubemap::Convention& to) {
    const bool six_files = cubemap::environment_files(options.output).size() > 1;
    cubemap::Layout layout = to.has_attribute ? image.layout : to.usual_layout;
    if (six_files)
        layout = cubemap::Layout::Cube;
    layout = options.to_layout.value_or(layout);
    if (!to.reads(layout))
        throw UsageError("--to", fmt::format("expected {} for {}, got {}", layouts_of(to), to.name,
                                             cubemap::option_name(layout)));
    if (six_files && layout != cubemap::Layout::Cube)
        throw UsageError("--to", fmt::format("expected cube for six files, got {}",
                                             cubemap::option_name(layout)));
    return layout;
}

Report described(const cubemap::Convention& convention, const cubemap::EnvironmentImage& image,
                 const cubemap::EnvironmentStatistics& statistics) {
    return {{"layout", cubemap::name(image.layout)},
            {"convention", convention.name},
            {"width", image.width},
            {"height", image.height},
            {"samples_on_borders", image.sampling == cubemap::Sampling::Borders},
            {"mean_radiance", statistics.mean_radiance}};
}

/// Refuses what cannot be written before any work is done. Returns the sun's file; none where the
/// sun stays.
std::unique_ptr<SunFile> checked_outputs(const ConvertArguments& options) {
    require_environment_name("--output", options.output);
    std::vector<std::string> inputs;
    for (const auto& path : cubemap::environment_files(options.input.path))
        inputs.push_back(path.string());
    for (const auto& path : cubemap::environment_files(options.output))
        check_output(path.string(), inputs);
    std::unique_ptr<SunFile> sun_file;
    if (options.split_sun) {
        check_output(lights::sun_file_of(options.output).string(), inputs);
        sun_file = std::make_unique<SunFile>(options.output);
    }
    return sun_file;
}

void run(const ConvertArguments& options, Session& session) {
    const cubemap::Convention& from = *cubemap::find_convention(options.input.from);
    const cubemap::Convention& to = *cubemap::find_convention(options.to);
    const std::unique_ptr<SunFile> sun_file = checked_outputs(options);
    Stopwatch watch;
    cubemap::EnvironmentImage image = load_image(options.input, session);
    const double seconds_load = watch.lap();
    session.poll();

    const cubemap::Layout layout = target_layout(options, image, to);
    const cubemap::ImageSize size = target_size(options, image, layout);
    const cubemap::Sampling sampling = to.has_attribute
                                           ? cubemap::default_sampling(options.output, layout)
                                           : cubemap::Sampling::TexelCentres;
    Report result = {{"input", described(from, image, cubemap::statistics(image))}};
    watch.lap();
    const glm::dmat3 world_from_image = relumine::world_from_image(image.layout, options.input);
    SunFile::Split sun;
    if (sun_file)
        sun = sun_file->split(image, world_from_image, options.input.path);
    cubemap::EnvironmentImage converted =
        cubemap::convert(image, {layout, sampling, size.width, size.height},
                         glm::transpose(to.world_from(layout)) * world_from_image);
    const cubemap::EnvironmentStatistics statistics = cubemap::statistics(converted);
    warn_about(options.input, image, statistics.light_from_below, session);
    if (to.swaps_z_faces)
        cubemap::swap_z_faces(converted);
    const double seconds_convert = watch.lap();
    session.poll();
    cubemap::save_image(options.output, converted);
    if (sun_file)
        sun_file->commit();
    const double seconds_save = watch.lap();

    session.say(fmt::format("{}: {} {} x {}, as {} reads it", options.output, cubemap::name(layout),
                            size.width, size.height, to.name));
    if (sun_file) {
        session.say(fmt::format("{}: the sun, {:.2g} % of the light", sun_file->path(),
                                100.0 * sun.share_of_power));
        result.set("sun", sun.report);
    }
    result.set("output", described(to, converted, statistics));
    result.set("assumptions", image.assumptions);
    result.set("seconds_load", seconds_load);
    result.set("seconds_convert", seconds_convert);
    result.set("seconds_save", seconds_save);
    session.report(result);
}

void add_convert(Command& group, Session& session) {
    Command command = group.add_command("convert", "from one layout and program to another");
    auto options = std::make_shared<ConvertArguments>();
    std::string list =
        "\n\nCONVENTIONS (u to the right, v down, both in [0, 1]; docs/environments.md)\n";
    for (const cubemap::Convention& convention : cubemap::conventions())
        list += fmt::format("  {:8} {}\n", convention.name, convention.mathematics);
    command.footer(list);
    command.add(row("IN", options->input.path,
                    "environment: " + cubemap::environment_extensions() +
                        "; {face} in the name for px nx py ny pz nz",
                    {.file = true, .required = true}));
    command.add(row("-o,--output", options->output, "what to write: .exr or .hdr; {face} as in IN",
                    {.file = true, .required = true}));
    OptionTable reading = options_of(options->input);
    reading.pop_back(); // --face-resolution, which is OUT's here
    command.add_all(std::move(reading));
    command.add(row("--to", [options](const std::string& text) { options->read_to(text); },
                    "layout of OUT (IN's), the program that reads it (openexr), which has a layout "
                    "of its own, or both: blender, octahedral or directx,hcross",
                    {.type = "TEXT"}));
    command.add(row<ImageSizeText>(
        "--size", options->size,
        "pixels of OUT: W, or WxH (as fine as IN, at least 256 per face, from discs 512, to "
        "octahedral 640; cube to cube as it is)"));
    command.add(row("--face-resolution", options->face_resolution,
                    "the same as a cube face: a lat-long gets 4R x 2R pixels",
                    {.min = 0, .max = 16384, .shows_default = false}));
    command.add(row("--split-sun", options->split_sun,
                    "OUT without its sun; OUT.sun.json (.exr or .hdr replaced) has the sun as a "
                    "light, in world axes"));
    session.add_common_options(command);
    command.on_run([options, &session] { run(*options, session); });
}

} // namespace

void add_env(Command& program, Session& session) {
    Command group = program.add_command("env", "environments: `env convert`");
    add_convert(group, session);
}

} // namespace relumine::app
