#include "relumine/options/option_table.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <memory>

#include <fmt/format.h>

#include "files/joined.h"
#include "files/nearest_name.h"

namespace relumine {

namespace {

/// `long double`, so that a float is rounded once from the decimal number, as good as always.
std::optional<long double> long_number(const std::string& text) {
    char* end = nullptr;
    const long double value = std::strtold(text.c_str(), &end);
    // strtold() also takes hexadecimal numbers.
    if (text.empty() || end != text.c_str() + text.size() ||
        text.find_first_of("xX") != std::string::npos)
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

std::optional<glm::dvec3> three_numbers(const std::string& text) {
    const auto numbers = parse_numbers(text);
    if (!numbers || numbers->size() != 3)
        return std::nullopt;
    return glm::dvec3((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

bool are_within(const glm::dvec3& values, double min, double max) {
    for (int i = 0; i < 3; ++i)
        if (!(values[i] >= min && values[i] <= max))
            return false;
    return true;
}

} // namespace

std::vector<std::string> OptionRow::names() const {
    return is_argument() ? std::vector<std::string>() : split(name, ',');
}

std::string OptionRow::long_name() const {
    return is_argument() ? name : names().back();
}

std::string OptionRow::key() const {
    std::string result = long_name();
    result.erase(0, std::min(result.find_first_not_of('-'), result.size()));
    for (char& c : result)
        c = c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

std::string OptionRow::range() const {
    return std::isfinite(max) ? fmt::format("{} to {}", min, max) : std::string();
}

void OptionRow::set(std::span<const std::string> given) const {
    std::vector<std::string> texts(given.begin(), given.end());
    try {
        for (std::string& text : texts) {
            if (text.empty() && !is_flag)
                text = bare ? *bare : throw std::invalid_argument("expected a value, got ''");
            if (!choices.empty() &&
                std::find(choices.begin(), choices.end(), text) == choices.end())
                throw std::invalid_argument(fmt::format("expected {}, got '{}'{}",
                                                        files::joined_by_or(choices), text,
                                                        files::did_you_mean(text, choices)));
        }
        read(texts);
        for (const std::string& text : texts)
            if (const auto number = parse_number(text);
                std::isfinite(max) && !(number && *number >= min && *number <= max))
                refuse_text(range(), text);
    } catch (const OptionError&) {
        throw;
    } catch (const std::invalid_argument& error) {
        throw OptionError(long_name(), error.what());
    }
}

OptionRow row(std::string name, std::function<void(const std::string&)> read, std::string help,
              OptionFacts facts) {
    OptionRow result{std::move(facts), std::move(name), std::move(help)};
    auto given = std::make_shared<std::string>();
    result.read = [read = std::move(read), given](std::span<const std::string> texts) {
        read(texts.back());
        *given = texts.back();
    };
    result.show = [given] {
        return *given;
    };
    return result;
}

std::string settings_of(const OptionTable& table) {
    std::string all;
    for (const OptionRow& each : table)
        if (each.shapes_frames)
            all += fmt::format("{}={}\n", each.long_name(), each.show());
    return all;
}

std::optional<double> parse_number(const std::string& text) {
    const std::optional<long double> number = long_number(text);
    return number ? std::optional(static_cast<double>(*number)) : std::nullopt;
}

std::optional<std::uint32_t> parse_count(std::string_view text) {
    return whole_number<std::uint32_t>(text);
}

std::optional<std::pair<std::uint32_t, std::uint32_t>> parse_sides(std::string_view text) {
    const std::size_t cross = text.find('x');
    if (cross == std::string_view::npos)
        return std::nullopt;
    const auto width = parse_count(text.substr(0, cross));
    const auto height = parse_count(text.substr(cross + 1));
    if (!width || !height)
        return std::nullopt;
    return std::pair(*width, *height);
}

std::vector<std::string> split(std::string_view text, char separator) {
    std::vector<std::string> words;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(separator, begin), text.size());
        words.emplace_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return words;
}

std::vector<std::pair<std::string, std::string>>
named_texts(const std::string& list, const std::string& form, const std::string& whole) {
    std::vector<std::pair<std::string, std::string>> result;
    for (const std::string& word : split(list, ',')) {
        const std::size_t equals = word.find('=');
        if (equals != std::string::npos)
            result.emplace_back(word.substr(0, equals), word.substr(equals + 1));
        else if (!result.empty())
            result.back().second += "," + word;
        else
            refuse_text(form, whole);
    }
    return result;
}

std::optional<std::vector<double>> parse_numbers(const std::string& text) {
    std::vector<double> numbers;
    for (const std::string& word : split(text, ',')) {
        const std::optional<double> number = parse_number(word);
        if (!number)
            return std::nullopt;
        numbers.push_back(*number);
    }
    return numbers;
}

void refuse_text(const std::string& expected, std::string_view text) {
    throw std::invalid_argument(fmt::format("expected {}, got '{}'", expected, text));
}

namespace option_text {

std::uint64_t whole(const std::string& text, std::uint64_t max) {
    const auto number = whole_number<std::uint64_t>(text);
    if (!number || *number > max)
        refuse_text(fmt::format("a whole number of 0 to {}", max), text);
    return *number;
}

long double real(const std::string& text, double max) {
    const std::optional<long double> number = long_number(text);
    if (!number)
        refuse_text("a number", text);
    if (!(std::abs(*number) <= static_cast<long double>(max)))
        refuse_text(fmt::format("a number within {}", max), text);
    return *number;
}

std::size_t word(std::span<const std::string_view> words, const std::string& text) {
    const auto found = std::find(words.begin(), words.end(), text);
    if (found == words.end())
        refuse_text(files::joined(words, ", "), text);
    return static_cast<std::size_t>(found - words.begin());
}

std::string shown(float number) {
    return fmt::format("{}", number);
}

std::string shown(double number) {
    return fmt::format("{}", number);
}

} // namespace option_text

bool ValueText<bool>::read(const std::string& text) {
    if (!text.empty() && text != "true" && text != "false")
        refuse_text("true or false", text);
    return text != "false";
}

glm::vec3 ColorText::read(const std::string& text) {
    const std::optional<glm::dvec3> color = three_numbers(
        text.find(',') == std::string::npos ? fmt::format("{0},{0},{0}", text) : text);
    if (!color)
        refuse_text("R,G,B or one number", text);
    constexpr float Largest = 1e6f; // what it multiplies stays a float
    if (!are_within(*color, 0.0, Largest))
        refuse_text(fmt::format("numbers of 0 to {}", Largest), text);
    return glm::vec3(*color);
}

std::string ColorText::show(const glm::vec3& color) {
    return color.r == color.g && color.g == color.b ? fmt::format("{}", color.r)
                                                    : PointText::show(color);
}

glm::dvec3 PointText::read(const std::string& text) {
    const std::optional<glm::dvec3> point = three_numbers(text);
    if (!point)
        refuse_text("X,Y,Z", text);
    if (!are_within(*point, -LargestPosition, LargestPosition))
        refuse_text(fmt::format("numbers within {}", LargestPosition), text);
    return *point;
}

std::string PointText::show(const glm::dvec3& point) {
    const auto text = [](double value) {
        const auto rounded = static_cast<float>(value);
        return double{rounded} == value ? fmt::format("{}", rounded) : fmt::format("{}", value);
    };
    return fmt::format("{},{},{}", text(point.x), text(point.y), text(point.z));
}

} // namespace relumine
