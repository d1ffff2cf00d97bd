#include "mesh/half_edge/split_mesh.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include <glm/geometric.hpp>

#include "mesh/edge_uses.h"

namespace relumine::mesh {

namespace {

/// Half of each: the sum of the largest floats would be infinite.
template<typename Value>
Value half_way(const Value& a, const Value& b) {
    return 0.5f * a + 0.5f * b;
}

glm::vec3 vector_between(const glm::vec3& a, const glm::vec3& b) {
    const glm::vec3 middle = half_way(a, b);
    // A shorter sum is the rounding of normals that cancel.
    constexpr float Shortest = 1e-4f;
    return glm::length(middle) > Shortest ? middle : a;
}

/// Mixes the bits of a key (the end of SplitMix64).
std::uint64_t mixed(std::uint64_t key) {
    key = (key ^ key >> 30u) * 0xbf58476d1ce4e5b9u;
    key = (key ^ key >> 27u) * 0x94d049bb133111ebu;
    return key ^ key >> 31u;
}

constexpr std::uint64_t EmptyKey = ~std::uint64_t{0};

} // namespace

std::size_t SplitMesh::Table::find(std::uint64_t key) const {
    std::size_t at = mixed(key) & (keys_.size() - 1);
    while (keys_[at] != EmptyKey && keys_[at] != key)
        at = (at + 1) & (keys_.size() - 1);
    return at;
}

void SplitMesh::Table::grow() {
    const std::vector<std::uint64_t> keys = std::exchange(keys_, {});
    const std::vector<std::uint32_t> values = std::exchange(values_, {});
    const std::size_t size = std::max<std::size_t>(1024, 2 * keys.size());
    keys_.assign(size, EmptyKey);
    values_.assign(size, None);
    for (std::size_t i = 0; i < keys.size(); ++i)
        if (keys[i] != EmptyKey) {
            const std::size_t at = find(keys[i]);
            keys_[at] = keys[i];
            values_[at] = values[i];
        }
}

std::uint32_t& SplitMesh::Table::slot(std::uint32_t low, std::uint32_t high) {
    if (3 * num_used_ >= 2 * keys_.size())
        grow();
    const std::uint64_t key = std::uint64_t{low} << 32u | high;
    const std::size_t at = find(key);
    if (keys_[at] == EmptyKey) {
        keys_[at] = key;
        ++num_used_;
    }
    return values_[at];
}

SplitMesh::SplitMesh(TriangleMesh mesh)
    : mesh_(std::move(mesh)), vectors_(mesh_.normals), places_(first_at_place(mesh_.positions)),
      triangle_edges_(mesh_.num_triangles()), next_side_(3 * mesh_.num_triangles(), None) {
    origins_.reserve(mesh_.num_triangles());
    for (std::uint32_t i = 0; i < mesh_.num_triangles(); ++i) {
        add_sides(i);
        origins_.push_back({i, {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0, 1)}});
    }
    changed_.resize(mesh_.num_triangles());
    std::iota(changed_.begin(), changed_.end(), 0u);
}

std::uint32_t SplitMesh::edge_between(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t low = std::min(places_[a], places_[b]);
    const std::uint32_t high = std::max(places_[a], places_[b]);
    std::uint32_t& slot = table_.slot(low, high);
    if (slot == None) {
        if (edges_.size() >= None)
            throw std::invalid_argument("expected fewer than 2^32 edges");
        slot = static_cast<std::uint32_t>(edges_.size());
        edges_.push_back(
            {.low = low,
             .high = high,
             .length = static_cast<float>(glm::distance(glm::dvec3(mesh_.positions[low]),
                                                        glm::dvec3(mesh_.positions[high])))});
    }
    return slot;
}

void SplitMesh::add_sides(std::uint32_t triangle) {
    for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t edge =
            edge_between(mesh_.triangles[triangle][k], mesh_.triangles[triangle][(k + 1) % 3]);
        triangle_edges_[triangle][k] = edge;
        next_side_[3 * std::size_t{triangle} + k] =
            std::exchange(edges_[edge].first_side, 3 * triangle + k);
    }
}

