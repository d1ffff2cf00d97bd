// Reads STL, ASCII and binary. STL has corners but no vertices: corners at exactly the same place
// become one vertex, numbered in the order of the file. Normals of facets are skipped, because the
// order of the corners gives them.
//
// The project has its own reader: OpenMesh drops degenerate facets and reads truncated files as
// shorter ones, and Assimp makes a vertex of every corner. For CGAL see off_reader.cpp.
#include <bit>
#include <cctype>
#include <cstring>
#include <unordered_map>

#include <fmt/format.h>

#include "mesh/formats/polygon_soup.h"
#include "mesh/text_reader.h"

namespace relumine::mesh {

namespace {

constexpr std::size_t HeaderBytes = 84; // 80 bytes of text and the number of facets
constexpr std::size_t FacetBytes = 50;  // a normal, three corners and two bytes of attributes

struct PositionHash {
    std::size_t operator()(const glm::dvec3& p) const {
        std::uint64_t hash = 0;
        for (int i = 0; i < 3; ++i)
            hash = std::rotl((hash ^ std::bit_cast<std::uint64_t>(p[i])) * 0x9e3779b97f4a7c15u, 29);
        return hash;
    }
};

/// Turns facets into vertices and triangles.
class Welder {
public:
    void add_corner(const glm::dvec3& point) {
        const glm::dvec3 key = point + 0.0; // -0 equals 0 but hashes differently
        const auto [entry, is_new] =
            vertex_at_.try_emplace(key, static_cast<std::uint32_t>(soup_.positions.size()));
        if (is_new)
            soup_.add_position(key);
        soup_.corners.push_back(entry->second);
    }
    void end_facet() { soup_.end_face(); }
    PolygonSoup result() { return std::move(soup_); }

private:
    PolygonSoup soup_;
    std::unordered_map<glm::dvec3, std::uint32_t, PositionHash> vertex_at_;
};

std::uint32_t little_endian(const std::byte* bytes) {
    std::uint32_t value = 0;
    for (std::uint32_t i = 0; i < 4; ++i)
        value |= std::to_integer<std::uint32_t>(bytes[i]) << (8 * i);
    return value;
}

PolygonSoup read_binary(std::span<const std::byte> bytes) {
    Welder welder;
    for (std::size_t facet = HeaderBytes; facet < bytes.size(); facet += FacetBytes) {
        for (std::size_t corner = facet + 12; corner < facet + 48; corner += 12) {
            glm::vec3 point;
            for (int i = 0; i < 3; ++i)
                point[i] = std::bit_cast<float>(
                    little_endian(&bytes[corner + 4 * static_cast<std::size_t>(i)]));
            welder.add_corner(point);
        }
        welder.end_facet();
    }
    return welder.result();
}

bool same_keyword(std::string_view word, std::string_view keyword) {
    return word.size() == keyword.size() &&
           std::equal(word.begin(), word.end(), keyword.begin(), [](char a, char b) {
               return std::tolower(static_cast<unsigned char>(a)) == b;
           });
}

class AsciiReader {
public:
    explicit AsciiReader(std::string_view text) : reader_(text) {}
    PolygonSoup read();

private:
    void expect(std::string_view keyword);
    glm::dvec3 read_vector();
    void read_facet();

    TextReader reader_;
    Welder welder_;
};

void AsciiReader::expect(std::string_view keyword) {
    const std::string_view word = reader_.next_word(fmt::format("'{}'", keyword));
    if (!same_keyword(word, keyword))
        reader_.fail(fmt::format("'{}'", keyword), excerpt(word));
}

glm::dvec3 AsciiReader::read_vector() {
    glm::dvec3 vector;
    for (int i = 0; i < 3; ++i)
        vector[i] = reader_.number(reader_.next_word("a number"));
    return vector;
}

/// Reads the rest of a facet, behind the word "facet".
void AsciiReader::read_facet() {
    expect("normal");
    static_cast<void>(read_vector());
    expect("outer");
    expect("loop");
    for (int i = 0; i < 3; ++i) {
        expect("vertex");
        welder_.add_corner(read_vector());
    }
    expect("endloop");
    expect("endfacet");
    welder_.end_facet();
}

PolygonSoup AsciiReader::read() {
    // A solid's name takes the rest of its line and may hold any word.
    while (reader_.next_line()) {
        if (!same_keyword(reader_.words()[0], "solid"))
            reader_.fail("'solid'", excerpt(reader_.words()[0]));
        if (!reader_.next_line())
            reader_.fail("'facet' or 'endsolid'", "the end of the file");
        std::string_view word = reader_.next_word("'facet' or 'endsolid'");
        while (same_keyword(word, "facet")) {
            read_facet();
            word = reader_.next_word("'facet' or 'endsolid'");
        }
        if (!same_keyword(word, "endsolid"))
            reader_.fail("'facet' or 'endsolid'", excerpt(word));
    }
    return welder_.result();
}

} // namespace

PolygonSoup read_stl(std::span<const std::byte> bytes) {
    // Binary files may begin with "solid" too. Their size tells them apart.
    const std::uint64_t num_facets =
        bytes.size() < HeaderBytes ? 0 : little_endian(&bytes[HeaderBytes - 4]);
    if (bytes.size() >= HeaderBytes && bytes.size() == HeaderBytes + num_facets * FacetBytes)
        return read_binary(bytes);
    const std::string_view text = as_text(bytes);
    const std::size_t start = std::min(text.find_first_not_of(" \t\r\n\xEF\xBB\xBF"), text.size());
    if (same_keyword(text.substr(start, 5), "solid"))
        return AsciiReader(text).read();
    if (bytes.size() < HeaderBytes)
        throw std::runtime_error(fmt::format(
            "expected STL, got {} bytes without 'solid' or a binary header", bytes.size()));
    throw std::runtime_error(fmt::format("expected {} bytes of binary STL with {} facets, got {}",
                                         HeaderBytes + num_facets * FacetBytes, num_facets,
                                         bytes.size()));
}

} // namespace relumine::mesh
