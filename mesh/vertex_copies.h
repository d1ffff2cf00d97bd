// Copies of vertices, where the corners of triangles do not agree on the values of their vertex.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace relumine::mesh {

/// Deals out vertices to corners. The first corner of a vertex gets the vertex itself. A corner
/// that neither it nor a copy serves gets a new copy, which follows all vertices.
class VertexCopies {
public:
    explicit VertexCopies(std::size_t num_vertices)
        : newest_(num_vertices, None), older_(num_vertices, None) {}

    /// Returns the vertex or the copy of it for which serves(vertex) is true, or a new copy.
    ///
    /// Cost:    O(copies of the vertex), of which the newest 256 are asked: a vertex of more may
    /// get
    ///          two that serve the same corners.
    template<class Serves>
    [[nodiscard]] std::uint32_t find(std::uint32_t vertex, const Serves& serves) {
        constexpr int MostAsked = 256;
        std::uint32_t& newest = newest_[vertex];
        if (newest == None)
            return newest = vertex;
        int num_asked = 0;
        for (std::uint32_t copy = newest; copy != None && num_asked < MostAsked;
             copy = older_[copy], ++num_asked)
            if (serves(copy))
                return copy;
        const auto copy = static_cast<std::uint32_t>(num_vertices());
        older_.push_back(newest);
        originals_.push_back(vertex);
        return newest = copy;
    }

    /// Returns the number of vertices and copies.
    [[nodiscard]] std::size_t num_vertices() const { return older_.size(); }
    [[nodiscard]] std::size_t num_copies() const { return originals_.size(); }

    /// Repeats the values of vertices for their copies. An empty array stays empty.
    template<class Value>
    void append_to(std::vector<Value>& values) const {
        if (values.empty())
            return;
        values.reserve(num_vertices());
        for (const std::uint32_t original : originals_)
            values.push_back(values[original]);
    }

private:
    static constexpr std::uint32_t None = 0xffffffff;

    /// [vertices] the newest copy, or None before the first corner.
    std::vector<std::uint32_t> newest_;
    /// [vertices and copies] the copy before each, in the end the vertex itself.
    std::vector<std::uint32_t> older_;
    /// [copies] the vertex of each.
    std::vector<std::uint32_t> originals_;
};

} // namespace relumine::mesh
