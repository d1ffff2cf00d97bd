#include "tests/bench/program.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tests/real_data.h"

namespace relumine::bench {

namespace {

template<typename Number>
bool read_number(const std::string& text, Number& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

std::vector<std::string> words_of(const std::string& text) {
    std::vector<std::string> words;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        words.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return words;
}

} // namespace

Absent::Absent(const std::filesystem::path& name) : std::runtime_error(absent_data(name)) {}

Program::Program(std::string name, std::string description)
    : name_(std::move(name)), description_(std::move(description)) {
    add_flag("--tiny", tiny_, "small input, few repetitions: seconds, without real data");
    add_flag("--help", help_, "print this");
}

void Program::add(const std::string& option, std::string& value, const std::string& help) {
    options_.push_back({.name = option,
                        .help = help,
                        .default_value = value,
                        .read = [&value](const std::string& text) {
                            value = text;
                            return true;
                        }});
}

void Program::add(const std::string& option, std::filesystem::path& value,
                  const std::string& help) {
    options_.push_back({.name = option,
                        .help = help,
                        .default_value = value.string(),
                        .read = [&value](const std::string& text) {
                            value = text;
                            return true;
                        }});
}

template<typename Number>
void Program::add_number(const std::string& option, Number& value, const std::string& help) {
    options_.push_back({.name = option,
                        .help = help,
                        .default_value = fmt::format("{}", value),
                        .read = [&value](const std::string& text) {
                            return read_number(text, value);
                        }});
}

void Program::add(const std::string& option, std::uint32_t& value, const std::string& help) {
    add_number(option, value, help);
}
void Program::add(const std::string& option, std::size_t& value, const std::string& help) {
    add_number(option, value, help);
}
void Program::add(const std::string& option, int& value, const std::string& help) {
    add_number(option, value, help);
}
void Program::add(const std::string& option, float& value, const std::string& help) {
    add_number(option, value, help);
}
void Program::add(const std::string& option, double& value, const std::string& help) {
    add_number(option, value, help);
}

void Program::add(const std::string& option, std::vector<float>& values, const std::string& help) {
    options_.push_back({.name = option,
                        .help = help,
                        .default_value = fmt::format("{}", fmt::join(values, ",")),
                        .read = [&values](const std::string& text) {
                            values.clear();
                            for (const std::string& word : words_of(text))
                                if (!read_number(word, values.emplace_back()))
                                    return false;
                            return true;
                        }});
}

void Program::add(const std::string& option, std::vector<std::string>& values,
                  const std::string& help) {
    options_.push_back({.name = option,
                        .help = help,
                        .default_value = fmt::format("{}", fmt::join(values, ",")),
                        .read = [&values, known = values](const std::string& text) {
                            values = words_of(text);
                            return known.empty() ||
                                   std::all_of(values.begin(), values.end(), [&](const auto& word) {
                                       return std::find(known.begin(), known.end(), word) !=
                                              known.end();
                                   });
                        }});
}

void Program::add_flag(const std::string& option, bool& value, const std::string& help) {
    options_.push_back(
        {.name = option, .help = help, .is_flag = true, .read = [&value](const std::string&) {
             return value = true;
         }});
}

void Program::print_help() const {
    fmt::print("{}: {}\n\n", name_, description_);
    for (const Option& option : options_)
        fmt::print("  {:<20} {}{}\n", option.name, option.help,
                   option.default_value.empty() ? "" : fmt::format(" [{}]", option.default_value));
}

void Program::parse(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const auto option = std::find_if(options_.begin(), options_.end(),
                                         [&](const Option& each) { return each.name == word; });
        if (option == options_.end())
            throw std::invalid_argument(fmt::format("unknown option {}; see --help", word));
        if (option->is_flag) {
            option->read("");
            continue;
        }
        if (++i == argc)
            throw std::invalid_argument(fmt::format("{}: expected a value", word));
        if (!option->read(argv[i]))
            throw std::invalid_argument(fmt::format("{}: expected a value like {}, got '{}'", word,
                                                    option->default_value, argv[i]));
    }
}

int Program::run(int argc, char** argv, const std::function<void()>& work) {
    try {
        parse(argc, argv);
    } catch (const std::invalid_argument& error) {
        fmt::print(stderr, "{}: {}\n", name_, error.what());
        return 2;
    }
    if (help_) {
        print_help();
        return 0;
    }
    try {
        work();
    } catch (const Absent& absent) {
        fmt::print("{}: skipped, {}\n", name_, absent.what());
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}: {}\n", name_, error.what());
        return 1;
    }
    return 0;
}

} // namespace relumine::bench
