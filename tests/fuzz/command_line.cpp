// The command line. Two kinds of input:
//
// Text has one argument per line. The commands run as far as they come in an empty folder: none of
// their files exist. `generate`, `completion` and `help`, which need none, and `view`, which opens
// a window, are parsed only.
//
// Bytes after a zero draw command lines that do work on small files, with one or two options at the
// edges of numbers: four bytes each choose the line, the option, the number and how it is written.
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/command_line/command_line.h"
#include "app/command_table.h"
#include "app/commands.h"
#include "app/program.h"
#include "relight/pictures/array_file.h"
#include "tests/app/small_files.h"
#include "tests/fuzz/command_edges.h"
#include "tests/fuzz/fuzz.h"

namespace {

namespace fs = std::filesystem;
using namespace relumine;
using Words = std::vector<std::string>;

Words lines(std::string_view text) {
    Words result;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        result.emplace_back(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return result;
}

/// One for all inputs, since it takes the process's signals; as new.
app::Session& fresh_session() {
    static app::Session session;
    session.json = session.verbose = false;
    session.quiet = true;
    session.num_threads = 0;
    return session;
}

/// Returns true for a line that is not refused as wrong usage.
bool run(app::CommandLine& program, const Words& arguments) {
    try {
        static_cast<void>(program.run(arguments));
        ++fuzz::num_accepted;
    } catch (const app::UsageError& error) {
        fuzz::require(!std::string_view(error.what()).empty(), "wrong usage is told");
        return false;
    } catch (const std::invalid_argument&) {
    } catch (const std::runtime_error& error) {
        fuzz::require_message(error);
        ++fuzz::num_accepted; // the line was right, its files were missing
    }
    return true;
}

/// A new folder below the target's, which becomes the current one.
fs::path enter(const char* name) {
    fs::path path = fuzz::folder() / name;
    fs::create_directory(path);
    fs::current_path(path);
    return path;
}

void write(const fs::path& path, const std::string& content) {
    std::ofstream(path, std::ios::binary) << content;
}

/// Lines that work in the folder with the small files. All that they write begins with "new".
const std::vector<Words>& working_lines() {
    static const std::vector<Words> All = {
        {"precompute", "mesh.obj", "-o", "new.prt", "--face-resolution", "8", "--refine", "off"},
        {"precompute", "mesh.obj", "-o", "new.prt", "--face-resolution", "8", "--receivers",
         "pixels:4x4", "--view", "0,0,3,0,0,0"},
        {"relight", "scene.prt", "env.0.hdr", "-o", "new.npy"},
        {"relight", "scene.prt", "env.0.hdr", "-o", "new.exr", "--size", "8x8"},
        {"edit", "scene.prt", "env.0.hdr", "-o", "new.npy", "--disc", "0,1,0,10"},
        {"edit", "scene.prt", "env.0.hdr", "-o", "new.exr", "--disc", "0,1,0,10", "--who", "0,1,0"},
        {"animate", "scene.prt", "env.%d.hdr", "-o", "new.%d.exr", "--size", "8x8"},
        {"animate", "scene.prt", "env.%d.hdr", "--vertices", "new.npy", "--method", "clusters"},
        {"verify", "scene.prt", "env.0.hdr", "--samples", "2"},
        {"lights", "env.0.hdr", "-o", "new.json"},
        {"lights", "env.0.hdr", "--scene", "scene.prt", "-n", "4", "-o", "new.json"},
        {"info", "scene.prt"},
        {"mesh", "refine", "mesh.obj", "-o", "new.ply", "--tolerance", "0.05", "--vertices", "40"},
        {"mesh", "repair", "mesh.obj", "-o", "new.obj", "--weld"},
        {"env", "convert", "env.0.hdr", "-o", "new.exr", "--size", "8x4"},
        {"generate", "blob", "-o", "new", "--vertices", "1000"},
        {"generate", "constant", "-o", "new", "--face-resolution", "8"},
        {"generate", "sequence", "flicker", "-o", "new", "--face-resolution", "8"},
    };
    return All;
}

/// The folder with what the lines read.
const fs::path& working_folder() {
    static const fs::path Path = [] {
        fs::path path = enter("full");
        write("mesh.obj", app::octahedron_obj());
        for (int frame = 0; frame < 2; ++frame)
            write(fmt::format("env.{}.hdr", frame), app::hdr_file(16, 8, [frame](auto x, auto) {
                      const auto value = static_cast<float>(x == 0 ? 64 << frame : 1);
                      return app::Rgb{value, value, value};
                  }));
        app::CommandLine program("relumine", "");
        app::add_commands(program, fresh_session());
        static_cast<void>(program.run({"precompute", "mesh.obj", "-o", "scene.prt",
                                       "--face-resolution", "8", "--refine", "off", "-q"}));
        return path;
    }();
    return Path;
}

const std::array<const char*, 8> Numbers = {"0",    "-1",         "1e-30", "1e19",
                                            "1e30", "4294967296", "nan",   "inf"};
/// Where a number may stand in a value.
const std::array<const char*, 12> Places = {
    "{}",           "{0},{0},{0}",     "1,{},2",        "{}x1",        "4294967297x{}",
    "{},0,0,0,0,1", "0,0,3,0,0,0,{}",  "pixels:1x1:{}", "texels:{}x1", "0,1,0,{}",
    "0-{}",         "ggx:roughness={}"};

/// Options of a line with a value that is no file.
OptionTable find_numeric_options(const Words& line) {
    app::CommandLine program("relumine", "");
    app::add_commands(program, fresh_session());
    app::CommandTable table = program.table();
    for (std::size_t i = 0; i < line.size() && !table.commands.empty(); ++i)
        for (const app::CommandTable& command : std::vector(table.commands))
            if (command.name == line[i])
                table = command;
    OptionTable result;
    for (const OptionRow& option : table.options)
        if (!option.is_argument() && !option.is_flag && !option.file && !option.folder &&
            option.choices.empty())
            result.push_back(option);
    return result;
}

/// The same, found once: the tables of all commands take longer than a run of most.
const OptionTable& numeric_options(std::size_t line) {
    static const std::vector<OptionTable> All = [] {
        std::vector<OptionTable> all;
        for (const Words& each : working_lines())
            all.push_back(find_numeric_options(each));
        return all;
    }();
    return All[line];
}

void set(Words& line, const OptionRow& option, const std::string& value) {
    for (const std::string& name : option.names())
        if (const auto at = std::find(line.begin(), line.end(), name); at != line.end())
            line.erase(at, at + 2);
    line.push_back(fmt::format("{}={}", option.long_name(), value));
    if (option.long_name() == "--refine") // a mesh as fine as an error of 0 asks for takes too long
        line.emplace_back("--vertices=40");
}

/// Removes what a line has written. What a .npy file holds is finite.
void clean() {
    for (const auto& entry : std::vector<fs::directory_entry>(
             fs::directory_iterator(fs::current_path()), fs::directory_iterator())) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with("new"))
            continue;
        if (name == "new.npy")
            for (const glm::vec3& value : relight::load_npy(entry.path()).values)
                fuzz::require(std::isfinite(value.r + value.g + value.b),
                              "what is written is finite");
        fs::remove_all(entry.path());
    }
}

