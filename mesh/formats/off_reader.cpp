// Reads the Object File Format (Geomview): [ST][C][N]OFF, ASCII, with one vertex or one face per
// line, or binary. Comments may stand anywhere in ASCII. Faces may end in a colour of three or four
// values, whole ones of 0 to 255 or fractions, or in the index of a colour map, which is skipped.
// Colours of vertices have three or four values, in binary files four.
//
// The project has its own reader for these reasons:
// - OpenMesh refuses comments, misreads polygons followed by colours and counts on the keyword's
//   line, and crashes on a header that declares too much.
// - Assimp misreads comments between faces and accepts indices out of range.
// - CGAL is right about nearly all of this, but accepts surplus values and lines, and would bring
//   Boost and GMP for little more than the hundred lines below, which share their text reader with
//   the other formats.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "mesh/formats/polygon_soup.h"
#include "mesh/formats/soup_colors.h"
#include "mesh/text_reader.h"

namespace relumine::mesh {

namespace {

/// The data of each vertex besides its position, as the keyword states them, in the order of the
/// file.
struct Layout {
    bool has_normal = false;
    bool has_color = false;
    bool has_uv = false;
};

struct Counts {
    std::size_t vertices, faces;
};

/// Removes `prefix` from the front of `text`. Returns false if it is not there.
bool take(std::string_view& text, std::string_view prefix) {
    const bool found = text.starts_with(prefix);
    if (found)
        text.remove_prefix(prefix.size());
    return found;
}

/// Takes the keyword's letters off the front of a word. What remains is empty or follows without a
/// space. Returns nothing for a word that is no keyword.
std::optional<Layout> take_keyword(std::string_view& word) {
    std::string_view rest = word;
    Layout layout;
    layout.has_uv = take(rest, "ST");
    layout.has_color = take(rest, "C");
    layout.has_normal = take(rest, "N");
    if (!take(rest, "OFF"))
        return std::nullopt;
    word = rest;
    return layout;
}

/// Colours of faces while they are read: fractions, and whole numbers, which may be bytes.
class FaceColors {
public:
    void add_fraction(const glm::vec3& color) { add(color, false); }
    void add_whole(const glm::vec3& color) { add(color, true); }
    void add_index() {
        ++num_indices_;
        add(no_color(), false);
    }
    void add_none() { add(no_color(), false); }
    /// Gives them to a soup.
    void move_to(PolygonSoup& soup);

private:
    void add(const glm::vec3& color, bool is_whole) {
        colors_.push_back(color);
        is_whole_.push_back(is_whole);
    }

    std::vector<glm::vec3> colors_;
    std::vector<bool> is_whole_;
    std::size_t num_indices_ = 0;
};

void FaceColors::move_to(PolygonSoup& soup) {
    std::vector<glm::vec3> whole;
    for (std::size_t i = 0; i < colors_.size(); ++i)
        if (is_whole_[i])
            whole.push_back(colors_[i]);
    scale_to_one(whole);
    auto next = whole.begin();
    for (std::size_t i = 0; i < colors_.size(); ++i)
        if (is_whole_[i])
            colors_[i] = *next++;
    if (num_indices_ != 0)
        soup.warnings.push_back(
            fmt::format("{} of {} faces have an index of a colour map, which is not read",
                        num_indices_, colors_.size()));
    const auto is_a_color = [](const glm::vec3& color) {
        return !std::isnan(color.r);
    };
    if (std::any_of(colors_.begin(), colors_.end(), is_a_color))
        soup.face_colors = std::move(colors_);
    // MeshLab writes bytes of a screen.
    soup.color_custom = {.curve = ColorCurve::Srgb,
                         .may_be_whole = true,
                         .reason = "as other programs write them into .off"};
}

class OffReader {
public:
    explicit OffReader(std::string_view text) : reader_(text, '#'), num_bytes_(text.size()) {}
    PolygonSoup read();

private:
    std::vector<std::string_view> read_keyword();
    Counts read_counts();
    void read_vertex();
    void read_face(std::size_t num_vertices);
    void read_face_color(std::span<const std::string_view> words);

