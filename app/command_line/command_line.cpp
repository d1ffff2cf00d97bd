#include "app/command_line/command_line.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <limits>
#include <type_traits>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/command_table.h"
#include "files/joined.h"
#include "files/nearest_name.h"

namespace relumine::app {

struct Option::Data {
    CLI::Option* option = nullptr;
    OptionTable::Value value = OptionTable::Value::Text;
    std::vector<std::string> choices = {};
    std::string range = {};
    /// Without what its checks say
    std::string type = {};
};

struct Command::Data {
    CLI::App* app = nullptr;
    /// Of the program itself
    std::unique_ptr<CLI::App> owned = {};
    std::vector<std::unique_ptr<Option::Data>> options = {};
    std::vector<std::unique_ptr<Command::Data>> commands = {};
    /// All that were given; the last one counts.
    std::deque<std::function<void()>> works = {};

    [[nodiscard]] CommandTable table() const;
};

namespace {

/// `long double`, so that a float is rounded once from the decimal number, as good as always.
std::optional<long double> long_number(const std::string& text) {
    char* end = nullptr;
    const long double value = std::strtold(text.c_str(), &end);
    if (text.empty() || end != text.c_str() + text.size())
        return std::nullopt;
    return value;
}

template<typename T>
std::optional<T> whole_number(std::string_view text) {
    T value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
        return std::nullopt;
    return value;
}

/// How the values of one type are read and shown. `check` returns what is wrong, or nothing.
template<typename T>
struct Value;

template<>
struct Value<std::string> {
    static constexpr const char* TypeName = "TEXT";
    static std::string check(const std::string& /*text*/) { return {}; }
    static std::string read(const std::string& text) { return text; }
    static std::string show(const std::string& value) { return value; }
};

template<typename T>
requires std::is_unsigned_v<T>
struct Value<T> {
    static constexpr const char* TypeName = "UINT";
    static std::string check(const std::string& text) {
        return whole_number<T>(text) ? std::string()
                                     : fmt::format("expected a whole number of 0 to {}, got '{}'",
                                                   std::numeric_limits<T>::max(), text);
    }
    static T read(const std::string& text) { return whole_number<T>(text).value(); }
    static std::string show(T value) { return fmt::format("{}", value); }
};

template<typename T>
requires std::is_floating_point_v<T>
struct Value<T> {
    static constexpr const char* TypeName = "FLOAT";
    static std::string check(const std::string& text) {
        const std::optional<long double> number = long_number(text);
        if (!number)
            return fmt::format("expected a number, got '{}'", text);
        if (!std::isfinite(static_cast<T>(*number)))
            return fmt::format("expected a number within {}, got '{}'",
                               std::numeric_limits<T>::max(), text);
        return {};
    }
    static T read(const std::string& text) { return static_cast<T>(long_number(text).value()); }
    static std::string show(T value) { return fmt::format("{}", value); }
};

template<typename T>
struct Value<std::optional<T>> : Value<T> {
    static std::string show(const std::optional<T>& value) {
        return value ? Value<T>::show(*value) : std::string();
    }
};

template<typename T>
struct Value<std::vector<T>> : Value<T> {
    static std::vector<T> read(const std::vector<std::string>& texts) {
        std::vector<T> values;
        values.reserve(texts.size());
        for (const std::string& text : texts)
            values.push_back(Value<T>::read(text));
        return values;
    }
    static std::string show(const std::vector<T>& values) {
        std::string text;
        for (const T& value : values)
            text += (text.empty() ? "" : ",") + Value<T>::show(value);
        return text;
    }
};

template<typename T>
constexpr bool IsVector = false;
template<typename T>
constexpr bool IsVector<std::vector<T>> = true;

std::string not_empty(const std::string& text) {
    return text.empty() ? "expected a value, got ''" : "";
}

/// The CLI11 option that calls `read` with its texts; values are checked before.
CLI::Option& add(CLI::App& app, const std::string& name, const std::string& description,
                 CLI::callback_t read, std::function<std::string()> show = {}) {
    return *app.add_option(name, std::move(read), description, false, std::move(show));
}

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
    if (option != dashes) {
        const std::string name = option->substr(0, option->find('='));
        return fmt::format("{}: no option of `{}`{}", name, full_name(command),
                           files::did_you_mean(name, names_of_options(command)));
    }
    std::erase(rest, "--");
    const std::vector<std::string> commands = names_of_commands(command);
    if (!commands.empty() && !rest.empty())
        return fmt::format("expected a command, got '{}'{}", rest.front(),
                           files::did_you_mean(rest.front(), commands));
    if (!commands.empty())
        return fmt::format("a command is required: {}", one_of_text(commands));
    if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !rest.empty())
        return surplus(command, rest);
    return error.what();
}

} // namespace

