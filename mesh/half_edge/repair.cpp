#include "mesh/half_edge/repair.h"

#include <algorithm>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "mesh/edge_uses.h"
#include "mesh/half_edge/diagnosis.h"
#include "mesh/half_edge/half_edge_mesh.h"
#include "mesh/half_edge/winding.h"
#include "mesh/normals.h"

namespace relumine::mesh {

namespace {

/// One repair, step by step.
class Repair {
public:
    Repair(const TriangleMesh& mesh, const RepairOptions& options)
        : mesh_(mesh), options_(options), is_touched_(mesh.num_vertices()) {}

    TriangleMesh run(RepairReport& report) {
        if (options_.weld)
            report.num_welded = weld();
        drop(report);
        report.num_turned = turn();
        if (options_.fill_holes > 0) {
            fill_holes(report);
            report.num_turned += turn(); // what is closed now faces outwards
        }
        renew_normals();
        return std::move(mesh_);
    }

private:
    void touch(const Triangle& triangle) {
        for (const std::uint32_t vertex : triangle)
            is_touched_[vertex] = true;
    }

    std::size_t weld() {
        std::vector<std::uint32_t> first = first_at_place(mesh_.positions);
        const std::size_t n = mesh_.num_vertices();
        // Colours and second uvs tell vertices apart. The first of each at a place stands for the
        // others.
        if (!mesh_.colors.empty() || !mesh_.second_uvs.empty()) {
            std::vector<std::vector<std::uint32_t>> at_place(n);
            for (std::uint32_t i = 0; i < n; ++i) {
                std::vector<std::uint32_t>& others = at_place[first[i]];
                const auto same = std::find_if(others.begin(), others.end(), [&](std::uint32_t j) {
                    return (mesh_.colors.empty() || mesh_.colors[j] == mesh_.colors[i]) &&
                           (mesh_.second_uvs.empty() || mesh_.second_uvs[j] == mesh_.second_uvs[i]);
                });
                first[i] = same != others.end() ? *same : i;
                if (same == others.end())
                    others.push_back(i);
            }
        }
        std::vector<bool> stays(n);
        bool uvs_differ = false;
        for (std::uint32_t i = 0; i < n; ++i) {
            stays[i] = first[i] == i;
            uvs_differ = uvs_differ || (!mesh_.uvs.empty() && mesh_.uvs[i] != mesh_.uvs[first[i]]);
            if (first[i] != i && !mesh_.normals.empty() &&
                mesh_.normals[i] != mesh_.normals[first[i]])
                is_touched_[first[i]] = true;
        }
        if (uvs_differ) {
            for (const auto& [a, b, c] : mesh_.triangles)
                mesh_.corner_uvs.push_back({mesh_.uvs[a], mesh_.uvs[b], mesh_.uvs[c]});
            mesh_.uvs.clear();
        }
        mesh_.triangles = renamed(mesh_.triangles, first);
        return drop_vertices(stays);
    }

    /// Returns how many go.
    std::size_t drop_vertices(const std::vector<bool>& stays) {
        std::vector<std::uint32_t> places(stays.size());
        std::uint32_t place = 0;
        for (std::size_t i = 0; i < stays.size(); ++i) {
            places[i] = place;
            place += stays[i] ? 1 : 0;
        }
        const auto keep = [&](auto& values) {
            if (values.empty())
                return;
            for (std::size_t i = 0; i < stays.size(); ++i)
                if (stays[i])
                    values[places[i]] = values[i];
            values.resize(place);
        };
        for_each_vertex_array(mesh_, keep);
        keep(is_touched_);
        mesh_.triangles = renamed(mesh_.triangles, places);
        return stays.size() - place;
    }

    static Triangle sorted(Triangle triangle) {
        std::sort(triangle.begin(), triangle.end());
        return triangle;
    }

    /// Returns the sides of an edge's triangles.
    static std::span<const EdgeUse> sides_of(std::span<const EdgeUse> uses, std::uint32_t a,
                                             std::uint32_t b) {
        const EdgeUse edge{.low = std::min(a, b), .high = std::max(a, b)};
        const auto [begin, end] = std::equal_range(
            uses.begin(), uses.end(), edge, [](const EdgeUse& x, const EdgeUse& y) {
                return std::pair(x.low, x.high) < std::pair(y.low, y.high);
            });
        return {begin, end};
    }