    TextReader reader_;
    std::size_t num_bytes_;
    Layout layout_;
    PolygonSoup soup_;
    FaceColors face_colors_;
};

/// Reads the optional keyword into the layout. Returns the words behind it on its line.
std::vector<std::string_view> OffReader::read_keyword() {
    if (!reader_.next_line())
        reader_.fail("an OFF header", "the end of the file");
    std::vector<std::string_view> words = reader_.words();
    std::string_view keyword = words[0];
    if (const auto layout = take_keyword(keyword))
        layout_ = *layout;
    else if (keyword.find_first_not_of("0123456789") != std::string_view::npos)
        reader_.fail("OFF with an optional ST, C, N in front, in three dimensions",
                     excerpt(keyword));
    // Some files lack the space between the keyword and the counts (ModelNet's).
    words[0] = keyword;
    if (keyword.empty())
        words.erase(words.begin());
    return words;
}

Counts OffReader::read_counts() {
    std::vector<std::string_view> words = read_keyword();
    if (words.empty() && reader_.next_line())
        words = reader_.words();
    if (words.size() != 3)
        reader_.fail("the numbers of vertices, faces and edges",
                     fmt::format("{} values", words.size()));
    // A vertex takes at least six bytes ("0 0 0" and the line's end), a face at least two.
    const std::int64_t vertices = reader_.integer(words[0]), faces = reader_.integer(words[1]);
    static_cast<void>(reader_.integer(words[2]));
    const auto limit = static_cast<std::int64_t>(num_bytes_);
    if (vertices < 0 || faces < 0 || vertices > limit / 6 || faces > limit / 2)
        reader_.fail(
            fmt::format("numbers of vertices and faces that fit into {} bytes", num_bytes_),
            fmt::format("{} and {}", vertices, faces));
    return {static_cast<std::size_t>(vertices), static_cast<std::size_t>(faces)};
}

void OffReader::read_vertex() {
    const std::size_t num_colors = layout_.has_color ? 3 : 0;
    const std::size_t num_values =
        3u + (layout_.has_normal ? 3u : 0u) + num_colors + (layout_.has_uv ? 2u : 0u);
    const std::size_t num_words = reader_.next_line() ? reader_.words().size() : 0;
    const bool has_alpha = layout_.has_color && num_words == num_values + 1;
    if (num_words != num_values && !has_alpha)
        reader_.fail(fmt::format("{} numbers of a vertex", num_values),
                     fmt::format("{}", num_words));
    std::size_t next = 3;
    soup_.add_position(reader_.exact_vector(0));
    if (layout_.has_normal) {
        soup_.normals.push_back(reader_.vector(next));
        next += 3;
    }
    if (layout_.has_color) {
        soup_.colors.push_back(reader_.vector(next));
        next += has_alpha ? 4 : 3;
    }
    if (layout_.has_uv)
        soup_.uvs.emplace_back(reader_.number(reader_.words()[next]),
                               reader_.number(reader_.words()[next + 1]));
}

void OffReader::read_face(std::size_t num_vertices) {
    if (!reader_.next_line())
        reader_.fail("a face", "the end of the file");
    const std::vector<std::string_view>& words = reader_.words();
    const std::int64_t num_corners = reader_.integer(words[0]);
    const auto num_others = static_cast<std::int64_t>(words.size()) - 1;
    if (num_corners < 0 || num_corners > num_others || num_others - num_corners > 4)
        reader_.fail(fmt::format("{} corners and at most 4 colour values", num_corners),
                     fmt::format("{} values", num_others));
    for (std::size_t i = 1; i <= static_cast<std::size_t>(num_corners); ++i) {
        const std::int64_t index = reader_.integer(words[i]);
        if (index < 0 || static_cast<std::size_t>(index) >= num_vertices)
            reader_.fail(fmt::format("a vertex index of 0 to {}",
                                     static_cast<std::int64_t>(num_vertices) - 1),
                         excerpt(words[i]));
        soup_.corners.push_back(static_cast<std::uint32_t>(index));
    }
    read_face_color(std::span(words).subspan(static_cast<std::size_t>(num_corners) + 1));
    soup_.end_face();
}

void OffReader::read_face_color(std::span<const std::string_view> words) {
    std::array<float, 4> values{};
    bool is_whole = true;
    for (std::size_t i = 0; i < words.size(); ++i) {
        values[i] = static_cast<float>(reader_.number(words[i]));
        is_whole = is_whole && words[i].find_first_of(".eEnN") == std::string_view::npos;
    }
    const glm::vec3 color(values[0], values[1], values[2]);
    if (words.size() == 1)
        face_colors_.add_index();
    else if (words.size() < 3)
        face_colors_.add_none();
    else if (is_whole)
        face_colors_.add_whole(color);
    else
        face_colors_.add_fraction(color);
}

PolygonSoup OffReader::read() {
    const Counts counts = read_counts();
    soup_.positions.reserve(counts.vertices);
    for (std::size_t i = 0; i < counts.vertices; ++i)
        read_vertex();
    for (std::size_t i = 0; i < counts.faces; ++i)
        read_face(counts.vertices);
    if (reader_.next_line())
        reader_.fail(
            fmt::format("nothing after {} vertices and {} faces", counts.vertices, counts.faces),
            excerpt(reader_.words()[0]));
    face_colors_.move_to(soup_);
    return std::move(soup_);
}

/// Reads the data of a binary file: words of 32 bits, high byte first.
class BinaryOff {
public:
    explicit BinaryOff(std::span<const std::byte> data) : rest_(data) {}
    PolygonSoup read(const Layout& layout);

private:
    [[nodiscard]] std::uint32_t word();
    /// Returns a whole number below `limit`.
    [[nodiscard]] std::uint32_t number(const char* what, std::uint64_t limit);
    [[nodiscard]] float real() { return std::bit_cast<float>(word()); }
    [[nodiscard]] glm::vec3 vector();