CommandTable Command::Data::table() const {
    CommandTable table{.name = app->get_name(),
                       .description = app->get_description(),
                       .footer = app->get_footer()};
    for (const CLI::Option* option : std::as_const(*app).get_options()) {
        const auto own = std::find_if(options.begin(), options.end(), [option](const auto& each) {
            return each->option == option;
        });
        OptionTable row{.argument = option->get_positional() ? option->get_name(true) : "",
                        .description = option->get_description(),
                        .default_value = option->get_default_str(),
                        .is_required = option->get_required(),
                        .repeats = option->get_expected_max() > 1};
        for (const std::string& name : option->get_snames())
            row.names.push_back("-" + name);
        for (const std::string& name : option->get_lnames())
            row.names.push_back("--" + name);
        if (own != options.end()) {
            row.value = (*own)->value;
            row.choices = (*own)->choices;
            row.range = (*own)->range;
        }
        if (row.value != OptionTable::Value::None) {
            row.type = (*own)->type;
            row.value_is_optional = option->get_expected_min() == 0;
        }
        table.options.push_back(std::move(row));
    }
    for (const std::unique_ptr<Data>& command : commands)
        table.commands.push_back(command->table());
    return table;
}

UsageError::UsageError(const std::string& option, const std::string& message)
    : std::runtime_error(fmt::format("{}: {}", option, message)) {}

Option Option::required(bool is_required) {
    data_->option->required(is_required);
    return *this;
}

Option Option::show_default() {
    data_->option->capture_default_str();
    return *this;
}

Option Option::one_of(const std::vector<std::string>& choices) {
    data_->option->check(CLI::Validator(
        [choices](const std::string& text) {
            return std::find(choices.begin(), choices.end(), text) != choices.end()
                       ? std::string()
                       : fmt::format("expected {}, got '{}'{}", one_of_text(choices), text,
                                     files::did_you_mean(text, choices));
        },
        fmt::format("{{{}}}", files::joined(choices, ","))));
    data_->value = OptionTable::Value::Choice;
    data_->choices = choices;
    return *this;
}

Option Option::between(double min, double max) {
    data_->range = fmt::format("{} to {}", min, max);
    data_->option->check(CLI::Validator(
        [min, max](const std::string& text) {
            const std::optional<double> value = parse_number(text);
            return value && *value >= min && *value <= max
                       ? std::string()
                       : fmt::format("expected {} to {}, got '{}'", min, max, text);
        },
        data_->range));
    return *this;
}

Option Option::type_name(const std::string& name) {
    data_->type = name;
    data_->option->type_name(name);
    return *this;
}

Option Option::description(const std::string& text) {
    data_->option->description(text);
    return *this;
}

Option Option::file() {
    data_->value = OptionTable::Value::File;
    return type_name("FILE");
}

Option Option::folder() {
    data_->value = OptionTable::Value::Folder;
    return type_name("FOLDER");
}

Option Option::value_is_optional() {
    data_->option->expected(0, 1);
    return *this;
}

Option Option::separated_by(char delimiter) {
    data_->option->delimiter(delimiter);
    return *this;
}

Option Option::needs(const std::string& name) {
    data_->option->needs(name);
    return *this;
}

Option Option::excludes(const std::string& name) {
    data_->option->excludes(name);
    return *this;
}

std::vector<std::string> Command::given_options() const {
    std::vector<std::string> names;
    for (const auto& option : data_->options)
        if (option->option->count() > 0)
            names.push_back(option->option->get_name());
    return names;
}