void SplitMesh::remove_sides(std::uint32_t triangle) {
    for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t side = 3 * triangle + k;
        std::uint32_t* at = &edges_[triangle_edges_[triangle][k]].first_side;
        while (*at != side)
            at = &next_side_[*at];
        *at = next_side_[side];
    }
}

double SplitMesh::area_beside(std::uint32_t edge) const {
    double area = 0.0;
    for (std::uint32_t side = edges_[edge].first_side; side != None; side = next_side_[side])
        area += 0.5 * glm::length(area_normal(mesh_.positions, mesh_.triangles[side / 3]));
    return area;
}

std::uint32_t SplitMesh::longest_side(std::uint32_t triangle) const {
    const std::array<std::uint32_t, 3>& of_triangle = triangle_edges_[triangle];
    std::uint32_t best = 0;
    for (std::uint32_t k = 1; k < 3; ++k) {
        const float difference = edges_[of_triangle[k]].length - edges_[of_triangle[best]].length;
        if (difference > 0.0f || (difference == 0.0f && of_triangle[k] < of_triangle[best]))
            best = k;
    }
    return best;
}

void SplitMesh::append_ends(std::uint32_t edge, std::vector<Ends>& ends) const {
    const std::size_t first = ends.size();
    for (std::uint32_t side = edges_[edge].first_side; side != None; side = next_side_[side]) {
        const Triangle& triangle = mesh_.triangles[side / 3];
        Ends pair{triangle[side % 3], triangle[(side % 3 + 1) % 3], side / 3, true};
        if (places_[pair.low] != edges_[edge].low ||
            (edges_[edge].low == edges_[edge].high && pair.low > pair.high))
            std::swap(pair.low, pair.high);
        const auto known = std::find_if(
            ends.begin() + static_cast<std::ptrdiff_t>(first), ends.end(),
            [&](const Ends& other) { return other.low == pair.low && other.high == pair.high; });
        if (known == ends.end())
            ends.push_back(pair);
        else
            known->is_rim = false;
    }
}

bool SplitMesh::mark(std::uint32_t edge, std::size_t most) {
    if (edges_[edge].is_marked)
        return true;
    const std::size_t num_before = marked_.size(), num_vertices_before = num_marked_;
    std::vector<std::uint32_t> open = {edge};
    std::vector<Ends> ends;
    edges_[edge].is_marked = true;
    while (!open.empty()) {
        const std::uint32_t next = open.back();
        open.pop_back();
        marked_.push_back(next);
        ends.clear();
        append_ends(next, ends);
        num_marked_ += ends.size();
        for (std::uint32_t side = edges_[next].first_side; side != None; side = next_side_[side]) {
            const std::uint32_t longest = triangle_edges_[side / 3][longest_side(side / 3)];
            if (!edges_[longest].is_marked) {
                edges_[longest].is_marked = true;
                open.push_back(longest);
            }
        }
        if (num_marked_ > most) {
            for (const std::uint32_t other : open)
                edges_[other].is_marked = false;
            for (std::size_t i = num_before; i < marked_.size(); ++i)
                edges_[marked_[i]].is_marked = false;
            marked_.resize(num_before);
            num_marked_ = num_vertices_before;
            return false;
        }
    }
    return true;
}

void SplitMesh::add_middles(std::uint32_t edge) {
    std::vector<Ends> ends;
    append_ends(edge, ends);
    const auto place = static_cast<std::uint32_t>(mesh_.num_vertices());
    for (const Ends& pair : ends) {
        const auto vertex = static_cast<std::uint32_t>(mesh_.num_vertices());
        const auto add = [&](auto& values) {
            if (!values.empty())
                values.push_back(half_way(values[pair.low], values[pair.high]));
        };
        add(mesh_.positions);
        add(mesh_.colors);
        add(mesh_.uvs);
        add(mesh_.second_uvs);
        if (!mesh_.normals.empty()) {
            vectors_.push_back(vector_between(vectors_[pair.low], vectors_[pair.high]));
            const float length = glm::length(vectors_.back());
            mesh_.normals.push_back(length > 0.0f ? vectors_.back() / length : vectors_.back());
        }
        places_.push_back(place);
        middles_.push_back({pair.low, pair.high, vertex, edges_[edge].first_middle});
        edges_[edge].first_middle = static_cast<std::uint32_t>(middles_.size() - 1);
    }
}

