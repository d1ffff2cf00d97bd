#include "app/options/plan_option.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/options/output_options.h"
#include "relumine/in/shared_work.h"
#include "relumine/light/lit_part.h"

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
    command.add(row("--part", [this](const std::string& text) { part_ = parse_part(text); },
                    "MESH is a plan of `relumine plan`: do part I of N of it, from 1/N to N/N; "
                    "`relumine join` puts them together",
                    {.type = "I/N"}));
}

void PlanOption::run(const Command& command, const std::string& plan, const std::string& output,
                     const PrecomputeWork& work, Session& session) const {
    constexpr std::array<std::string_view, 7> Fitting = {
        "MESH", "--part", "--output", "--threads", "--json", "--quiet", "--verbose"};
    for (const std::string& name : command.given_options())
        if (std::find(Fitting.begin(), Fitting.end(), name) == Fitting.end())
            throw UsageError(name, "the plan says it already: give it to `relumine plan`");
    require_part_name(output);
    check_output(output, {plan});
    Stopwatch watch;
    prt::PrecomputeStatistics statistics;
    precompute_part({.plan = plan, .part = part_, .output = output}, work, &statistics);
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

namespace {

/// Rising numbers as job arrays take them: "2,5-7".
std::string ranges_of(std::span<const std::uint32_t> numbers) {
    std::string text;
    for (std::size_t i = 0; i < numbers.size();) {
        std::size_t last = i;
        while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1)
            ++last;
        text += fmt::format("{}{}", text.empty() ? "" : ",", numbers[i]);
        if (last > i)
            text += fmt::format("-{}", numbers[last]);
        i = last + 1;
    }
    return text;
}

/// Says which parts are missing or cannot be joined.
void check_parts(std::span<const std::filesystem::path> parts, const Session& session) {
    const prt::PartCheck check = prt::check_parts(parts);
    std::vector<std::uint32_t> missing = check.missing;
    for (std::uint32_t& part : missing)
        ++part;
    for (const std::string& fault : check.faults)
        session.say(fault);
    session.report({{"parts", check.num_parts}, {"missing", missing}, {"faults", check.faults}});
    if (!check.missing.empty())
        throw std::runtime_error(fmt::format("expected all {} parts, got none that is part {}",
                                             check.num_parts, ranges_of(missing)));
    if (!check.is_whole())
        throw std::runtime_error(fmt::format(
            "expected parts that can be joined, got {} that cannot", check.faults.size()));
    session.say(fmt::format("all {} parts are there and whole", check.num_parts));
}

void join_files(const std::vector<std::filesystem::path>& parts, const std::string& output,
                const Session& session) {
    Stopwatch watch;
    if (extension_of(output) == ".npy")
        join_light(parts, output);
    else
        join(parts, output);
    const std::uintmax_t file_bytes = std::filesystem::file_size(output);
    const double seconds = watch.total();
    session.say(fmt::format("{}: {} parts in {:.1f} s, {:.1f} MB", output, parts.size(), seconds,
                            static_cast<double>(file_bytes) * 1e-6));
    session.report({{"parts", parts.size()},
                    {"peak_bytes", peak_bytes()},
                    {"file_bytes", file_bytes},
                    {"seconds", seconds}});
}

} // namespace

void add_join(Command& program, Session& session) {
    struct Options {
        std::vector<std::string> parts;
        std::string output;
        bool check = false;
    };
    Command command = program.add_command(
        "join", "put parts together: of a planned precompute -> SCENE.prt, of light -> OUT.npy");
    auto options = std::make_shared<Options>();
    command.add(row("PART", options->parts,
                    "all parts that `relumine precompute --part` or `relumine relight --part` "
                    "wrote, in any order",
                    {.file = true, .required = true}));
    command.add(row("-o,--output", options->output,
                    "the scene file to write, .prt; of light the numbers, .npy", {.file = true}));
    command.add(row("--check", options->check,
                    "say which parts are missing or damaged, and write nothing"));
    session.add_common_options(command);
    command.on_run([options, &session] {
        const std::vector<std::filesystem::path> parts(options->parts.begin(),
                                                       options->parts.end());
        if (options->check) {
            check_parts(parts, session);
            return;
        }
        if (options->output.empty())
            throw UsageError("--output", "expected a file to write, or --check");
        require_extension("--output", options->output, {".prt", ".npy"});
        check_output(options->output, options->parts);
        join_files(parts, options->output, session);
    });
}

} // namespace relumine::app
