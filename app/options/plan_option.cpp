#include "app/options/plan_option.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/options/output_options.h"
#include "relumine/lit_part.h"

namespace relumine::app {

prt::Part parse_part(const std::string& text) {
    const std::size_t slash = text.find('/');
    const std::uint32_t index = parse_count(text.substr(0, slash)).value_or(0);
    const std::uint32_t count =
        slash == std::string::npos ? 0 : parse_count(text.substr(slash + 1)).value_or(0);
    if (index < 1 || index > count || count > prt::MaxParts)
        throw UsageError("--part", fmt::format("expected I/N with I from 1 to N and N up to {}, as "
                                               "1/4, got '{}'",
                                               prt::MaxParts, text));
    return {.index = index - 1, .count = count};
}

void PlanOption::add_to(Command& command) {
    command.add(row("--plan", plan_, "do one part of a plan of `relumine plan` instead of a MESH",
                    {.file = true}));
    command.add(row("--part", [this](const std::string& text) { part_ = parse_part(text); },
                    "with --plan: part I of N, from 1/N to N/N; `relumine join` puts them together",
                    {.type = "I/N", .needs = "--plan"}));
}

void PlanOption::run(const Command& command, const std::string& output, Engine engine,
                     const PrecomputeWork& work, Session& session) const {
    if (part_.count == 0)
        throw UsageError("--plan", "expected --part I/N with it");
    constexpr std::array<std::string_view, 8> Fitting = {
        "--plan", "--part", "--output", "--engine", "--threads", "--json", "--quiet", "--verbose"};
    for (const std::string& name : command.given_options())
        if (std::find(Fitting.begin(), Fitting.end(), name) == Fitting.end())
            throw UsageError(name, "the plan says it already: give it to `relumine plan`");
    check_output(output, {plan_});
    Stopwatch watch;
    prt::PrecomputeStatistics statistics;
    precompute_part({.plan = plan_, .part = part_, .output = output, .engine = engine}, work,
                    &statistics);
    session.end_progress();
    const std::uintmax_t file_bytes = std::filesystem::file_size(output);
    const double seconds = watch.total();
    session.say(fmt::format("{}: part {} of {}, {} clusters in {:.1f} s, {:.1f} MB", output,
                            part_.index + 1, part_.count, statistics.num_clusters, seconds,
                            static_cast<double>(file_bytes) * 1e-6));
    session.report({{"part", part_.index + 1},
                    {"parts", part_.count},
                    {"clusters", statistics.num_clusters},
                    {"rays", statistics.num_rays},
                    {"seconds_clustering", statistics.seconds},
                    {"peak_bytes", peak_bytes()},
                    {"file_bytes", file_bytes},
                    {"seconds", seconds}});
}

void add_join(Command& program, Session& session) {
    struct Options {
        std::vector<std::string> parts;
        std::string output;
    };
    Command command = program.add_command(
        "join", "put parts together: of a planned precompute -> SCENE.prt, of light -> OUT.npy");
    auto options = std::make_shared<Options>();
    command.add(row("PART", options->parts,
                    "all parts that `relumine precompute --plan` or `relumine relight --part` "
                    "wrote, in any order",
                    {.file = true, .required = true}));
    command.add(row("-o,--output", options->output,
                    "the scene file to write, .prt; of light the numbers, .npy",
                    {.file = true, .required = true}));
    session.add_common_options(command);
    command.on_run([options, &session] {
        Stopwatch watch;
        require_extension("--output", options->output, {".prt", ".npy"});
        check_output(options->output, options->parts);
        const std::vector<std::filesystem::path> parts(options->parts.begin(),
                                                       options->parts.end());
        if (extension_of(options->output) == ".npy")
            join_light(parts, options->output);
        else
            join(parts, options->output);
        const std::uintmax_t file_bytes = std::filesystem::file_size(options->output);
        const double seconds = watch.total();
        session.say(fmt::format("{}: {} parts in {:.1f} s, {:.1f} MB", options->output,
                                parts.size(), seconds, static_cast<double>(file_bytes) * 1e-6));
        session.report({{"parts", parts.size()},
                        {"peak_bytes", peak_bytes()},
                        {"file_bytes", file_bytes},
                        {"seconds", seconds}});
    });
}

} // namespace relumine::app
