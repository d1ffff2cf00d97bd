#include "mesh/formats/ply_header.h"

#include <array>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "files/joined.h"
#include "mesh/text_reader.h"

namespace relumine::mesh::ply_format {

namespace {

Type type_named(std::string_view name, const TextReader& reader) {
    constexpr std::array<std::array<std::string_view, 2>, 8> Names = {{{"char", "int8"},
                                                                       {"uchar", "uint8"},
                                                                       {"short", "int16"},
                                                                       {"ushort", "uint16"},
                                                                       {"int", "int32"},
                                                                       {"uint", "uint32"},
                                                                       {"float", "float32"},
                                                                       {"double", "float64"}}};
    for (std::size_t i = 0; i < Names.size(); ++i)
        if (name == Names[i][0] || name == Names[i][1])
            return static_cast<Type>(i);
    reader.fail("a number type such as float or uchar", excerpt(name));
}

void read_property(const TextReader& reader, Header& header) {
    const std::vector<std::string_view>& words = reader.words();
    if (header.elements.empty())
        reader.fail("an element before its properties", excerpt(words[0]));
    Property property;
    if (words.size() == 5 && words[1] == "list") {
        property.size_type = type_named(words[2], reader);
        if (is_float(*property.size_type))
            reader.fail("a whole number as the size of a list", excerpt(words[2]));
        property.type = type_named(words[3], reader);
    } else if (words.size() == 3)
        property.type = type_named(words[1], reader);
    else
        reader.fail("'property TYPE NAME' or 'property list TYPE TYPE NAME'",
                    fmt::format("{} words", words.size()));
    property.name = words.back();
    header.elements.back().properties.push_back(property);
}

/// Finds the line "end_header". Returns the text before it and the position of the data behind it.
std::pair<std::string_view, std::size_t> split_header(std::string_view text) {
    constexpr std::string_view EndKeyword = "end_header";
    for (std::size_t at = text.find(EndKeyword); at != std::string_view::npos;
         at = text.find(EndKeyword, at + 1)) {
        std::size_t end = text.find_first_not_of(" \t", at + EndKeyword.size());
        if (at == 0 || (text[at - 1] != '\n' && text[at - 1] != '\r') ||
            end == std::string_view::npos || (text[end] != '\n' && text[end] != '\r'))
            continue;
        // After a lone CR the first byte of the data may happen to be an LF. The end of the first
        // line shows how lines end.
        const std::string_view first_end = text.substr(text.find_first_of("\r\n"), 2);
        const bool lone_cr = first_end[0] == '\r' && first_end != "\r\n";
        end += text.substr(end, 2) == "\r\n" && !lone_cr ? 2 : 1;
        return {text.substr(0, at), end};
    }
    throw std::runtime_error("expected a PLY header that ends in 'end_header', got none");
}

} // namespace

std::size_t size_of(Type type) {
    constexpr std::array<std::size_t, 8> Sizes = {1, 1, 2, 2, 4, 4, 4, 8};
    return Sizes[static_cast<std::size_t>(type)];
}

bool is_float(Type type) {
    return type == Type::Float32 || type == Type::Float64;
}

Header read_header(std::string_view text) {
    const std::string_view first_line = text.substr(0, text.find_first_of("\r\n"));
    if (!first_line.starts_with("ply") || first_line.find_first_not_of(" \t", 3) != first_line.npos)
        throw std::runtime_error(fmt::format("expected a PLY file that begins with 'ply', got {}",
                                             excerpt(text.substr(0, 3))));
    Header header;
    const auto [header_text, num_bytes] = split_header(text);
    header.num_bytes = num_bytes;
    TextReader reader(header_text);
    reader.next_line();
    while (reader.next_line()) {
        const std::vector<std::string_view>& words = reader.words();
        if (words[0] == "comment" && words.size() > 1 && words[1].starts_with("Relumine"))
            header.is_ours = true;
        if (words[0] == "comment" && words.size() > 2 && words[1] == "TextureFile" &&
            header.image.empty())
            header.image = files::joined(std::span(words).subspan(2), " ");
        if (words[0] == "comment" || words[0] == "obj_info")
            continue;
        if (words[0] == "format" && words.size() == 3 && words[2] == "1.0")
            header.format = words[1];
        else if (words[0] == "element" && words.size() == 3) {
            const std::int64_t count = reader.integer(words[2]);
            if (count < 0)
                reader.fail("a number of elements", excerpt(words[2]));
            for (const Element& element : header.elements)
                if (element.name == words[1])
                    reader.fail("each element once", excerpt(words[1]));
            header.elements.push_back({words[1], static_cast<std::uint64_t>(count), {}});
        } else if (words[0] == "property")
            read_property(reader, header);
        else if (words[0] == "format" || words[0] == "element")
            reader.fail("format 1.0 or 'element NAME NUMBER'", excerpt(files::joined(words, " ")));
        else if (header.num_unknown++ == 0)
            header.unknown = words[0];
    }
    return header;
}

} // namespace relumine::mesh::ply_format
