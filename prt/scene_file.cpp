#include "prt/scene_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <xxhash.h>

#include "files/output_file.h"
#include "prt/section_file.h"

namespace relumine::prt {

namespace {

template<typename Element>
std::vector<std::byte> bytes_of(const std::vector<Element>& elements) {
    static_assert(std::is_trivially_copyable_v<Element>);
    std::vector<std::byte> bytes(elements.size() * sizeof(Element));
    if (!elements.empty())
        std::memcpy(bytes.data(), elements.data(), bytes.size());
    return bytes;
}

/// Split flags, eight to a byte, lowest bit first; the number of flags in front.
std::vector<std::byte> packed(const std::vector<bool>& flags) {
    std::vector<std::uint8_t> bytes(sizeof(std::uint32_t) + (flags.size() + 7) / 8);
    const auto num_flags = static_cast<std::uint32_t>(flags.size());
    std::memcpy(bytes.data(), &num_flags, sizeof num_flags);
    for (std::size_t i = 0; i < flags.size(); ++i)
        bytes[sizeof num_flags + i / 8] |=
            static_cast<std::uint8_t>(static_cast<unsigned>(flags[i]) << (i % 8));
    return bytes_of(bytes);
}

std::vector<std::byte> settings_json(const SceneSettings& settings) {
    nlohmann::json json = {{"tolerance", settings.tolerance},
                           {"min_level", settings.min_level},
                           {"face_resolution", settings.face_resolution},
                           {"bias", settings.bias},
                           {"floor_vertices", settings.floor_vertices},
                           {"source", settings.source},
                           {"source_hash", fmt::format("{:016x}", settings.source_hash)}};
    if (settings.epsilon)
        json["epsilon"] = *settings.epsilon;
    // A file name need not be UTF-8; JSON must be.
    const std::string text = json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
    return bytes_of(std::vector<char>(text.begin(), text.end()));
}

/// Takes sections apart; every message names the file and the section.
class SceneReader {
public:
    SceneReader(const std::filesystem::path& path, Sections&& sections)
        : path_(path), sections_(std::move(sections)) {}

    Scene scene() const {
        Scene scene;
        scene.mesh = mesh();
        scene.settings = settings();
        scene.transfer = transfer(scene.mesh);
        return scene;
    }

private:
    [[noreturn]] void fail(std::string_view section, std::string_view expected) const {
        throw std::runtime_error(
            fmt::format("{}: expected {}, got a damaged section '{}'", path_.string(), expected, section));
    }

    const std::vector<std::byte>& section(const std::string& name) const {
        const auto found = sections_.find(name);
        if (found == sections_.end())
            throw std::runtime_error(
                fmt::format("{}: expected a section '{}', got none", path_.string(), name));
        return found->second;
    }

    template<typename Element>
    std::vector<Element> elements(const std::string& name) const {
        const std::vector<std::byte>& bytes = section(name);
        if (bytes.size() % sizeof(Element) != 0)
            fail(name, fmt::format("a multiple of {} bytes", sizeof(Element)));
        std::vector<Element> result(bytes.size() / sizeof(Element));
        if (!result.empty())
            std::memcpy(result.data(), bytes.data(), bytes.size());
        return result;
    }

    template<typename Element>
    std::vector<Element> elements(const std::string& name, std::size_t count, bool optional = false) const {
        if (optional && !sections_.contains(name))
            return {};
        std::vector<Element> result = elements<Element>(name);
        if (result.size() != count)
            fail(name, fmt::format("{} elements", count));
        return result;
    }

    mesh::TriangleMesh mesh() const {
        mesh::TriangleMesh mesh;
        mesh.positions = elements<glm::vec3>("positions");
        mesh.triangles = elements<mesh::Triangle>("triangles");
        mesh.normals = elements<glm::vec3>("normals", mesh.num_vertices());
        mesh.colors = elements<glm::vec3>("colors", mesh.num_vertices(), true);
        mesh.uvs = elements<glm::vec2>("uvs", mesh.num_vertices(), true);
        for (const mesh::Triangle& triangle : mesh.triangles)
            if (std::any_of(triangle.begin(), triangle.end(),
                            [&](auto i) { return i >= mesh.num_vertices(); }))
                fail("triangles", "indices of vertices");
        const auto finite = [](const glm::vec3& p) {
            return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
        };
        if (!std::all_of(mesh.positions.begin(), mesh.positions.end(), finite))
            fail("positions", "finite positions");
        if (!std::all_of(mesh.normals.begin(), mesh.normals.end(), finite))
            fail("normals", "finite normals");
        if (!std::all_of(mesh.colors.begin(), mesh.colors.end(), finite))
            fail("colors", "finite colours");
        return mesh;
    }

