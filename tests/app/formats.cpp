#include "tests/app/formats.h"

#include <cmath>
#include <cstring>
#include <stdexcept>

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

namespace relumine::app {

namespace {

void require(bool condition, const char* what) {
    if (!condition)
        throw std::runtime_error(what);
}

template<typename T>
T at(const std::string& bytes, std::size_t offset) {
    require(offset + sizeof(T) <= bytes.size(), "the file ends too early");
    T value;
    std::memcpy(&value, bytes.data() + offset, sizeof(T));
    return value;
}

std::uint32_t big_endian(const std::string& bytes, std::size_t offset) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
        value = value << 8 | at<std::uint8_t>(bytes, offset + i);
    return value;
}

} // namespace

std::vector<std::array<float, 3>> npy_values(const std::string& bytes) {
    require(bytes.rfind(std::string("\x93NUMPY\x01\x00", 8), 0) == 0, "no .npy of version 1.0");
    const std::size_t header_bytes = at<std::uint16_t>(bytes, 8);
    const std::string header = bytes.substr(10, header_bytes);
    require((10 + header_bytes) % 64 == 0, ".npy data not aligned");
    require(header.find("'descr': '<f4'") != std::string::npos, "no float32");
    require(header.find("'fortran_order': False") != std::string::npos, "not in C order");
    const std::size_t shape = header.find("'shape': (");
    require(shape != std::string::npos, "no shape");
    // All but the last length of the shape.
    std::size_t count = 1;
    for (std::size_t at = shape + 10; header.find(')', at) > header.find(',', at);
         at = header.find(',', at) + 1)
        count *= std::stoull(header.substr(at));
    require(header.find(", 3)", shape) != std::string::npos, "not rows of three");
    require(bytes.size() == 10 + header_bytes + count * 12,
            "another number of values than the header says");
    std::vector<std::array<float, 3>> values(count);
    if (count > 0)
        std::memcpy(values.data(), bytes.data() + 10 + header_bytes, count * 12);
    return values;
}

Size png_size(const std::string& bytes) {
    require(bytes.rfind("\x89PNG\r\n\x1a\n", 0) == 0, "no PNG");
    require(bytes.substr(12, 4) == "IHDR", "no IHDR");
    require(bytes.substr(bytes.size() - 8, 4) == "IEND", "no IEND at the end");
    return {big_endian(bytes, 16), big_endian(bytes, 20)};
}

Size exr_size(const std::string& bytes) {
    require(bytes.rfind("\x76\x2f\x31\x01", 0) == 0, "no OpenEXR");
    const std::string name("dataWindow\0box2i\0\x10\0\0\0", 21);
    const std::size_t found = bytes.find(name);
    require(found != std::string::npos, "no data window");
    const auto corner = [&](std::size_t i) {
        return at<std::int32_t>(bytes, found + name.size() + 4 * i);
    };
    return {static_cast<std::uint32_t>(corner(2) - corner(0) + 1),
            static_cast<std::uint32_t>(corner(3) - corner(1) + 1)};
}

std::map<std::string, std::vector<float>> exr_channels(const std::filesystem::path& path) {
    Imf::InputFile file(path.c_str());
    const Imath::Box2i window = file.header().dataWindow();
    const auto width = static_cast<std::size_t>(window.max.x + 1);
    const auto height = static_cast<std::size_t>(window.max.y + 1);
    std::map<std::string, std::vector<float>> channels;
    Imf::FrameBuffer buffer;
    for (auto each = file.header().channels().begin(); each != file.header().channels().end();
         ++each) {
        std::vector<float>& values = channels[each.name()];
        values.resize(width * height);
        buffer.insert(each.name(), Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()),
                                              sizeof(float), sizeof(float) * width));
    }
    file.setFrameBuffer(buffer);
    file.readPixels(0, window.max.y);
    return channels;
}

nlohmann::json glb_json(const std::string& bytes) {
    require(bytes.rfind("glTF", 0) == 0, "no binary glTF");
    require(at<std::uint32_t>(bytes, 4) == 2, "not glTF 2");
    require(at<std::uint32_t>(bytes, 8) == bytes.size(),
            "the length in the header is not the file's");
    require(bytes.substr(16, 4) == "JSON", "no JSON chunk first");
    return nlohmann::json::parse(bytes.substr(20, at<std::uint32_t>(bytes, 12)));
}

std::size_t ply_element(const std::string& bytes, const std::string& name) {
    require(bytes.rfind("ply\nformat binary_little_endian 1.0\n", 0) == 0, "no little-endian PLY");
    const std::string header = bytes.substr(0, bytes.find("end_header\n"));
    const std::size_t found = header.find("element " + name + " ");
    require(found != std::string::npos, "no such element");
    return std::stoull(header.substr(found + 9 + name.size()));
}

double relative_l2(const std::vector<std::array<float, 3>>& a,
                   const std::vector<std::array<float, 3>>& b) {
    require(a.size() == b.size(), "different numbers of values");
    double error = 0.0;
    double norm = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            error += std::pow(static_cast<double>(a[i][c]) - b[i][c], 2);
            norm += std::pow(static_cast<double>(b[i][c]), 2);
        }
    return std::sqrt(error / norm);
}

} // namespace relumine::app
