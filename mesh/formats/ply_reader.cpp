// Reads the Polygon File Format (Greg Turk's PLY 1.0): ASCII and binary of both byte orders, with
// any number type for any property and elements in any order. Faces are polygons, with colours and
// uvs of their corners ("texcoord", as MeshLab writes them), or strips of triangles ("tristrips",
// as trimesh2 writes them). Further elements, properties and lists are skipped.
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
#include <functional>
#include <limits>

#include <fmt/format.h>

#include "mesh/formats/ply_header.h"
#include "mesh/formats/polygon_soup.h"
#include "mesh/formats/soup_colors.h"
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
     {"radiance_red", "red", "r", "diffuse_red"},
     {"radiance_green", "green", "g", "diffuse_green"},
     {"radiance_blue", "blue", "b", "diffuse_blue"},
     {"s", "u", "texture_u", "texture_s"},
     {"t", "v", "texture_v", "texture_t"}}};

std::size_t slot_of(const Property& property) {
    for (std::size_t slot = 0; slot < NumSlots && !property.size_type; ++slot)
        for (const std::string_view name : SlotNames[slot])
            if (!name.empty() && property.name == name)
                return slot;
    return NumSlots;
}

/// Bytes and shorts are fractions of their largest value. Other types are the colour itself, or
/// numbers of 0 to 255.
double color_scale(Type type) {
    return type == Type::Uint8 ? 1.0 / 255.0 : type == Type::Uint16 ? 1.0 / 65535.0 : 1.0;
}

/// Says how programs write colours of this type. A file of ours says itself that its are linear.
void set_color_custom(const Header& header, Type type, PolygonSoup& soup) {
    if (header.is_ours)
        return;
    soup.color_custom.may_be_whole = color_scale(type) == 1.0;
    if (ply_format::is_float(type)) {
        soup.color_custom.reason = "since they are floats";
        return;
    }
    soup.color_custom.curve = ColorCurve::Srgb;
    soup.color_custom.reason = "as other programs write whole numbers into .ply";
}

