#include "mesh/text_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "files/printable.h"

namespace relumine::mesh {

namespace {

bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

/// Removes a leading plus sign, which files may have but from_chars does not accept.
std::string_view without_plus(std::string_view word) {
    return word.size() > 1 && word[0] == '+' && word[1] != '-' ? word.substr(1) : word;
}

} // namespace

std::string_view as_text(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string excerpt(std::string_view text) {
    constexpr std::size_t MaxLength = 40;
    return fmt::format("'{}{}'", files::printable(text.substr(0, MaxLength)),
                       text.size() > MaxLength ? "..." : "");
}

TextReader::TextReader(std::string_view text, char comment) : rest_(text), comment_(comment) {
    if (rest_.starts_with("\xEF\xBB\xBF"))
        rest_.remove_prefix(3);
    if (rest_.starts_with("\xFE\xFF") || rest_.starts_with("\xFF\xFE"))
        throw std::runtime_error("expected ASCII or UTF-8 text, got UTF-16");
    if (rest_.find('\0') != std::string_view::npos)
        throw std::runtime_error(
            "expected ASCII or UTF-8 text, got NUL bytes (UTF-16 or binary data)");
}

bool TextReader::next_line() {
    words_.clear();
    next_word_ = 0;
    while (words_.empty() && !rest_.empty()) {
        ++line_number_;
        const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
        std::string_view line = rest_.substr(0, end);
        rest_.remove_prefix(end);
        rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : std::min<std::size_t>(1, rest_.size()));
        if (comment_ != '\0')
            line = line.substr(0, line.find(comment_));
        for (std::size_t begin = 0; begin < line.size();) {
            if (is_space(line[begin])) {
                ++begin;
                continue;
            }
            std::size_t word_end = begin + 1;
            while (word_end < line.size() && !is_space(line[word_end]))
                ++word_end;
            words_.push_back(line.substr(begin, word_end - begin));
            begin = word_end;
        }
    }
    return !words_.empty();
}

bool TextReader::at_end() {
    return next_word_ == words_.size() && !next_line();
}

std::string_view TextReader::next_word(std::string_view expected) {
    if (at_end())
        fail(expected, "the end of the file");
    return words_[next_word_++];
}

double TextReader::number(std::string_view word) const {
    const std::string_view digits = without_plus(word);
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (end != digits.data() + digits.size() || error == std::errc::invalid_argument)
        fail("a number", excerpt(word));
    if (error == std::errc::result_out_of_range) {
        const bool is_small = digits.find("e-") != std::string_view::npos ||
                              digits.find("E-") != std::string_view::npos;
        return is_small ? 0.0 : std::numeric_limits<double>::infinity();
    }
    return value;
}

std::int64_t TextReader::integer(std::string_view word) const {
    const std::string_view digits = without_plus(word);
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (end != digits.data() + digits.size() || error != std::errc())
        fail("a whole number", excerpt(word));
    return value;
}

glm::dvec3 TextReader::exact_vector(std::size_t first) const {
    return {number(words_[first]), number(words_[first + 1]), number(words_[first + 2])};
}

glm::vec3 TextReader::vector(std::size_t first) const {
    return glm::vec3(exact_vector(first));
}

void TextReader::fail(std::string_view expected, std::string_view got) const {
    throw std::runtime_error(
        fmt::format("expected {} in line {}, got {}", expected, line_number_, got));
}

} // namespace relumine::mesh