    /// Returns the triangles that share three vertices, set by set.
    [[nodiscard]] std::vector<std::vector<std::uint32_t>>
    triangles_alike(std::span<const std::uint32_t> duplicates,
                    std::span<const EdgeUse> uses) const {
        std::map<Triangle, std::vector<std::uint32_t>> sets;
        for (const std::uint32_t i : duplicates) {
            const Triangle key = sorted(mesh_.triangles[i]);
            std::vector<std::uint32_t>& set = sets[key];
            if (!set.empty())
                continue;
            for (const EdgeUse& use : sides_of(uses, key[0], key[1]))
                if (sorted(mesh_.triangles[use.triangle()]) == key)
                    set.push_back(use.triangle());
            std::sort(set.begin(), set.end());
        }
        std::vector<std::vector<std::uint32_t>> result;
        result.reserve(sets.size());
        for (auto& [key, set] : sets)
            result.push_back(std::move(set));
        return result;
    }

    /// Whether triangles of the same vertices cancel: as many are wound one way as the other, and
    /// beside each edge there are triangles of two other sets, or none.
    [[nodiscard]] bool is_fold(std::span<const std::uint32_t> alike,
                               std::span<const EdgeUse> uses) const {
        if (alike.empty())
            return false;
        const Triangle key = sorted(mesh_.triangles[alike.front()]);
        std::ptrdiff_t num_ascending = 0;
        bool goes_on = false;
        for (std::size_t k = 0; k < 3; ++k) {
            std::vector<Triangle> others;
            for (const EdgeUse& use : sides_of(uses, key[k], key[(k + 1) % 3])) {
                const Triangle other = sorted(mesh_.triangles[use.triangle()]);
                if (other != key)
                    others.push_back(other);
                else if (k == 0)
                    num_ascending += use.ascends ? 1 : 0;
            }
            if (others.empty())
                continue;
            if (std::all_of(others.begin(), others.end(),
                            [&](const Triangle& other) { return other == others.front(); }))
                return false;
            goes_on = true;
        }
        return goes_on && 2 * num_ascending == static_cast<std::ptrdiff_t>(alike.size());
    }

    void drop(RepairReport& report) {
        std::vector<bool> goes(mesh_.num_triangles());
        const Diagnosis diagnosis = diagnose(mesh_);
        for (const std::uint32_t i : diagnosis.zero_area)
            goes[i] = true;
        report.num_zero_area = diagnosis.zero_area.size();
        const std::vector<EdgeUse> uses = edge_uses(mesh_.triangles);
        for (const std::vector<std::uint32_t>& alike : triangles_alike(diagnosis.duplicates, uses))
            for (std::size_t i = is_fold(alike, uses) ? 0 : 1; i < alike.size(); ++i)
                if (!goes[alike[i]]) {
                    goes[alike[i]] = true;
                    ++report.num_duplicates;
                    touch(mesh_.triangles[alike[i]]);
                }
        if (report.num_zero_area + report.num_duplicates == mesh_.num_triangles())
            throw std::runtime_error("expected triangles with an area, got none");
        const auto keep = [&](auto& values) {
            if (values.empty())
                return;
            std::size_t place = 0;
            for (std::size_t i = 0; i < goes.size(); ++i)
                if (!goes[i])
                    values[place++] = values[i];
            values.resize(place);
        };
        keep(mesh_.triangles);
        keep(mesh_.corner_uvs);
        keep(mesh_.corner_tangents);
        keep(mesh_.triangle_materials);
        keep(mesh_.triangle_groups);
    }

    std::size_t turn() {
        const Winding winding = find_winding(mesh_);
        for (std::size_t i = 0; i < mesh_.num_triangles(); ++i)
            if (winding.is_wrong[i]) {
                turn_triangle(mesh_, static_cast<std::uint32_t>(i));
                if (!mesh_.corner_tangents.empty())
                    for (glm::vec4& tangent : mesh_.corner_tangents[i])
                        tangent.w = -tangent.w;
                touch(mesh_.triangles[i]);
            }
        return winding.num_wrong;
    }