template<class Values>
void read_vertices(const Header& header, const Element& element, Values& values,
                   PolygonSoup& soup) {
    std::vector<std::size_t> slots; // slot of each property; NumSlots: skipped
    std::array<bool, NumSlots + 1> has{};
    std::array<double, NumSlots + 1> scale;
    scale.fill(1.0);
    // Lit meshes have their light beside the colours that viewers show.
    const bool is_lit = std::any_of(
        element.properties.begin(), element.properties.end(),
        [](const Property& property) { return property.name == SlotNames[Red].front(); });
    for (const Property& property : element.properties) {
        // If the same number has several names ("u" beside "s"), the first one counts.
        std::size_t slot = slot_of(property);
        if (is_lit && slot >= Red && slot <= Blue && property.name != SlotNames[slot].front())
            slot = NumSlots;
        slots.push_back(has[slot] ? NumSlots : slot);
        has[slot] = slot != NumSlots;
        if (slots.back() >= Red && slots.back() <= Blue) {
            scale[slot] = color_scale(property.type);
            set_color_custom(header, property.type, soup);
        }
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
        soup.add_position({row[X], row[Y], row[Z]});
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

/// Reads the elements' lists of vertex indices. Calls `add` with each index, `other` with each
/// other property, which it reads, and `end` after each element. -1 is an index, too, where `least`
/// is -1.
template<class Values, class Add, class Other, class End>
void read_index_lists(const Element& element, std::uint64_t num_vertices, int least, Values& values,
                      const Add& add, const Other& other, const End& end) {
    const auto indices = index_list(element);
    for (std::uint64_t i = 0; i < element.count; ++i) {
        for (auto property = element.properties.begin(); property != element.properties.end();
             ++property) {
            if (property != indices) {
                other(*property);
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

/// Takes the uvs of a face's corners. Lists of another length than the face has corners are none.
void add_wedges(const std::vector<float>& wedges, std::size_t num_corners, PolygonSoup& soup) {
    for (std::size_t i = 0; i < num_corners; ++i)
        soup.corner_uvs.push_back(wedges.size() == 2 * num_corners
                                      ? glm::vec2(wedges[2 * i], wedges[2 * i + 1])
                                      : glm::vec2(0.0f));
}

template<class Values>
void read_faces(const Header& header, const Element& element, std::uint64_t num_vertices,
                Values& values, PolygonSoup& soup) {
    // Faces without properties take no bytes, however many there are.
    static_cast<void>(index_list(element));
    soup.face_ends.reserve(soup.face_ends.size() + element.count);
    bool has_wedges = false;
    std::array<bool, 3> has{};
    for (const Property& property : element.properties) {
        const std::size_t slot = slot_of(property);
        if (slot >= Red && slot <= Blue) {
            has[slot - Red] = true;
            set_color_custom(header, property.type, soup);
        }
        has_wedges = has_wedges || (property.name == "texcoord" && property.size_type);
    }
    const bool has_colors = has[0] && has[1] && has[2];
    // Strips may stand before.
    if (has_colors)
        soup.face_colors.resize(soup.face_ends.size(), no_color());
    if (has_wedges)
        soup.corner_uvs.resize(soup.corners.size(), glm::vec2(0.0f));
    glm::vec3 color(0.0f);
    std::vector<float> wedges;
    std::size_t begin = soup.corners.size(), num_odd = 0;
    const auto other = [&](const Property& property) {
        const std::size_t slot = slot_of(property);
        if (property.name == "texcoord" && property.size_type) {
            wedges.resize(0);
            for (std::uint32_t i = list_size(property, values); i > 0; --i)
                wedges.push_back(static_cast<float>(values.next(property.type)));
        } else if (slot >= Red && slot <= Blue) {
            color[static_cast<int>(slot - Red)] =
                static_cast<float>(values.next(property.type) * color_scale(property.type));
        } else {
            skip(property, values);
        }
    };
    const auto end = [&] {
        const std::size_t num_corners = soup.corners.size() - begin;
        soup.end_face();
        if (has_colors)
            soup.face_colors.push_back(color);
        if (has_wedges) {
            add_wedges(wedges, num_corners, soup);
            num_odd += wedges.size() == 2 * num_corners ? 0 : 1;
        }
        begin = soup.corners.size();
    };
    read_index_lists(
        element, num_vertices, 0, values,
        [&](std::int64_t index) { soup.corners.push_back(static_cast<std::uint32_t>(index)); },
        other, end);
    if (num_odd != 0)
        soup.warnings.push_back(
            fmt::format("{} of {} faces have no uvs of their corners, or not two numbers for each",
                        num_odd, element.count));
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
    read_index_lists(
        element, num_vertices, -1, values, add,
        [&](const Property& property) { skip(property, values); }, [&] { length = 0; });
}

/// Of colours of vertices and of faces those of faces count, unless they are all the same.
void choose_colors(PolygonSoup& soup) {
    if (soup.colors.empty())
        return;
    const auto are_one = [](const std::vector<glm::vec3>& colors) {
        return std::adjacent_find(colors.begin(), colors.end(), std::not_equal_to<>()) ==
               colors.end();
    };
    const bool takes_vertices = are_one(soup.face_colors) && !are_one(soup.colors);
    (takes_vertices ? soup.face_colors : soup.colors).clear();
    soup.notes.emplace_back(fmt::format("vertices and faces have colours: those of {} are taken",
                                        takes_vertices ? "vertices" : "faces"));
}

/// Whether the file has such elements.
bool header_has(const Header& header, std::string_view name) {
    return std::any_of(header.elements.begin(), header.elements.end(), [&](const Element& element) {
        return element.name == name && element.count > 0;
    });
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
            read_vertices(header, element, values, soup);
        else if (element.name == "face" && element.count > 0)
            read_faces(header, element, num_vertices, values, soup);
        else if (element.name == "tristrips" && element.count > 0)
            read_strips(element, num_vertices, values, soup);
        else
            skip(element, values);
    }
    values.expect_end();
    if (soup.face_ends.empty() && header_has(header, "range_grid"))
        soup.why_no_faces = "; its range_grid is not read, MeshLab makes faces of it";
    if (!soup.face_colors.empty()) {
        soup.face_colors.resize(soup.face_ends.size(), no_color());
        choose_colors(soup);
    }
    if (!soup.corner_uvs.empty())
        soup.corner_uvs.resize(soup.corners.size(), glm::vec2(0.0f));
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
    if (!header.image.empty())
        soup.warnings.push_back(fmt::format(
            "the image {}, which a comment names, is left out: textures of .ply are not "
            "read",
            excerpt(header.image)));
    if (header.num_unknown > 0)
        soup.warnings.push_back(
            fmt::format("{} of the header that PLY does not have {} skipped, the first of {}",
                        header.num_unknown == 1 ? "a line" : "lines",
                        header.num_unknown == 1 ? "is" : "are", excerpt(header.unknown)));
    return soup;
}

} // namespace relumine::mesh
