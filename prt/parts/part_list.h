// All parts of a whole, each once.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "prt/team.h"

namespace relumine::prt {

/// Reads files by read(path), which returns a value with `part` and `whole`, a text that is the
/// same in all parts that belong together. Returns them by index. `whole_name` is what they are
/// parts of.
///
/// Throws:  std::runtime_error that names a part that is of another whole or number of parts, given
///          twice or missing; as read() does.
template<typename Read>
auto all_parts_of(const std::string& whole_name, std::span<const std::filesystem::path> paths,
                  const Read& read) {
    using Stored = decltype(read(paths[0]));
    std::vector<std::optional<Stored>> parts;
    std::vector<std::filesystem::path> path_of;
    std::string whole;
    const auto refuse = [](const std::filesystem::path& path, const std::string& expected,
                           const std::string& got) {
        throw std::runtime_error(
            fmt::format("{}: expected {}, got {}", path.string(), expected, got));
    };
    for (const std::filesystem::path& path : paths) {
        Stored stored = read(path);
        const Part part = stored.part;
        if (parts.empty()) {
            parts.resize(part.count);
            path_of.resize(part.count);
            whole = stored.whole;
        }
        if (stored.whole != whole)
            refuse(path, fmt::format("a part of the same {} as {}", whole_name, paths[0].string()),
                   fmt::format("another {}'s", whole_name));
        if (part.count != parts.size())
            refuse(path, fmt::format("one of {} parts as {}", parts.size(), paths[0].string()),
                   fmt::format("one of {}", part.count));
        if (parts[part.index])
            refuse(path, "every part once",
                   fmt::format("part {} of {} again, after {}", part.index + 1, part.count,
                               path_of[part.index].string()));
        parts[part.index] = std::move(stored);
        path_of[part.index] = path;
    }
    if (parts.empty())
        throw std::runtime_error("expected parts, got none");
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (!parts[i])
            throw std::runtime_error(fmt::format("expected all {0} parts, got none that is part "
                                                 "{1} of {0}",
                                                 parts.size(), i + 1));
    return parts;
}

} // namespace relumine::prt
