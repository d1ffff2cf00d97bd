// Lines and words of the text formats, with strict numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

namespace relumine::mesh {

[[nodiscard]] std::string_view as_text(std::span<const std::byte> bytes);

/// Text of unknown content for an error message: quoted, shortened, without control characters.
[[nodiscard]] std::string excerpt(std::string_view text);

/// Walks over a text line by line or word by word. Lines end with LF, CR or CR LF; words are
/// separated by white space. The text must outlive the reader and its words. A UTF-8 byte order
/// mark is skipped; text with NUL bytes (UTF-16) is refused by the constructor. All errors are
/// std::runtime_error "expected X in line N, got Y".
class TextReader {
public:
    /// `comment` and what follows it in a line is skipped; 0 for a format without comments.
    explicit TextReader(std::string_view text, char comment = '\0');

    /// Goes to the next line that has a word. False at the end of the text.
    bool next_line();
    /// The words of the current line.
    [[nodiscard]] const std::vector<std::string_view>& words() const { return words_; }

    /// Takes the next word, of this line or a later one. Throws at the end of the text.
    std::string_view next_word(std::string_view expected);
    /// True when there is no further word.
    [[nodiscard]] bool at_end();

    /// The whole word as a number: decimal, independent of the locale; nan and inf are numbers
    /// here. Numbers too large for a double become infinite, too small ones zero.
    [[nodiscard]] double number(std::string_view word) const;
    [[nodiscard]] std::int64_t integer(std::string_view word) const;
    /// Three numbers of the current line from words()[first] on, which must exist.
    [[nodiscard]] glm::vec3 vector(std::size_t first) const;

    [[noreturn]] void fail(std::string_view expected, std::string_view got) const;

private:
    std::string_view rest_;
    char comment_;
    std::size_t line_number_ = 0;
    std::vector<std::string_view> words_;
    std::size_t next_word_ = 0;
};

/// Colours of a text format in 0..1: bytes, that is whole numbers of which some are above 1, are
/// divided by 255.
void normalize_text_colors(std::vector<glm::vec3>& colors);

} // namespace relumine::mesh
