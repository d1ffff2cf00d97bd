// A value of an option that is not the one it has.
#pragma once

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "relumine/options/option_table.h"

namespace relumine {

/// Returns a text that the option takes and that differs from its default. A failure for an option
/// whose type does not tell of one, and which has no example.
inline std::string other_value(const OptionRow& option) {
    if (option.is_flag)
        return option.initial == "true" ? "false" : "true";
    for (const std::string& choice : option.choices)
        if (choice != option.initial)
            return choice;
    if (!option.example.empty())
        return option.example;
    const double least = std::isfinite(option.min) ? option.min : 1.0;
    const std::string number = fmt::format("{}", least);
    if (option.type == "UINT" || option.type == "FLOAT" || !option.range().empty())
        return number != option.initial ? number : fmt::format("{}", least + 1.0);
    ADD_FAILURE() << option.name << ": expected an example in its row";
    return "";
}

} // namespace relumine
