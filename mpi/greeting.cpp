#include "mpi/greeting.h"

#include <algorithm>

#include <fmt/format.h>

#include "files/joined.h"
#include "relumine/in/shared_work.h"
#include "relumine/version.h"

namespace relumine::mpi {

Greeting greeting(const std::vector<std::string>& arguments) {
    return {.version = std::string(version()),
            .instruction_set = prt::arithmetic(),
            .arguments = arguments};
}

std::vector<std::byte> packed(const Greeting& greeting) {
    std::string text = greeting.version + '\0' + greeting.instruction_set + '\0';
    for (const std::string& argument : greeting.arguments)
        text += argument + '\0';
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

Greeting unpacked(std::span<const std::byte> bytes) {
    std::vector<std::string> words(1);
    for (const std::byte byte : bytes) {
        if (byte == std::byte{0})
            words.emplace_back();
        else
            words.back() += static_cast<char>(byte);
    }
    words.resize(std::max<std::size_t>(words.size(), 3));
    return {.version = words[0],
            .instruction_set = words[1],
            .arguments = {words.begin() + 2, words.end() - 1}};
}

std::string difference(const Greeting& first, const Greeting& own) {
    const auto differ = [](const std::string& what, const std::string& expected,
                           const std::string& got) {
        return fmt::format("expected the {} '{}' of the first process, got '{}'", what, expected,
                           got);
    };
    if (own.version != first.version)
        return differ("version", first.version, own.version);
    if (own.instruction_set != first.instruction_set)
        return differ("instruction set", first.instruction_set, own.instruction_set);
    if (own.arguments != first.arguments)
        return differ("arguments", files::joined(first.arguments, " "),
                      files::joined(own.arguments, " "));
    return "";
}

} // namespace relumine::mpi
