// Reads the Polygon File Format (Greg Turk's PLY 1.0): ASCII and binary of both byte orders, with
// any number type for any property and elements in any order. Faces are polygons or strips of
// triangles ("tristrips", as trimesh2 writes them). Further elements, properties and lists are
// skipped.
//
// The project has its own reader, because no library in Debian reads all valid files and refuses
// all others:
// - OpenMesh misreads or refuses lists beside the index list (on vertices, faces or other elements)
//   and 32-bit lengths of lists.
// - Assimp loses track in elements that hold lists, and reads truncated files as whole ones.
// - CGAL refuses 16-bit indices.
// - None of them notices data that the header does not declare.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "mesh/formats/ply_header.h"
#include "mesh/formats/polygon_soup.h"
#include "mesh/text_reader.h"

namespace relumine::mesh {

namespace {

using ply_format::Element;
using ply_format::Header;
using ply_format::Property;
using ply_format::Type;

/// Reads numbers of an ASCII body.
class AsciiValues {
public:
    static constexpr bool IsBinary = false;
    explicit AsciiValues(std::string_view body) : reader_(body), num_bytes_(body.size()) {}
    double next(Type /*type*/) { return reader_.number(reader_.next_word("a number")); }
    [[nodiscard]] std::size_t num_bytes() const { return num_bytes_; }
    void expect_end() {
        if (!reader_.at_end())
            reader_.fail("the end of the data", excerpt(reader_.words()[0]));
    }

private:
    TextReader reader_;
    std::size_t num_bytes_;
};

/// Reads numbers of a binary body in the byte order `Order`.
template<std::endian Order>
class BinaryValues {
public:
    static constexpr bool IsBinary = true;
    explicit BinaryValues(std::string_view body) : rest_(body) {}
    double next(Type type) {
        switch (type) {
        case Type::Int8:
            return take<std::int8_t>();
        case Type::Uint8:
            return take<std::uint8_t>();
        case Type::Int16:
            return take<std::int16_t>();
        case Type::Uint16:
            return take<std::uint16_t>();
        case Type::Int32:
            return take<std::int32_t>();
        case Type::Uint32:
            return take<std::uint32_t>();
        case Type::Float32:
            return take<float>();
        case Type::Float64:
            return take<double>();
        }
        return 0.0;
    }
    [[nodiscard]] std::size_t num_bytes() const { return rest_.size(); }
    void expect_end() const {
        if (rest_.find_first_not_of(" \t\r\n") != std::string_view::npos)
            throw std::runtime_error(
                fmt::format("expected the end of the data, got {} bytes more", rest_.size()));
    }

private:
    template<class Value>
    Value take() {
        std::array<char, sizeof(Value)> bytes;
        if (rest_.size() < bytes.size())
            throw std::runtime_error(
                "expected all elements that the header declares, got the end of the file");
        std::copy_n(rest_.begin(), bytes.size(), bytes.begin());
        rest_.remove_prefix(bytes.size());
        if constexpr (Order != std::endian::native)
            std::reverse(bytes.begin(), bytes.end());
        return std::bit_cast<Value>(bytes);
    }