/// Adds the command of a working line alone: the tables of the others take longer than its work.
void add_command(app::CommandLine& program, const std::string& name) {
    static const std::map<std::string, void (*)(app::Command&, app::Session&)> All = {
        {"precompute", app::add_precompute},
        {"relight", app::add_relight},
        {"edit", app::add_edit},
        {"animate", app::add_animate},
        {"verify", app::add_verify},
        {"lights", app::add_lights},
        {"info", app::add_info},
        {"mesh", app::add_mesh},
        {"env", app::add_env},
        {"generate", app::add_generate}};
    app::Command root = program.root();
    All.at(name)(root, fresh_session());
}

void run_at_edges(std::span<const std::uint8_t> draws) {
    if (draws.size() < 4)
        return;
    fs::current_path(working_folder());
    const std::size_t number = draws[0] % working_lines().size();
    Words line = working_lines()[number];
    app::CommandLine program("relumine", "");
    add_command(program, line[0]);
    const OptionTable& options = numeric_options(number);
    for (std::size_t i = 1; i + 3 <= draws.size() && i < 7; i += 3)
        set(line, options[draws[i] % options.size()],
            fmt::format(fmt::runtime(Places[draws[i + 2] % Places.size()]),
                        Numbers[draws[i + 1] % Numbers.size()]));
    line.emplace_back("--quiet");
    run(program, line);
    clean();
}

} // namespace

namespace relumine::fuzz {

std::vector<std::string> working_commands() {
    std::vector<std::string> names;
    for (const Words& line : working_lines())
        names.push_back(fmt::format("{}_{}", line[0], names.size()));
    return names;
}

std::size_t run_all_edges(std::size_t command) {
    std::size_t count = 0;
    const OptionTable& options = numeric_options(command);
    for (std::size_t option = 0; option < options.size(); ++option) {
        const bool is_number = options[option].type == "UINT" || options[option].type == "FLOAT";
        // In text, the fuzzer tries the other numbers.
        for (std::size_t number = 0; number < Numbers.size(); number += is_number ? 1 : 3)
            for (std::size_t place = 0; place < (is_number ? 1 : Places.size()); ++place) {
                const std::array<std::uint8_t, 4> draws = {
                    static_cast<std::uint8_t>(command), static_cast<std::uint8_t>(option),
                    static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(place)};
                run_at_edges(draws);
                ++count;
            }
    }
    return count;
}

} // namespace relumine::fuzz

RELUMINE_FUZZ_TARGET(command_line) {
    if (size > 0 && data[0] == 0) {
        run_at_edges(std::span(data, size).subspan(1));
        return 0;
    }
    static const fs::path Empty = enter("empty");
    fs::current_path(Empty);
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    // Arguments hold no zeros. A slash would lead out of the folder.
    if (text.find('\0') != std::string_view::npos || text.find('/') != std::string_view::npos)
        return 0;
    app::CommandLine program("relumine", "");
    app::add_commands(program, fresh_session());
    for (const char* name : {"generate", "view", "completion", "help"})
        program.root().command(name).on_run([] {});
    run(program, lines(text));
    fuzz::require(fs::is_empty(Empty), "a failed command leaves no file");
    return 0;
}