    void fill_holes(RepairReport& report) {
        const auto rims = HalfEdgeMesh(mesh_, HalfEdgeMesh::Cuts::Shape).rims();
        for (const auto& rim : rims) {
            if (rim.size() > options_.fill_holes)
                continue;
            for (const HalfEdgeMesh::RimCorner& corner : rim)
                if (corner.is_cut)
                    throw std::runtime_error(fmt::format(
                        "expected holes whose rims the surface meets once, got one of {} edges at "
                        "vertex {} that it meets twice; a smaller --fill-holes leaves it open",
                        rim.size(), corner.vertex));
        }
        // The rim of a sheet is no hole: the lid would be as large as the sheet.
        constexpr double LargestLid = 0.5;
        const std::vector<std::uint32_t> first = first_at_place(mesh_.positions);
        DisjointSets parts(mesh_.num_vertices());
        for (const auto& [a, b, c] : mesh_.triangles) {
            parts.join(first[a], first[b]);
            parts.join(first[a], first[c]);
        }
        std::vector<double> areas(mesh_.num_vertices());
        for (const Triangle& triangle : mesh_.triangles)
            areas[parts.first(first[triangle[0]])] +=
                glm::length(area_normal(mesh_.positions, triangle));
        for (const auto& rim : rims) {
            if (rim.size() < 3 || rim.size() > options_.fill_holes)
                continue;
            const std::vector<std::array<std::size_t, 3>> lid = lid_of(rim);
            double area = 0.0, least = std::numeric_limits<double>::max();
            for (const auto& [i, m, k] : lid) {
                const double of_triangle = glm::length(
                    area_normal(mesh_.positions, {rim[i].vertex, rim[m].vertex, rim[k].vertex}));
                area += of_triangle;
                least = std::min(least, of_triangle);
            }
            if (least == 0.0 || area > LargestLid * areas[parts.first(first[rim[0].vertex])])
                continue;
            for (const auto& [i, m, k] : lid)
                add_triangle({rim[i], rim[m], rim[k]});
            ++report.num_filled;
            report.num_new_triangles += lid.size();
        }
    }

    /// Returns the triangles of least area that fill a rim, by dynamic programming.
    [[nodiscard]] std::vector<std::array<std::size_t, 3>>
    lid_of(const std::vector<HalfEdgeMesh::RimCorner>& rim) const {
        const std::size_t n = rim.size();
        std::vector<double> least(n * n, 0.0);
        std::vector<std::uint32_t> middle(n * n, 0);
        for (std::size_t width = 2; width < n; ++width)
            for (std::size_t i = 0; i + width < n; ++i) {
                const std::size_t k = i + width;
                double& best = least[i * n + k];
                best = std::numeric_limits<double>::max();
                for (std::size_t m = i + 1; m < k; ++m) {
                    const double area =
                        least[i * n + m] + least[m * n + k] +
                        glm::length(area_normal(mesh_.positions,
                                                {rim[i].vertex, rim[m].vertex, rim[k].vertex}));
                    if (area < best) {
                        best = area;
                        middle[i * n + k] = static_cast<std::uint32_t>(m);
                    }
                }
            }
        std::vector<std::array<std::size_t, 3>> lid;
        std::vector<std::pair<std::size_t, std::size_t>> open = {{0, n - 1}};
        while (!open.empty()) {
            const auto [i, k] = open.back();
            open.pop_back();
            if (k - i < 2)
                continue;
            const std::size_t m = middle[i * n + k];
            lid.push_back({i, m, k});
            open.emplace_back(i, m);
            open.emplace_back(m, k);
        }
        return lid;
    }

    /// Material and group are those of the triangle beside the first corner.
    void add_triangle(const std::array<HalfEdgeMesh::RimCorner, 3>& corners) {
        mesh_.triangles.push_back({corners[0].vertex, corners[1].vertex, corners[2].vertex});
        touch(mesh_.triangles.back());
        const auto add = [&](auto& values) {
            if (values.empty())
                return;
            auto own = values[corners[0].triangle];
            for (std::size_t k = 0; k < 3; ++k)
                own[k] = values[corners[k].triangle][corners[k].corner];
            values.push_back(own);
        };
        add(mesh_.corner_uvs);
        add(mesh_.corner_tangents);
        if (!mesh_.triangle_materials.empty())
            mesh_.triangle_materials.push_back(mesh_.triangle_materials[corners[0].triangle]);
        if (!mesh_.triangle_groups.empty())
            mesh_.triangle_groups.push_back(mesh_.triangle_groups[corners[0].triangle]);
    }

    void renew_normals() {
        if (mesh_.normals.empty())
            return;
        const std::vector<glm::vec3> smooth = smooth_normals(mesh_);
        for (std::size_t i = 0; i < mesh_.num_vertices(); ++i)
            if (is_touched_[i])
                mesh_.normals[i] = smooth[i];
    }

    TriangleMesh mesh_;
    const RepairOptions& options_;
    /// [num_vertices] vertices whose normals are out of date.
    std::vector<bool> is_touched_;
};

} // namespace

TriangleMesh repair(const TriangleMesh& mesh, const RepairOptions& options, RepairReport* report) {
    if (options.fill_holes > LongestRim)
        throw std::invalid_argument(fmt::format("expected rims of at most {} edges to fill, got {}",
                                                LongestRim, options.fill_holes));
    RepairReport local;
    TriangleMesh result = Repair(mesh, options).run(local);
    if (report != nullptr)
        *report = local;
    return result;
}

} // namespace relumine::mesh
