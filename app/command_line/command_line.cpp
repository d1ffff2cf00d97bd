#include "app/command_line/command_line.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/command_table.h"
#include "files/joined.h"
#include "files/nearest_name.h"

namespace relumine::app {

struct Option::Data {
    CLI::Option* option = nullptr;
    OptionRow row = {};
};

struct Command::Data {
    CLI::App* app = nullptr;
    /// The app that `app` points to, of the program itself; null for its commands
    std::unique_ptr<CLI::App> owned = {};
    std::vector<std::unique_ptr<Option::Data>> options = {};
    std::vector<std::unique_ptr<Command::Data>> commands = {};
    /// All that were given; the last one counts.
    std::deque<std::function<void()>> works = {};

    [[nodiscard]] CommandTable table() const;
};

namespace {

/// The command that the line named last: `convert` in `relumine env convert`.
const CLI::App& last_command(const CLI::App& app) {
    const std::vector<CLI::App*> below = app.get_subcommands();
    return below.empty() ? app : last_command(*below.back());
}

/// "relumine env convert"
std::string full_name(const CLI::App& app) {
    return app.get_parent() == nullptr
               ? app.get_name()
               : fmt::format("{} {}", full_name(*app.get_parent()), app.get_name());
}

/// An option that may stand without its value takes the argument behind it for one.
std::string hint(const OptionRow& row, const CLI::App& command, const std::string& text) {
    const auto arguments =
        command.get_options([](const CLI::Option* option) { return option->get_positional(); });
    if (!row.bare || arguments.empty() || text.empty() || parse_number(text))
        return {};
    std::string name = arguments.front()->get_name(true);
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return fmt::format("; the {} goes first: {} {} {}", name, full_name(command), text,
                       row.long_name());
}

std::vector<std::string> names_of_commands(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(command->get_name());
    return names;
}

std::vector<std::string> names_of_options(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : option->get_lnames())
            names.push_back("--" + name);
    return names;
}

/// A pattern that these names fit: 'frames/*.exr'. Empty where they are no files of one kind, which
/// a shell would have put in a pattern's place.
std::string pattern_of(const std::vector<std::string>& names) {
    namespace fs = std::filesystem;
    const fs::path first = names.front();
    if (names.size() < 2 || !first.has_extension())
        return {};
    std::string stem = first.stem().string();
    for (const std::string& name : names) {
        std::error_code error;
        const fs::path path = name;
        if (path.parent_path() != first.parent_path() || path.extension() != first.extension() ||
            !fs::is_regular_file(path, error))
            return {};
        const std::string other = path.stem().string();
        const auto end = std::mismatch(stem.begin(), stem.end(), other.begin(), other.end()).first;
        stem.erase(end, stem.end());
    }
    return (first.parent_path() / fmt::format("{}*{}", stem, first.extension().string())).string();
}

/// The name of a file that stands without quotes: some words in a row, with blanks between them.
/// Empty where no such file exists.
std::string file_of_words(const std::vector<std::string>& words) {
    // Longer lists of files are no name.
    constexpr std::size_t MostWords = 64;
    for (std::size_t first = 0; first < words.size() && words.size() <= MostWords; ++first) {
        std::string name = words[first];
        for (std::size_t next = first + 1; next < words.size(); ++next) {
            name += " " + words[next];
            std::error_code error;
            if (std::filesystem::is_regular_file(name, error))
                return name;
        }
    }
    return {};
}

/// The option of CLI11 with all that the row says. The row must stay where it is.
CLI::Option* add_value(CLI::App& app, const OptionRow& row) {
    const auto read = [&row, &app](const CLI::results_t& texts) {
        try {
            row.set(texts);
        } catch (const OptionError& error) {
            const std::string more = hint(row, app, texts.back());
            if (more.empty())
                throw;
            throw OptionError(error.option, error.reason + more);
        }
        return true;
    };
    CLI::Option* option = app.add_option(row.name, read, row.help);
    const std::string limits =
        row.choices.empty() ? row.range() : fmt::format("{{{}}}", files::joined(row.choices, ","));
    option->type_name(limits.empty() ? row.type : fmt::format("{}:{}", row.type, limits));
    option->default_str(row.shown_default());
    if (row.separator != 0)
        option->delimiter(row.separator);
    if (row.bare)
        option->expected(0, 1);
    else if (row.repeats)
        option->expected(CLI::detail::expected_max_vector_size);
    return option;
}

/// What is wrong with arguments that are more than the command takes. A pattern without quotes is
/// the usual reason: the shell replaces it by the names of the files.
std::string surplus(const CLI::App& command, const std::vector<std::string>& rest) {
    const CLI::Option* last = nullptr;
    std::vector<std::string> given;
    for (const CLI::Option* option : command.get_options())
        if (option->get_positional() && option->count() > 0) {
            last = option;
            given.insert(given.end(), option->results().begin(), option->results().end());
        }
    given.insert(given.end(), rest.begin(), rest.end());
    const std::string name = last == nullptr ? full_name(command) : last->get_name(true);
    if (const std::string file = file_of_words(given); !file.empty())
        return fmt::format("{}: expected one name, got its words; put a name with blanks in "
                           "quotes: '{}'",
                           name, file);
    // The first arguments may be others: SCENE.prt before the frames.
    for (auto start = given.begin(); given.end() - start > static_cast<std::ptrdiff_t>(rest.size());
         ++start) {
        const std::string pattern = pattern_of({start, given.end()});
        if (!pattern.empty())
            return fmt::format("{}: expected one name, got {} files; put a pattern in quotes: "
                               "'{}'",
                               name, given.end() - start, pattern);
    }
    return fmt::format("{}: expected no argument more, got '{}'", name, rest.front());
}

/// What to tell of a line that CLI11 refuses: the first thing that is wrong, which need not be what
/// CLI11 looks at first.
std::string complaint(const CLI::App& command, const CLI::ParseError& error) {
    std::vector<std::string> rest = command.remaining();
    // CLI11 leaves the two dashes there; no options follow them.
    const auto dashes = std::find(rest.begin(), rest.end(), "--");
    const auto option = std::find_if(rest.begin(), dashes, [](const std::string& word) {
        return word.size() > 1 && word.front() == '-';
    });
    const std::vector<std::string> commands = names_of_commands(command);
    // After a wrong command, no option is right.
    if (option != dashes && (commands.empty() || option == rest.begin())) {
        const std::string name = option->substr(0, option->find('='));
        return fmt::format("{}: no option of `{}`{}", name, full_name(command),
                           files::did_you_mean(name, names_of_options(command)));
    }
    std::erase(rest, "--");
    if (!commands.empty() && !rest.empty())
        return fmt::format("expected a command, got '{}'{}", rest.front(),
                           files::did_you_mean(rest.front(), commands));
    if (!commands.empty())
        return fmt::format("a command is required: {}", files::joined_by_or(commands));
    if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !rest.empty())
        return surplus(command, rest);
    return error.what();
}

} // namespace

