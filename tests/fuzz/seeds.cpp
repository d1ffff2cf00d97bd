// Writes the binary seeds of the corpus anew, small files by our own writers: fuzz_seeds FOLDER. To
// be run when a format changed.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfRgbaFile.h>
#include <ImfTileDescriptionAttribute.h>
#include <ImfTiledOutputFile.h>
#include <fmt/format.h>
#include <stb/stb_image_write.h>

#include "cubemap/image/image_file.h"
#include "files/output_file.h"
#include "mesh/load.h"
#include "mesh/save.h"
#include "prt/glossy/glossy_precompute.h"
#include "prt/parts/part_file.h"
#include "prt/precompute.h"
#include "prt/scene/packed_sections.h"
#include "prt/scene/scene_file.h"
#include "prt/visibility/ray_scene.h"
#include "tests/app/small_files.h"
#include "tests/fuzz/section_names.h"
#include "tests/mesh/texture_files.h"

namespace {

using namespace relumine;
namespace fs = std::filesystem;

void write(const fs::path& path, std::string_view content) {
    fs::create_directories(path.parent_path());
    files::save_text(path, content);
}

void write(const fs::path& path, const std::vector<std::byte>& content) {
    write(path, std::string_view(reinterpret_cast<const char*>(content.data()), content.size()));
}

std::string text_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

mesh::TriangleMesh octahedron(const fs::path& folder) {
    const fs::path path = folder / "octahedron.obj";
    write(path, app::octahedron_obj());
    mesh::TriangleMesh mesh = mesh::load(path);
    mesh.colors.assign(mesh.num_vertices(), glm::vec3(0.5f, 0.25f, 1.0f));
    return mesh;
}

void write_meshes(const fs::path& folder) {
    const mesh::TriangleMesh mesh = octahedron(folder / "obj");
    for (const char* name : {"ply/octahedron.ply", "gltf/octahedron.glb"}) {
        fs::create_directories((folder / name).parent_path());
        mesh::save(folder / name, mesh);
    }
    std::string stl(80, ' ');
    const auto put = [&](auto value) {
        stl.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    put(static_cast<std::uint32_t>(mesh.num_triangles()));
    for (const mesh::Triangle& triangle : mesh.triangles) {
        put(glm::vec3(0.0f));
        for (const std::uint32_t vertex : triangle)
            put(mesh.positions[vertex]);
        put(std::uint16_t{0});
    }
    write(folder / "stl/octahedron.stl", stl);
}

void write_textures(const fs::path& folder) {
    write(folder / "four_colors.png", mesh::four_colors());
    const std::vector<std::uint8_t> pixels = {255, 0,  0,  255, 0, 255, 0, 128, 0, 0, 255, 0,
                                              99,  99, 99, 1,   3, 4,   5, 6,   7, 8, 9,   9};
    std::string file;
    const auto append = [](void* to, void* data, int size) {
        static_cast<std::string*>(to)->append(static_cast<const char*>(data),
                                              static_cast<std::size_t>(size));
    };
    const auto finish = [&](const char* name) {
        write(folder / name, file);
        file.clear();
    };
    stbi_write_jpg_to_func(append, &file, 3, 2, 4, pixels.data(), 80);
    finish("small.jpg");
    stbi_write_bmp_to_func(append, &file, 3, 2, 4, pixels.data());
    finish("small.bmp");
    stbi_write_tga_to_func(append, &file, 3, 2, 4, pixels.data());
    finish("small.tga");
    stbi_write_png_to_func(append, &file, 3, 2, 2, pixels.data(), 6);
    finish("grey_alpha.png");
}

app::Painter gradient() {
    return [](std::uint32_t x, std::uint32_t y) {
        return app::Rgb{static_cast<float>(x), 0.5f * static_cast<float>(y), 1.0f};
    };
}

cubemap::EnvironmentImage image(cubemap::Layout layout, std::uint32_t width, std::uint32_t height,
                                cubemap::Sampling sampling) {
    cubemap::EnvironmentImage result;
    result.width = width;
    result.height = height;
    result.layout = layout;
    result.sampling = sampling;
    for (std::uint32_t i = 0; i < width * height; ++i)
        result.pixels.emplace_back(i % width, i / width, 1.0f);
    return result;
}

void write_exr_variants(const fs::path& folder) {
    fs::create_directories(folder);
    constexpr int Width = 8, Height = 4;
    std::vector<Imath::half> values;
    for (int i = 0; i < Width * Height; ++i)
        values.emplace_back(static_cast<float>(i % 5));
    const auto with_buffer = [&](Imf::Header& header, Imf::FrameBuffer& buffer) {
        for (const char* channel : {"R", "G", "B"}) {
            header.channels().insert(channel, Imf::Channel(Imf::HALF));
            buffer.insert(channel, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(values.data()), 2,
                                              2 * Width));
        }
    };
    struct Compression {
        const char* name;
        Imf::Compression value;
    };
    for (const Compression& each : {Compression{"rle", Imf::RLE_COMPRESSION},
                                    {"piz", Imf::PIZ_COMPRESSION},
                                    {"pxr24", Imf::PXR24_COMPRESSION},
                                    {"b44", Imf::B44_COMPRESSION},
                                    {"dwaa", Imf::DWAA_COMPRESSION}}) {
        Imf::Header header(Width, Height);
        header.compression() = each.value;
        Imf::FrameBuffer buffer;
        with_buffer(header, buffer);
        Imf::OutputFile file((folder / fmt::format("half_{}.exr", each.name)).c_str(), header, 0);
        file.setFrameBuffer(buffer);
        file.writePixels(Height);
    }
    {
        Imf::Header header(Width, Height);
        header.compression() = Imf::ZIPS_COMPRESSION;
        header.setTileDescription(Imf::TileDescription(4, 4, Imf::MIPMAP_LEVELS));
        Imf::FrameBuffer buffer;
        with_buffer(header, buffer);
        Imf::TiledOutputFile file((folder / "tiles.exr").c_str(), header, 0);
        file.setFrameBuffer(buffer);
        for (int level = 0; level < file.numLevels(); ++level)
            file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
    }
    {
        const std::vector<Imf::Rgba> pixels(Width * Height, Imf::Rgba(1.0f, 0.5f, 0.25f));
        Imf::RgbaOutputFile file((folder / "chroma.exr").c_str(), Width, Height, Imf::WRITE_YC);
        file.setFrameBuffer(pixels.data(), 1, Width);
        file.writePixels(Height);
    }
}

void write_environments(const fs::path& folder) {
    using cubemap::Layout;
    using cubemap::Sampling;
    write(folder / "exr/plain.exr", app::exr_file(8, 4, gradient()));
    write(folder / "exr/cube_zip.exr",
          cubemap::encode_exr(image(Layout::Cube, 3, 18, Sampling::Borders)));
    write_exr_variants(folder / "exr");
    write(folder / "hdr/flat.hdr", app::hdr_file(4, 2, gradient()));
    write(folder / "hdr/runs.hdr",
          cubemap::encode_hdr(image(Layout::LatLong, 16, 8, Sampling::TexelCentres)));
    write(folder / "hdr/old_runs.hdr",
          std::string("#?RGBE\nEXPOSURE=2\nCOLORCORR=1 1 0.5\nFORMAT=32-bit_rle_rgbe\n\n+Y 3 -X 4\n"
                      "\x80\x40\x20\x81\x01\x01\x01\x03\x80\x40\x20\x81\x01\x01\x01\x07",
                      86));
}

/// A zstd frame of one raw block, so that the fuzzer sees what is in it.
std::string raw_frame(const std::string& content) {
    const auto size = static_cast<std::uint32_t>(content.size());
    std::string frame = "\x28\xb5\x2f\xfd\xa0";
    const auto put = [&](std::uint32_t value, std::size_t num_bytes) {
        frame.append(reinterpret_cast<const char*>(&value), num_bytes);
    };
    put(size, 4);
    put(size << 3 | 1, 3);
    return frame + content;
}

/// The same file with raw frames; its checksums are the target's business.
std::string with_raw_frames(const fs::path& path) {
    const prt::Sections sections = prt::read_sections(path);
    std::string file = text_of(path).substr(0, 40), stored;
    for (const auto& [name, content] : sections) {
        const std::string frame =
            raw_frame({reinterpret_cast<const char*>(content.data()), content.size()});
        std::string padded = name;
        padded.resize(16);
        file += padded;
        for (const std::uint64_t number : {40 + 48 * sections.size() + stored.size(), frame.size(),
                                           content.size(), std::size_t{0}})
            file.append(reinterpret_cast<const char*>(&number), 8);
        stored += frame;
    }
    return file + stored;
}

/// As the target `sections` reads them.
std::string lettered(const fs::path& path) {
    std::string result;
    for (const auto& [name, content] : prt::read_sections(path)) {
        const auto known = std::find(fuzz::SectionNames.begin(), fuzz::SectionNames.end(), name);
        if (known == fuzz::SectionNames.end())
            throw std::logic_error(name + ": expected a line of tests/fuzz/section_names.h");
        result += static_cast<char>('A' + (known - fuzz::SectionNames.begin()));
        result += static_cast<char>(content.size() & 0xff);
        result += static_cast<char>(content.size() >> 8);
        result.append(reinterpret_cast<const char*>(content.data()), content.size());
    }
    return result;
}

void write_scenes(const fs::path& folder) {
    prt::Scene scene;
    scene.mesh = octahedron(folder / "obj");
    const prt::RayScene rays(scene.mesh);
    const prt::PrecomputeOptions options{
        .tolerance = 0.2f, .min_level = 0, .face_resolution = 4, .bias = 1e-4f};
    scene.settings = {.tolerance = options.tolerance,
                      .face_resolution = options.face_resolution,
                      .bias = options.bias,
                      .source = "octahedron.obj"};
    const auto save = [&](const std::string& name) {
        fs::create_directories(folder / "prt");
        const fs::path path = folder / "prt" / (name + ".prt");
        prt::save_scene(path, scene);
        write(folder / "prt" / (name + "_raw.prt"), with_raw_frames(path));
        write(folder / "sections" / name, lettered(path));
    };
    scene.receivers = prt::vertex_receivers(scene.mesh);
    scene.transfer = prt::precompute(scene.receivers, rays, options);
    save("vertices");
    prt::look_from(scene.receivers, glm::vec3(0.0f, 1.0f, 3.0f));
    scene.receivers.surfaces.assign(scene.receivers.size(), {.specular = glm::vec3(0.5f),
                                                             .highlight = prt::Highlight::Ggx,
                                                             .roughness_or_exponent = 0.5f});
    scene.transfer.glossy =
        prt::precompute_glossy(scene.receivers, rays, scene.transfer,
                               {.tolerance = 0.5f, .face_resolution = 4, .bias = 1e-4f});
    prt::set_surfaces(scene.transfer, scene.receivers);
    scene.settings.glossy_tolerance = 0.5f;
    save("glossy");
    prt::Plan plan{.scene = scene, .has_clusters = true};
    plan.scene.transfer.glossy.reset();
    plan.scene.transfer.counts = {};
    prt::save_plan(folder / "prt" / "glossy.plan", plan);
    write(folder / "sections" / "glossy_plan", lettered(folder / "prt" / "glossy.plan"));
    fs::remove(folder / "prt" / "glossy.plan");

    // Four texels of one triangle.
    prt::Scene texels;
    texels.mesh = scene.mesh;
    texels.mesh.colors.clear();
    texels.layout = prt::TexelLayout{.width = 3, .height = 2, .texels = {0, 1, 3, 4}};
    for (int i = 0; i < 4; ++i) {
        texels.receivers.positions.emplace_back(0.3f, 0.3f, 0.4f);
        texels.receivers.normals.emplace_back(0.6f, 0.8f, 0.0f);
        texels.receivers.points.push_back({.triangle = 0, .barycentric = {0.1f, 0.2f}});
    }
    texels.transfer = prt::precompute(texels.receivers, rays, options);
    texels.settings = scene.settings;
    texels.settings.glossy_tolerance.reset();
    std::swap(scene, texels);
    save("texels");
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        fmt::print(stderr, "usage: fuzz_seeds FOLDER\n");
        return 2;
    }
    const fs::path folder = argv[1];
    write_meshes(folder);
    write_textures(folder / "texture");
    write_environments(folder);
    write_scenes(folder);
    return 0;
}