bool Option::is_given() const {
    return data_ != nullptr && data_->option->count() > 0;
}

std::string Option::name() const {
    return data_->option->get_name();
}

Command Command::add_command(const std::string& name, const std::string& description) {
    data_->app->require_subcommand(1);
    auto data = std::make_unique<Data>();
    data->app = data_->app->add_subcommand(name, description);
    data_->commands.push_back(std::move(data));
    return Command(*data_->commands.back());
}

template<typename T>
Option Command::add_value(const std::string& name, T& value, const std::string& description) {
    CLI::Option& option = add(
        *data_->app, name, description,
        [&value](const CLI::results_t& texts) {
            if constexpr (IsVector<T>)
                value = Value<T>::read(texts);
            else
                value = Value<T>::read(texts.back());
            return true;
        },
        [&value] { return Value<T>::show(value); });
    option.check(CLI::Validator(not_empty, ""));
    option.check(CLI::Validator(Value<T>::check, ""));
    if constexpr (IsVector<T>)
        option.expected(CLI::detail::expected_max_vector_size);
    data_->options.push_back(std::make_unique<Option::Data>(Option::Data{&option}));
    return Option(*data_->options.back()).type_name(Value<T>::TypeName);
}

Option Command::add_option(const std::string& name, std::string& value,
                           const std::string& description) {
    return add_value(name, value, description);
}

Option Command::add_option(const std::string& name, std::uint32_t& value,
                           const std::string& description) {
    return add_value(name, value, description);
}

Option Command::add_option(const std::string& name, std::uint64_t& value,
                           const std::string& description) {
    return add_value(name, value, description);
}

Option Command::add_option(const std::string& name, float& value, const std::string& description) {
    return add_value(name, value, description);
}

Option Command::add_option(const std::string& name, double& value, const std::string& description) {
    return add_value(name, value, description);
}

Option Command::add_option(const std::string& name, std::optional<float>& value,
                           const std::string& description) {
    return add_value(name, value, description);
}

Option Command::add_option(const std::string& name, std::optional<double>& value,
                           const std::string& description) {
    return add_value(name, value, description);
}

Option Command::add_option(const std::string& name, std::vector<std::string>& values,
                           const std::string& description) {
    return add_value(name, values, description);
}

Option Command::add_option(const std::string& name, std::vector<std::uint64_t>& values,
                           const std::string& description) {
    return add_value(name, values, description);
}

Option Command::add_option(const std::string& name, std::function<void(const std::string&)> read,
                           const std::string& description) {
    CLI::Option& option =
        add(*data_->app, name, description, [read = std::move(read)](const CLI::results_t& texts) {
            read(texts.back());
            return true;
        });
    data_->options.push_back(std::make_unique<Option::Data>(Option::Data{&option}));
    return Option(*data_->options.back());
}

Option Command::add_flag(const std::string& name, bool& value, const std::string& description) {
    CLI::Option* option = data_->app->add_flag(name, value, description);
    data_->options.push_back(
        std::make_unique<Option::Data>(Option::Data{option, OptionTable::Value::None}));
    return Option(*data_->options.back());
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

CommandLine::CommandLine(const std::string& name, const std::string& description,
                         const std::string& version)
    : data_(std::make_unique<Command::Data>()) {
    data_->owned = std::make_unique<CLI::App>(description, name);
    data_->app = data_->owned.get();
    data_->app->set_version_flag("--version", fmt::format("{} {}", name, version));
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

std::string one_of_text(const std::vector<std::string>& choices) {
    if (choices.size() < 2)
        return choices.empty() ? std::string() : choices.front();
    return fmt::format("{} or {}",
                       files::joined(std::span(choices).first(choices.size() - 1), ", "),
                       choices.back());
}

std::optional<double> parse_number(const std::string& text) {
    const std::optional<long double> number = long_number(text);
    return number ? std::optional(static_cast<double>(*number)) : std::nullopt;
}

std::optional<std::uint32_t> parse_count(std::string_view text) {
    return whole_number<std::uint32_t>(text);
}

} // namespace relumine::app
