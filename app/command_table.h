// Commands and options as plain data: what documentation and completion are made from.
#pragma once

#include <string>
#include <vector>

namespace relumine::app {

/// One option or argument.
struct OptionTable {
    enum class Value { None, Text, Choice, File, Folder };

    /// "-o", "--output"; none for an argument
    std::vector<std::string> names = {};
    /// "MESH"; empty for an option
    std::string argument = {};
    std::string description = {};
    Value value = Value::None;
    /// What the help calls the value: "FILE", "FLOAT"
    std::string type = {};
    /// The allowed values of a Value::Choice.
    std::vector<std::string> choices = {};
    /// "0 to 100"; empty: any
    std::string range = {};
    /// The default as the help shows it. Empty: none.
    std::string default_value = {};
    bool is_required = false;
    bool value_is_optional = false;
    /// May be given several times
    bool repeats = false;

    [[nodiscard]] bool is_argument() const { return names.empty(); }
};

/// One command, with the commands below it.
struct CommandTable {
    std::string name = {};
    std::string description = {};
    /// Text below the options in the help
    std::string footer = {};
    /// In their order, --help included
    std::vector<OptionTable> options = {};
    std::vector<CommandTable> commands = {};
};

} // namespace relumine::app