    // The JSON library casts numbers without a look at the range.
    static std::uint32_t natural(const nlohmann::json& json) {
        if (!json.is_number_unsigned() ||
            json.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max())
            throw std::out_of_range("expected an integer of 32 bits");
        return json.get<std::uint32_t>();
    }
    static float real(const nlohmann::json& json) {
        if (!json.is_number() || !(std::abs(json.get<double>()) <= std::numeric_limits<float>::max()))
            throw std::out_of_range("expected a number");
        return json.get<float>();
    }

    SceneSettings settings() const {
        const std::vector<char> text = elements<char>("settings");
        SceneSettings settings;
        try {
            const nlohmann::json json = nlohmann::json::parse(text.begin(), text.end());
            settings.tolerance = real(json.at("tolerance"));
            settings.min_level = natural(json.at("min_level"));
            settings.face_resolution = natural(json.at("face_resolution"));
            settings.bias = real(json.at("bias"));
            settings.floor_vertices = natural(json.at("floor_vertices"));
            settings.source = json.at("source");
            settings.source_hash = std::stoull(json.at("source_hash").get<std::string>(), nullptr, 16);
            if (json.contains("epsilon"))
                settings.epsilon = real(json.at("epsilon"));
        } catch (const std::exception&) {
            fail("settings", "JSON with the settings");
        }
        return settings;
    }

    Quadtree quadtree() const {
        const std::vector<std::uint8_t> bytes = elements<std::uint8_t>("quadtree");
        std::uint32_t num_flags = 0;
        if (bytes.size() < sizeof num_flags)
            fail("quadtree", "split flags");
        std::memcpy(&num_flags, bytes.data(), sizeof num_flags);
        if (bytes.size() != sizeof num_flags + (std::size_t{num_flags} + 7) / 8)
            fail("quadtree", "split flags");
        std::vector<bool> flags(num_flags);
        for (std::size_t i = 0; i < flags.size(); ++i)
            flags[i] = (bytes[sizeof num_flags + i / 8] >> (i % 8) & 1) != 0;
        try {
            return Quadtree(flags);
        } catch (const std::invalid_argument&) {
            fail("quadtree", "split flags of six trees");
        }
    }

    Transfer transfer(const mesh::TriangleMesh& mesh) const {
        Transfer transfer;
        const std::size_t num_receivers = mesh.num_vertices();
        transfer.quadtree = quadtree();
        transfer.order = elements<std::uint32_t>("order", num_receivers);
        std::vector<bool> seen(num_receivers);
        for (const std::uint32_t receiver : transfer.order) {
            if (receiver >= num_receivers || seen[receiver])
                fail("order", "every receiver once");
            seen[receiver] = true;
            transfer.normals.push_back(mesh.normals[receiver]);
        }
        transfer.counts.num_receivers = num_receivers;
        transfer.counts.num_leaves = transfer.quadtree.num_leaves();
        transfer.counts.visible = elements<std::uint64_t>("visible");
        transfer.counts.mixed = elements<std::uint64_t>("mixed");
        transfer.counts.counts = elements<std::uint8_t>("counts");
        try {
            transfer.counts.index();
        } catch (const std::invalid_argument&) {
            fail("counts", "counts that fit the mesh and the tree");
        }
        return transfer;
    }

    const std::filesystem::path& path_;
    Sections sections_;
};

} // namespace

std::uint64_t save_scene(const std::filesystem::path& path, const Scene& scene) {
    if (scene.transfer.num_receivers() != scene.mesh.num_vertices() ||
        scene.mesh.normals.size() != scene.mesh.num_vertices())
        throw std::invalid_argument(fmt::format(
            "{}: expected one receiver and one normal per vertex, got {} and {} for {}", path.string(),
            scene.transfer.num_receivers(), scene.mesh.normals.size(), scene.mesh.num_vertices()));
    const VisibleCounts& counts = scene.transfer.counts;
    Sections sections;
    sections["settings"] = settings_json(scene.settings);
    sections["positions"] = bytes_of(scene.mesh.positions);
    sections["triangles"] = bytes_of(scene.mesh.triangles);
    sections["normals"] = bytes_of(scene.mesh.normals);
    if (!scene.mesh.colors.empty())
        sections["colors"] = bytes_of(scene.mesh.colors);
    if (!scene.mesh.uvs.empty())
        sections["uvs"] = bytes_of(scene.mesh.uvs);
    sections["order"] = bytes_of(scene.transfer.order);
    sections["quadtree"] = packed(scene.transfer.quadtree.split_flags());
    sections["visible"] = bytes_of(counts.visible);
    sections["mixed"] = bytes_of(counts.mixed);
    sections["counts"] = bytes_of(counts.counts);
    return write_sections(path, sections);
}

Scene load_scene(const std::filesystem::path& path) {
    return SceneReader(path, read_sections(path)).scene();
}

std::uint64_t file_hash(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = files::read(path);
    return XXH64(bytes.data(), bytes.size(), 0);
}

} // namespace relumine::prt
