// The command line: commands, their options, and the work that runs when the line has been read.
// The parser behind it is CLI11, which only command_line.cpp sees: it takes seconds to compile.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "relumine/options/option_table.h"

namespace relumine::app {

struct CommandTable;

/// Wrong usage, which the program answers with one line and exit code 2.
using UsageError = OptionError;

/// A handle of one option of a command, valid as long as its CommandLine.
class Option {
public:
    /// No option: was never given.
    Option() = default;

    Option required(bool is_required);
    Option description(const std::string& text);

    /// Whether the line that was read has it.
    [[nodiscard]] bool is_given() const;
    [[nodiscard]] const OptionRow& row() const;
    /// The long name where it has one: "--output"
    [[nodiscard]] std::string name() const { return row().long_name(); }

private:
    friend class Command;
    struct Data;
    explicit Option(Data& data) : data_(&data) {}
    Data* data_ = nullptr;
};

/// A handle of one command, valid as long as its CommandLine. Variables and functions that it is
/// given must live until the line has been read and the work is done.
class Command {
public:
    /// A command of its own below this one, which then asks for one of its commands.
    Command add_command(const std::string& name, const std::string& description);

    /// An option "-o,--output" or an argument "MESH". It takes one value, or any number of values
    /// where it repeats. Empty values are refused: an unset variable of a script must not read as 0
    /// or as the current folder.
    Option add(OptionRow row);
    /// Adds all rows but those of the library alone (OptionFacts::library_only).
    std::vector<Option> add_all(OptionTable table);

    /// Text below the options in the help.
    void footer(const std::string& text);
    /// The command's work, in place of an earlier one.
    void on_run(std::function<void()> work);

    /// The names of the options and arguments that the line that was read has: "--output", "MESH".
    [[nodiscard]] std::vector<std::string> given_options() const;
    /// All options that shape frames, with their values, as one text.
    [[nodiscard]] std::string settings() const;

    /// The command of that name below this one. Throws std::out_of_range where there is none.
    [[nodiscard]] Command command(const std::string& name) const;

private:
    friend class CommandLine;
    struct Data;
    explicit Command(Data& data) : data_(&data) {}
    Data* data_ = nullptr;
};

/// The whole program's command line.
class CommandLine {
public:
    /// `version` is asked for --version alone.
    CommandLine(const std::string& name, const std::string& description,
                std::function<std::string()> version = {});
    ~CommandLine();
    CommandLine(const CommandLine&) = delete;
    CommandLine& operator=(const CommandLine&) = delete;

    /// The program itself, to add commands to.
    [[nodiscard]] Command root() const;
    /// Runs when the line has been read, before a command's work.
    void before_run(std::function<void()> work);

    /// Reads the arguments, without the program's name, and does the command's work. Returns the
    /// text that --help or --version ask for, and nothing after work. Throws UsageError for wrong
    /// usage, and whatever the work throws.
    [[nodiscard]] std::string run(std::vector<std::string> arguments);

    /// The command of the line that was read last, as it is typed: "relumine env convert".
    [[nodiscard]] std::string command_name() const;

    /// The help of a command, of the program for no words. Throws UsageError for an unknown one.
    [[nodiscard]] std::string help(const std::vector<std::string>& words) const;

    /// All commands and options, for documentation and completion.
    [[nodiscard]] CommandTable table() const;

private:
    std::unique_ptr<Command::Data> data_;
};

} // namespace relumine::app