    std::span<const std::byte> rest_;
};

std::uint32_t BinaryOff::word() {
    if (rest_.size() < 4)
        throw std::runtime_error(
            "expected all vertices and faces of a binary OFF file, got the end "
            "of the file");
    std::uint32_t result = 0;
    for (const std::byte byte : rest_.first(4))
        result = result << 8 | std::to_integer<std::uint32_t>(byte);
    rest_ = rest_.subspan(4);
    return result;
}

std::uint32_t BinaryOff::number(const char* what, std::uint64_t limit) {
    const std::uint32_t result = word();
    if (result >= limit)
        throw std::runtime_error(fmt::format("expected {} below {}, got {}", what, limit, result));
    return result;
}

glm::vec3 BinaryOff::vector() {
    const float x = real(), y = real(), z = real();
    return {x, y, z};
}

PolygonSoup BinaryOff::read(const Layout& layout) {
    // A vertex takes at least three words, a face at least two.
    const std::uint64_t num_words = rest_.size() / 4;
    const std::uint32_t num_vertices = number("a number of vertices", num_words / 3 + 1);
    const std::uint32_t num_faces = number("a number of faces", num_words / 2 + 1);
    static_cast<void>(word()); // edges
    PolygonSoup soup;
    FaceColors face_colors;
    soup.positions.reserve(num_vertices);
    for (std::uint32_t i = 0; i < num_vertices; ++i) {
        soup.positions.push_back(vector());
        if (layout.has_normal)
            soup.normals.push_back(vector());
        if (layout.has_color) {
            soup.colors.push_back(vector());
            static_cast<void>(real()); // alpha
        }
        if (layout.has_uv) {
            const float u = real(), v = real();
            soup.uvs.emplace_back(u, v);
        }
    }
    for (std::uint32_t i = 0; i < num_faces; ++i) {
        const std::uint32_t num_corners = number("a number of corners", num_words);
        for (std::uint32_t corner = 0; corner < num_corners; ++corner)
            soup.corners.push_back(number("vertex indices", num_vertices));
        const std::uint32_t num_colors = number("a number of colour values", 5);
        std::array<float, 4> color{};
        for (std::uint32_t j = 0; j < num_colors; ++j)
            color[j] = real();
        if (num_colors == 1)
            face_colors.add_index();
        else if (num_colors < 3)
            face_colors.add_none();
        else
            face_colors.add_fraction({color[0], color[1], color[2]});
        soup.end_face();
    }
    face_colors.move_to(soup);
    if (!rest_.empty())
        throw std::runtime_error(fmt::format("expected nothing after {} vertices and {} faces, got "
                                             "{} bytes",
                                             num_vertices, num_faces, rest_.size()));
    return soup;
}

} // namespace

PolygonSoup read_off(std::span<const std::byte> bytes) {
    // A binary file says so on its first line.
    const std::string_view text = as_text(bytes);
    const std::size_t end = std::min(text.find('\n'), text.size());
    TextReader reader(text.substr(0, std::min(end, text.find('\0'))));
    if (reader.next_line() && reader.words().size() == 2 && reader.words()[1] == "BINARY") {
        std::string_view keyword = reader.words()[0];
        if (const auto layout = take_keyword(keyword); layout && keyword.empty())
            return BinaryOff(bytes.subspan(std::min(end + 1, bytes.size()))).read(*layout);
    }
    return OffReader(text).read();
}

} // namespace relumine::mesh
