#include "tests/app/small_files.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

namespace relumine::app {

namespace {

template<typename T>
void put(std::string& bytes, T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes.append(raw, sizeof(T));
}

void put_attribute(std::string& bytes, const std::string& name, const std::string& type,
                   const std::string& value) {
    bytes += name + '\0' + type + '\0';
    put(bytes, static_cast<std::int32_t>(value.size()));
    bytes += value;
}

} // namespace

std::string octahedron_obj() {
    return "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n"
           "f 3 5 1\nf 3 1 6\nf 3 6 2\nf 3 2 5\nf 4 1 5\nf 4 6 1\nf 4 2 6\nf 4 5 2\n";
}

std::string hdr_file(std::uint32_t width, std::uint32_t height, const Painter& painter) {
    std::string bytes =
        fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", height, width);
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            const Rgb color = painter(x, y);
            int exponent = 0;
            const float largest = std::max({color[0], color[1], color[2]});
            std::frexp(largest, &exponent);
            for (const float value : color)
                bytes += largest > 0.0f ? static_cast<char>(static_cast<unsigned char>(
                                              std::ldexp(value, 8 - exponent)))
                                        : '\0';
            bytes += largest > 0.0f ? static_cast<char>(exponent + 128) : '\0';
        }
    return bytes;
}

std::string exr_file(std::uint32_t width, std::uint32_t height, const Painter& painter) {
    std::string channels;
    for (const char* name : {"B", "G", "R"}) {
        channels += name + std::string(1, '\0');
        put(channels, std::int32_t{2}); // float
        put(channels, std::int32_t{0}); // not perceptually linear
        put(channels, std::int32_t{1});
        put(channels, std::int32_t{1});
    }
    channels += '\0';
    std::string window;
    for (const std::uint32_t value : {0u, 0u, width - 1, height - 1})
        put(window, value);
    std::string one;
    put(one, 1.0f);
    std::string centre;
    put(centre, 0.0f);
    put(centre, 0.0f);

    std::string bytes = "\x76\x2f\x31\x01";
    put(bytes, std::int32_t{2});
    put_attribute(bytes, "channels", "chlist", channels);
    put_attribute(bytes, "compression", "compression", std::string(1, '\0'));
    put_attribute(bytes, "dataWindow", "box2i", window);
    put_attribute(bytes, "displayWindow", "box2i", window);
    put_attribute(bytes, "lineOrder", "lineOrder", std::string(1, '\0'));
    put_attribute(bytes, "pixelAspectRatio", "float", one);
    put_attribute(bytes, "screenWindowCenter", "v2f", centre);
    put_attribute(bytes, "screenWindowWidth", "float", one);
    bytes += '\0';

    const std::uint64_t line_bytes = 12ull * width;
    const std::uint64_t first_line = bytes.size() + 8ull * height;
    for (std::uint32_t y = 0; y < height; ++y)
        put(bytes, first_line + y * (8 + line_bytes));
    for (std::uint32_t y = 0; y < height; ++y) {
        put(bytes, y);
        put(bytes, static_cast<std::uint32_t>(line_bytes));
        for (const std::size_t channel : {2u, 1u, 0u})
            for (std::uint32_t x = 0; x < width; ++x)
                put(bytes, painter(x, y)[channel]);
    }
    return bytes;
}

std::string white_hdr() {
    return hdr_file(64, 32, [](std::uint32_t, std::uint32_t) { return Rgb{1.0f, 1.0f, 1.0f}; });
}

std::string lamp_hdr(std::uint32_t column) {
    return hdr_file(128, 64, [column](std::uint32_t x, std::uint32_t y) {
        const float radiance =
            (y == 31 || y == 32) && (x == column || x + 1 == column) ? 512.0f : 0.0f;
        return Rgb{radiance, radiance, radiance};
    });
}

} // namespace relumine::app