    std::string_view rest_;
};

/// Refuses a header that declares more than the body can hold, before memory is allocated.
void check_sizes(const Header& header, std::size_t num_bytes, bool is_binary) {
    for (const Element& element : header.elements) {
        // Least size of one element in bytes. An empty list has only its length; an ASCII number is
        // a digit and a space.
        std::size_t least = 0;
        for (const Property& property : element.properties)
            least +=
                is_binary ? ply_format::size_of(property.size_type.value_or(property.type)) : 2;
        if (least > 0 && element.count > (num_bytes + 1) / least)
            throw std::runtime_error(fmt::format(
                "expected {} elements '{}' of {} bytes or more each, got {} bytes in all",
                element.count, element.name, least, num_bytes));
    }
}

/// Reads the length of a list.
template<class Values>
std::uint32_t list_size(const Property& property, Values& values) {
    const double size = values.next(*property.size_type);
    if (!(size >= 0.0 && size <= double{std::numeric_limits<std::uint32_t>::max()}) ||
        size != std::floor(size))
        throw std::runtime_error(
            fmt::format("expected the length of the list '{}', got {}", property.name, size));
    return static_cast<std::uint32_t>(size);
}

template<class Values>
void skip(const Property& property, Values& values) {
    const std::uint32_t count = property.size_type ? list_size(property, values) : 1;
    for (std::uint32_t i = 0; i < count; ++i)
        static_cast<void>(values.next(property.type));
}

template<class Values>
void skip(const Element& element, Values& values) {
    for (std::uint64_t i = 0; !element.properties.empty() && i < element.count; ++i)
        for (const Property& property : element.properties)
            skip(property, values);
}

/// The numbers of a vertex that are used, and their names in files.
enum Slot : std::size_t { X, Y, Z, NormalX, NormalY, NormalZ, Red, Green, Blue, U, V, NumSlots };
constexpr std::array<std::array<std::string_view, 4>, NumSlots> SlotNames = {
    {{"x"},
     {"y"},
     {"z"},
     {"nx"},
     {"ny"},
     {"nz"},
     {"red", "r", "diffuse_red"},
     {"green", "g", "diffuse_green"},
     {"blue", "b", "diffuse_blue"},
     {"s", "u", "texture_u", "texture_s"},
     {"t", "v", "texture_v", "texture_t"}}};

std::size_t slot_of(const Property& property) {
    for (std::size_t slot = 0; slot < NumSlots && !property.size_type; ++slot)
        for (const std::string_view name : SlotNames[slot])
            if (!name.empty() && property.name == name)
                return slot;
    return NumSlots;
}

/// Bytes and shorts are fractions of their largest value. Other types are the colour itself.
double color_scale(Type type) {
    return type == Type::Uint8 ? 1.0 / 255.0 : type == Type::Uint16 ? 1.0 / 65535.0 : 1.0;
}

template<class Values>
void read_vertices(const Element& element, Values& values, PolygonSoup& soup) {
    std::vector<std::size_t> slots; // slot of each property; NumSlots: skipped
    std::array<bool, NumSlots + 1> has{};
    std::array<double, NumSlots + 1> scale;
    scale.fill(1.0);
    for (const Property& property : element.properties) {
        // If the same number has several names ("u" beside "s"), the first one counts.
        const std::size_t slot = slot_of(property);
        slots.push_back(has[slot] ? NumSlots : slot);
        has[slot] = slot != NumSlots;
        if (slots.back() >= Red && slots.back() <= Blue)
            scale[slot] = color_scale(property.type);
    }
    if (!has[X] || !has[Y] || !has[Z])
        throw std::runtime_error("expected vertices with the properties x, y and z, got others");
    const bool has_normals = has[NormalX] && has[NormalY] && has[NormalZ];
    const bool has_colors = has[Red] && has[Green] && has[Blue];
    const bool has_uvs = has[U] && has[V];

    soup.positions.reserve(element.count);
    std::array<double, NumSlots> row{};
    const auto value = [&row](std::size_t slot) {
        return static_cast<float>(row[slot]);
    };
    for (std::uint64_t i = 0; i < element.count; ++i) {
        for (std::size_t p = 0; p < slots.size(); ++p) {
            if (slots[p] == NumSlots)
                skip(element.properties[p], values);
            else
                row[slots[p]] = values.next(element.properties[p].type) * scale[slots[p]];
        }
        soup.positions.emplace_back(value(X), value(Y), value(Z));
        if (has_normals)
            soup.normals.emplace_back(value(NormalX), value(NormalY), value(NormalZ));
        if (has_colors)
            soup.colors.emplace_back(value(Red), value(Green), value(Blue));
        if (has_uvs)
            soup.uvs.emplace_back(value(U), value(V));
    }
}

/// Returns the property with the corners of faces or strips.
std::vector<Property>::const_iterator index_list(const Element& element) {
    const auto is_index_list = [](const Property& property) {
        return (property.name == "vertex_indices" || property.name == "vertex_index") &&
               property.size_type && !ply_format::is_float(property.type);
    };
    const auto found =
        std::find_if(element.properties.begin(), element.properties.end(), is_index_list);
    if (found == element.properties.end())
        throw std::runtime_error(
            fmt::format("expected {} with a list of whole numbers 'vertex_indices', got none",
                        element.name == "face" ? "faces" : "tristrips"));
    return found;
}

/// Reads the elements' lists of vertex indices. Calls `add` with each index and `end` after each
/// list. -1 is an index, too, where `least` is -1.
template<class Values, class Add, class End>
void read_index_lists(const Element& element, std::uint64_t num_vertices, int least, Values& values,
                      const Add& add, const End& end) {
    const auto indices = index_list(element);
    for (std::uint64_t i = 0; i < element.count; ++i) {
        for (auto property = element.properties.begin(); property != element.properties.end();
             ++property) {
            if (property != indices) {
                skip(*property, values);
                continue;
            }
            const std::uint32_t count = list_size(*property, values);
            for (std::uint32_t place = 0; place < count; ++place) {
                const double index = values.next(property->type);
                if (!(index >= least && index < static_cast<double>(num_vertices)) ||
                    index != std::floor(index))
                    throw std::runtime_error(
                        fmt::format("expected vertex indices of {} to {}, got {}", least,
                                    static_cast<std::int64_t>(num_vertices) - 1, index));
                add(static_cast<std::int64_t>(index));
            }
        }
        end();
    }
}

template<class Values>
void read_faces(const Element& element, std::uint64_t num_vertices, Values& values,
                PolygonSoup& soup) {
    // Faces without properties take no bytes, however many there are.
    static_cast<void>(index_list(element));
    soup.face_ends.reserve(soup.face_ends.size() + element.count);
    read_index_lists(
        element, num_vertices, 0, values,
        [&](std::int64_t index) { soup.corners.push_back(static_cast<std::uint32_t>(index)); },
        [&] { soup.end_face(); });
}

/// Reads lists of strips. -1 ends a strip. Every second triangle of a strip is turned.
template<class Values>
void read_strips(const Element& element, std::uint64_t num_vertices, Values& values,
                 PolygonSoup& soup) {
    std::array<std::uint32_t, 2> last{};
    std::size_t length = 0;
    const auto add = [&](std::int64_t index) {
        if (index < 0) {
            length = 0;
            return;
        }
        const auto vertex = static_cast<std::uint32_t>(index);
        if (length >= 2) {
            const std::size_t turned = length % 2;
            soup.corners.insert(soup.corners.end(), {last[turned], last[1 - turned], vertex});
            soup.end_face();
        }
        last = {last[1], vertex};
        ++length;
    };
    read_index_lists(element, num_vertices, -1, values, add, [&] { length = 0; });
}

template<class Values>
PolygonSoup read_body(const Header& header, Values values) {
    check_sizes(header, values.num_bytes(), Values::IsBinary);
    std::uint64_t num_vertices = 0;
    for (const Element& element : header.elements)
        if (element.name == "vertex")
            num_vertices = element.count;
    if (num_vertices >= std::numeric_limits<std::uint32_t>::max())
        throw std::runtime_error(
            fmt::format("expected fewer than 2^32 vertices, got {}", num_vertices));
    PolygonSoup soup;
    for (const Element& element : header.elements) {
        if (element.name == "vertex" && element.count > 0)
            read_vertices(element, values, soup);
        else if (element.name == "face" && element.count > 0)
            read_faces(element, num_vertices, values, soup);
        else if (element.name == "tristrips" && element.count > 0)
            read_strips(element, num_vertices, values, soup);
        else
            skip(element, values);
    }
    values.expect_end();
    return soup;
}

} // namespace

PolygonSoup read_ply(std::span<const std::byte> bytes) {
    const std::string_view text = as_text(bytes);
    const Header header = ply_format::read_header(text);
    const std::string_view body = text.substr(header.num_bytes);
    PolygonSoup soup;
    if (header.format == "ascii")
        soup = read_body(header, AsciiValues(body));
    else if (header.format == "binary_little_endian")
        soup = read_body(header, BinaryValues<std::endian::little>(body));
    else if (header.format == "binary_big_endian")
        soup = read_body(header, BinaryValues<std::endian::big>(body));
    else
        throw std::runtime_error(fmt::format(
            "expected the format ascii, binary_little_endian or binary_big_endian, got {}",
            excerpt(header.format)));
    if (header.num_unknown > 0)
        soup.warnings.push_back(
            fmt::format("{} of the header that PLY does not have {} skipped, the first of {}",
                        header.num_unknown == 1 ? "a line" : "lines",
                        header.num_unknown == 1 ? "is" : "are", excerpt(header.unknown)));
    return soup;
}

} // namespace relumine::mesh
