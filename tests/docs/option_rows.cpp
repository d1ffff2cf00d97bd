// Prints the options of pictures as the table of docs/command-line.md.
#include <fmt/format.h>

#include "relumine/options/option_table.h"
#include "relumine/relumine.h"

int main() {
    relumine::OutputOptions options;
    fmt::print("| option | meaning |\n|---|---|\n");
    for (const relumine::OptionRow& option : relumine::options_of(options)) {
        std::string values = option.type;
        for (const std::string& choice : option.choices)
            values = (&choice == &option.choices.front() ? "" : values + "\\|") + choice;
        std::string more;
        if (!option.range().empty())
            more += fmt::format("; {}", option.range());
        if (!option.is_flag && !option.shown_default().empty())
            more += fmt::format(" ({})", option.shown_default());
        fmt::print("| `{}{}{}` | {}{} |\n", option.name, values.empty() ? "" : " ", values,
                   option.help, more);
    }
}
