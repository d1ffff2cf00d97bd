#include "app/options/memory_option.h"

#include <cctype>
#include <cstdlib>

#include <fmt/format.h>

namespace relumine::app {

std::optional<std::uint64_t> parse_size(const std::string& text) {
    if (text.empty() || std::isdigit(static_cast<unsigned char>(text.front())) == 0)
        return {};
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    const std::string unit = end;
    double factor = 1.0;
    if (unit != "B") {
        const std::string units = "KMGT";
        if (unit.empty())
            return {};
        const auto at =
            units.find(static_cast<char>(std::toupper(static_cast<unsigned char>(unit.front()))));
        const bool is_known = at != std::string::npos &&
                              (unit.size() == 1 || unit.substr(1) == "B" || unit.substr(1) == "iB");
        if (!is_known)
            return {};
        factor = static_cast<double>(std::uint64_t{1} << (10 * (at + 1)));
    }
    const double bytes = number * factor;
    if (!(bytes >= 1.0 && bytes < 1e18))
        return {};
    return static_cast<std::uint64_t>(bytes);
}

void MemoryOption::add_to(Command& command) {
    command
        .add_option(
            "--max-memory",
            [this](const std::string& text) {
                max_bytes_ = parse_size(text);
                if (!max_bytes_)
                    throw UsageError(
                        "--max-memory",
                        parse_count(text)
                            ? fmt::format("expected a unit after the number, as in {0}M or "
                                          "{0}G, got '{0}'",
                                          text)
                            : fmt::format("expected a size like 500M or 4G, got '{}'", text));
            },
            "refuse the work when it would take more memory, stop when it does: 500M, 4G")
        .type_name("SIZE");
}

} // namespace relumine::app