std::uint32_t SplitMesh::middle(std::uint32_t edge, std::uint32_t a, std::uint32_t b) const {
    std::uint32_t at = edges_[edge].first_middle;
    while ((middles_[at].low != a || middles_[at].high != b) &&
           (middles_[at].low != b || middles_[at].high != a))
        at = middles_[at].next;
    return middles_[at].vertex;
}

/// The triangle becomes the half at the side's first corner a; returns the half at its second, b.
///
///        c               a m c and m b c
///      /   \                                       .
///     a  m  b
std::uint32_t SplitMesh::cut_in_two(std::uint32_t triangle, std::uint32_t side) {
    const std::uint32_t i = side, j = (side + 1) % 3, k = (side + 2) % 3;
    const Triangle old = mesh_.triangles[triangle];
    const std::uint32_t a = old[i], b = old[j], c = old[k];
    const std::uint32_t m = middle(triangle_edges_[triangle][side], a, b);
    const auto other = static_cast<std::uint32_t>(mesh_.num_triangles());
    remove_sides(triangle);
    mesh_.triangles[triangle] = {a, m, c};
    mesh_.triangles.push_back({m, b, c});
    const auto cut_corners = [&](auto& values) {
        if (values.empty())
            return;
        const auto corners = values[triangle];
        const auto between = half_way(corners[i], corners[j]);
        values[triangle] = {corners[i], between, corners[k]};
        values.push_back({between, corners[j], corners[k]});
    };
    cut_corners(mesh_.corner_uvs);
    cut_corners(mesh_.corner_tangents);
    if (!mesh_.triangle_materials.empty())
        mesh_.triangle_materials.push_back(mesh_.triangle_materials[triangle]);
    if (!mesh_.triangle_groups.empty())
        mesh_.triangle_groups.push_back(mesh_.triangle_groups[triangle]);
    const Origin origin = origins_[triangle];
    const glm::vec2 at = half_way(origin.corners[i], origin.corners[j]);
    origins_[triangle].corners = {origin.corners[i], at, origin.corners[k]};
    origins_.push_back({origin.triangle, {at, origin.corners[j], origin.corners[k]}});
    triangle_edges_.emplace_back();
    next_side_.resize(3 * mesh_.num_triangles(), None);
    add_sides(triangle);
    add_sides(other);
    changed_.push_back(other);
    return other;
}

void SplitMesh::cut(std::uint32_t triangle) {
    changed_.push_back(triangle);
    const std::uint32_t second = cut_in_two(triangle, longest_side(triangle));
    // The sides to the corner across: the last of the first half, the middle of the second.
    if (edges_[triangle_edges_[triangle][2]].is_marked)
        cut_in_two(triangle, 2);
    if (edges_[triangle_edges_[second][1]].is_marked)
        cut_in_two(second, 1);
}

void SplitMesh::split() {
    if (mesh_.num_vertices() + num_marked_ >= None)
        throw std::invalid_argument("expected fewer than 2^32 vertices");
    std::sort(marked_.begin(), marked_.end());
    middles_.clear();
    std::vector<std::uint32_t> triangles;
    for (const std::uint32_t edge : marked_) {
        add_middles(edge);
        for (std::uint32_t side = edges_[edge].first_side; side != None; side = next_side_[side])
            triangles.push_back(side / 3);
    }
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
    changed_.clear();
    for (const std::uint32_t triangle : triangles)
        cut(triangle);
    for (const std::uint32_t edge : marked_) {
        edges_[edge].is_split = true;
        edges_[edge].is_marked = false;
        edges_[edge].first_middle = None;
    }
    marked_.clear();
    num_marked_ = 0;
}

} // namespace relumine::mesh