CommandTable Command::Data::table() const {
    CommandTable table{.name = app->get_name(), .description = app->get_description()};
    for (const CLI::Option* option : std::as_const(*app).get_options()) {
        const auto own = std::find_if(options.begin(), options.end(), [option](const auto& each) {
            return each->option == option;
        });
        if (own != options.end()) {
            table.options.push_back((*own)->row);
            continue;
        }
        std::string names;
        for (const std::string& name : option->get_snames())
            names += "-" + name + ",";
        for (const std::string& name : option->get_lnames())
            names += "--" + name;
        OptionRow made{{}, names, option->get_description()};
        made.is_flag = true;
        table.options.push_back(std::move(made));
    }
    for (const std::unique_ptr<Data>& command : commands)
        table.commands.push_back(command->table());
    return table;
}

Option Option::required(bool is_required) {
    data_->row.required = is_required;
    data_->option->required(is_required);
    return *this;
}

Option Option::description(const std::string& text) {
    data_->row.help = text;
    data_->option->description(text);
    return *this;
}

bool Option::is_given() const {
    return data_ != nullptr && data_->option->count() > 0;
}

const OptionRow& Option::row() const {
    return data_->row;
}

Command Command::add_command(const std::string& name, const std::string& description) {
    data_->app->require_subcommand(1);
    auto data = std::make_unique<Data>();
    data->app = data_->app->add_subcommand(name, description);
    data_->commands.push_back(std::move(data));
    return Command(*data_->commands.back());
}

