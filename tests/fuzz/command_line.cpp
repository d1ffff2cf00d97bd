// The command line, one argument per line of the input. The commands run as far as they come in an
// empty folder: none of their files exist. `generate`, `completion` and `man`, which need
// none, and `view`, which opens a window, are parsed only.
#include <memory>
#include <vector>

#include "app/command_line.h"
#include "app/program.h"
#include "tests/fuzz/fuzz.h"

namespace {

using namespace relumine;

std::vector<std::string> lines(std::string_view text) {
    std::vector<std::string> result;
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
    session.json = session.quiet = session.verbose = false;
    session.num_threads = 0;
    return session;
}

void run(app::CommandLine& program, const std::vector<std::string>& arguments) {
    try {
        static_cast<void>(program.run(arguments));
        ++fuzz::num_accepted;
    } catch (const app::UsageError& error) {
        fuzz::require(std::string_view(error.what()).size() > 0, "wrong usage is told");
    } catch (const std::invalid_argument&) {
    } catch (const std::runtime_error& error) {
        fuzz::require_message(error);
        ++fuzz::num_accepted; // the line was right, its files were missing
    }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const bool is_inside = [] {
        const std::filesystem::path empty = fuzz::folder() / "empty";
        std::filesystem::create_directory(empty);
        std::filesystem::current_path(empty);
        return true;
    }();
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    // Arguments hold no zeros. A slash would lead out of the folder.
    if (!is_inside || text.find('\0') != std::string_view::npos ||
        text.find('/') != std::string_view::npos)
        return 0;
    app::CommandLine program("relumine", "", "");
    app::add_commands(program, fresh_session());
    for (const char* name : {"generate", "view", "completion", "man"})
        program.root().command(name).on_run([] {});
    run(program, lines(text));
    fuzz::require(std::filesystem::is_empty(std::filesystem::current_path()),
                  "a failed command leaves no file");
    return 0;
}
