// Lines and words of the text formats, with strict numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

namespace relumine::mesh {

/// Returns the bytes as text, without a copy.
[[nodiscard]] std::string_view as_text(std::span<const std::byte> bytes);

/// Returns text of unknown content for an error message: quoted, shortened, without control
/// characters.
[[nodiscard]] std::string excerpt(std::string_view text);

/// Walks over a text line by line or word by word. Lines end with LF, CR or CR LF. White space
/// separates words. The text must outlive the reader and its words. A UTF-8 byte order mark is
/// skipped; the constructor refuses text with NUL bytes (UTF-16).
///
/// Throws:  std::runtime_error "expected X in line N, got Y", from every function.
class TextReader {
public:
    /// `comment` begins a comment that lasts to the end of its line. 0: the format has no comments.
    explicit TextReader(std::string_view text, char comment = '\0');

    /// Goes to the next line that has a word. Returns false at the end of the text.
    bool next_line();
    /// Returns the words of the current line.
    [[nodiscard]] const std::vector<std::string_view>& words() const { return words_; }

    /// Takes the next word, of this line or a later one. The end of the text is an error.
    std::string_view next_word(std::string_view expected);
    /// Returns true if there is no further word.
    [[nodiscard]] bool at_end();

    /// Returns the whole word as a number: decimal, independent of the locale; nan and inf are
    /// allowed. Numbers too large for a double become infinite, too small ones zero.
    [[nodiscard]] double number(std::string_view word) const;
    /// Returns the whole word as a whole number.
    [[nodiscard]] std::int64_t integer(std::string_view word) const;
    /// Returns three numbers of the current line, from words()[first] on. The words must exist.
    [[nodiscard]] glm::vec3 vector(std::size_t first) const;
    [[nodiscard]] glm::dvec3 exact_vector(std::size_t first) const;

    [[noreturn]] void fail(std::string_view expected, std::string_view got) const;

private:
    std::string_view rest_;
    char comment_;
    std::size_t line_number_ = 0;
    std::vector<std::string_view> words_;
    std::size_t next_word_ = 0;
};

} // namespace relumine::mesh