Option Command::add(OptionRow row) {
    auto data = std::make_unique<Option::Data>();
    data->row = std::move(row);
    const OptionRow& own = data->row;
    CLI::App& app = *data_->app;
    if (own.is_flag) {
        const auto read = [&own](std::int64_t count) {
            own.set(count > 0 ? "true" : "false");
        };
        data->option = app.add_flag_function(own.name, read, own.help);
    } else {
        data->option = add_value(app, own);
    }
    data->option->required(own.required);
    if (!own.needs.empty())
        data->option->needs(own.needs);
    if (!own.excludes.empty())
        data->option->excludes(own.excludes);
    data_->options.push_back(std::move(data));
    return Option(*data_->options.back());
}

std::vector<Option> Command::add_all(OptionTable table) {
    std::vector<Option> options;
    for (OptionRow& row : table)
        if (!row.library_only)
            options.push_back(add(std::move(row)));
    return options;
}

std::vector<std::string> Command::given_options() const {
    std::vector<std::string> names;
    for (const auto& option : data_->options)
        if (option->option->count() > 0)
            names.push_back(option->row.long_name());
    return names;
}

std::string Command::settings() const {
    OptionTable table;
    for (const auto& option : data_->options)
        table.push_back(option->row);
    return settings_of(table);
}

void Command::footer(const std::string& text) {
    data_->app->footer(text);
}

void Command::on_run(std::function<void()> work) {
    // The options' variables may live in the work, also in one that this replaces.
    data_->works.push_back(std::move(work));
    data_->app->callback([&last = data_->works.back()] { last(); });
}

Command Command::command(const std::string& name) const {
    for (const std::unique_ptr<Data>& each : data_->commands)
        if (each->app->get_name() == name)
            return Command(*each);
    throw std::out_of_range(fmt::format("no command {}", name));
}

namespace {

/// Writes defaults as `=7` with all versions of CLI11: newer ones write ` [7] `.
class HelpFormatter : public CLI::Formatter {
public:
    std::string make_option_opts(const CLI::Option* option) const override {
        std::string text = CLI::Formatter::make_option_opts(option);
        const std::string newer = " [" + option->get_default_str() + "] ";
        if (const std::size_t at = text.find(newer); at != std::string::npos)
            text.replace(at, newer.size(), "=" + option->get_default_str());
        return text;
    }
};

} // namespace

CommandLine::CommandLine(const std::string& name, const std::string& description,
                         std::function<std::string()> version)
    : data_(std::make_unique<Command::Data>()) {
    data_->owned = std::make_unique<CLI::App>(description, name);
    data_->app = data_->owned.get();
    data_->app->formatter(std::make_shared<HelpFormatter>());
    if (version)
        data_->app->set_version_flag("--version", [name, version = std::move(version)] {
            return fmt::format("{} {}", name, version());
        });
}

CommandLine::~CommandLine() = default;

Command CommandLine::root() const {
    return Command(*data_);
}

void CommandLine::before_run(std::function<void()> work) {
    data_->app->parse_complete_callback(std::move(work));
}

std::string CommandLine::run(std::vector<std::string> arguments) {
    CLI::App& app = *data_->app;
    std::reverse(arguments.begin(), arguments.end()); // as CLI11 wants them
    try {
        app.parse(std::move(arguments));
        return {};
    } catch (const CLI::CallForHelp&) {
        return app.help();
    } catch (const CLI::CallForVersion& version) {
        return fmt::format("{}\n", version.what());
    } catch (const CLI::ParseError& error) {
        throw UsageError(complaint(last_command(app), error));
    }
}

std::string CommandLine::command_name() const {
    return full_name(last_command(*data_->app));
}

std::string CommandLine::help(const std::vector<std::string>& words) const {
    const CLI::App* command = data_->app;
    for (const std::string& word : words) {
        const auto below = command->get_subcommands(
            [&word](const CLI::App* each) { return each->get_name() == word; });
        if (below.empty())
            throw UsageError(fmt::format("expected a command, got '{}'{}", word,
                                         files::did_you_mean(word, names_of_commands(*command))));
        command = below.front();
    }
    // Not App::help(), which looks at the line that was read.
    return command->get_formatter()->make_help(command, full_name(*command),
                                               CLI::AppFormatMode::Normal);
}

CommandTable CommandLine::table() const {
    return data_->table();
}

} // namespace relumine::app
