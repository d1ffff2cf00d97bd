#include "tests/mesh/mesh_files.h"

#include <bit>

namespace relumine::mesh {

namespace {

/// Writes numbers of any PLY type as text or binary.
class PlyWriter {
public:
    explicit PlyWriter(std::string format) : format_(std::move(format)) {}
    void number(const std::string& type, double value) {
        if (format_ == "ascii")
            content_ += fmt::format("{} ", value);
        else if (type == "float")
            raw(static_cast<float>(value));
        else if (type == "double")
            raw(value);
        else if (type == "uchar" || type == "char")
            raw(static_cast<std::uint8_t>(value));
        else if (type == "short" || type == "ushort")
            raw(static_cast<std::uint16_t>(value));
        else
            raw(static_cast<std::uint32_t>(value));
    }
    void list(const std::string& size_type, const std::string& type,
              const std::vector<double>& values) {
        number(size_type, static_cast<double>(values.size()));
        for (const double value : values)
            number(type, value);
    }
    void end_element() {
        if (format_ == "ascii")
            content_ += '\n';
    }
    [[nodiscard]] const std::string& content() const { return content_; }

private:
    template<class Value>
    void raw(Value value) {
        auto bytes = std::bit_cast<std::array<char, sizeof(Value)>>(value);
        if (format_ == "binary_big_endian")
            std::reverse(bytes.begin(), bytes.end());
        content_.append(bytes.data(), bytes.size());
    }
    std::string format_;
    std::string content_;
};

std::string header(const PlyOptions& o) {
    const std::string vertex =
        fmt::format("element vertex 8\n{}property {} x\nproperty {} y\nproperty {} z\n{}",
                    o.vertex_extras ? "property list uchar float weights\n" : "", o.coordinate_type,
                    o.coordinate_type, o.coordinate_type,
                    o.vertex_extras ? "property short flags\nproperty uchar red\nproperty uchar "
                                      "green\nproperty uchar blue\n"
                                    : "");
    const std::string face = fmt::format(
        "element face 7\n{}property list {} {} {}\n{}",
        o.face_list_before ? "property list uchar float texcoord\n" : "", o.size_type, o.index_type,
        o.index_name,
        o.face_list_after ? "property list uchar float texcoord\nproperty uchar red\n" : "");
    return fmt::format("ply\nformat {} 1.0\ncomment a box\n{}{}{}end_header\n", o.format,
                       o.other_element
                           ? "element camera 2\nproperty list uchar float view\nproperty int id\n"
                           : "",
                       o.faces_first ? face : vertex, o.faces_first ? vertex : face);
}

} // namespace

std::string box_ply(const PlyOptions& o) {
    PlyWriter writer(o.format);
    const auto write_vertices = [&] {
        for (const glm::vec3& position : BoxPositions) {
            if (o.vertex_extras)
                writer.list("uchar", "float", {0.5, 0.25});
            for (int i = 0; i < 3; ++i)
                writer.number(o.coordinate_type, double{position[i]});
            if (o.vertex_extras) {
                writer.number("short", 7);
                for (const double channel : {255.0, 51.0, 0.0})
                    writer.number("uchar", channel);
            }
            writer.end_element();
        }
    };
    const auto write_faces = [&] {
        for (const auto& face : BoxFaces) {
            if (o.face_list_before)
                writer.list("uchar", "float", {0, 1, 2, 3, 4, 5});
            writer.list(o.size_type, o.index_type, std::vector<double>(face.begin(), face.end()));
            if (o.face_list_after) {
                writer.list("uchar", "float", {0, 1, 2, 3, 4, 5});
                writer.number("uchar", 200);
            }
            writer.end_element();
        }
    };
    if (o.other_element) {
        writer.list("uchar", "float", {1.5, 2});
        writer.number("int", 7);
        writer.end_element();
        writer.list("uchar", "float", {});
        writer.number("int", 8);
        writer.end_element();
    }
    if (o.faces_first)
        write_faces();
    write_vertices();
    if (!o.faces_first)
        write_faces();
    return header(o) + writer.content();
}

std::string box_binary_stl() {
    std::string facets;
    std::uint32_t num_facets = 0;
    const auto append = [&facets](const auto& value) {
        facets.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    for (const auto& face : BoxFaces)
        for (std::size_t i = 1; i + 1 < face.size(); ++i, ++num_facets) {
            append(glm::vec3(0.0f));
            append(BoxPositions[face[0]]);
            append(BoxPositions[face[i]]);
            append(BoxPositions[face[i + 1]]);
            append(std::uint16_t{0x1234});
        }
    std::string content = fmt::format("{:<80}", "solid"); // binary all the same
    content.append(reinterpret_cast<const char*>(&num_facets), sizeof num_facets);
    return content + facets;
}

} // namespace relumine::mesh
