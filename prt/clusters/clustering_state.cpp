#include "prt/clusters/clustering_state.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include "files/packed_parts.h"
#include "prt/transfer/cell_index.h"
#include "prt/transfer/visible_counts.h"

namespace relumine::prt {

namespace {

/// Words of a plane for a tile of VisibleCounts.
constexpr std::size_t TileWords = VisibleCounts::TileBlocks * BlockSize / 64;

Cell next_cell(files::ByteReader& reader) {
    const auto index = reader.next<std::uint32_t>();
    if (index >= num_cells_above(MaxLevel + 1))
        throw std::runtime_error("expected a cell of the cube");
    return cell_of_index(index);
}

void add_cells(files::ByteWriter& writer, const std::vector<Cell>& cells) {
    writer.add<std::uint64_t>(cells.size());
    for (const Cell& cell : cells)
        writer.add(cell_index(cell));
}

std::vector<Cell> next_cells(files::ByteReader& reader) {
    std::vector<Cell> cells;
    for (auto count = reader.next<std::uint64_t>(); count > 0; --count)
        cells.push_back(next_cell(reader));
    return cells;
}

} // namespace

std::vector<std::byte> clusters_record(std::span<const Cell> cells, const ColumnStore& columns,
                                       std::size_t first) {
    return files::pack(1 + columns.num_tiles(), [&](std::size_t part) {
        files::ByteWriter writer;
        for (std::size_t i = first; i < cells.size(); ++i) {
            if (part == 0) {
                writer.add(cell_index(cells[i]));
                continue;
            }
            const TileColumn column = columns.tile(i, part - 1);
            writer.add(column.visible);
            writer.add(column.mixed);
            writer.add_all(column.counts);
        }
        return writer.take();
    });
}

void read_clusters(std::span<const std::byte> record, std::vector<Cluster>& clusters) {
    const std::size_t first = clusters.size();
    bool is_first = true;
    files::unpack(record, [&](std::span<const std::byte> part) {
        files::ByteReader reader(part);
        if (std::exchange(is_first, false)) {
            while (!reader.at_end())
                clusters.push_back({.cell = next_cell(reader), .column = {}});
            return;
        }
        for (std::size_t i = first; i < clusters.size(); ++i) {
            LeafColumn& column = clusters[i].column;
            column.visible.push_back(reader.next<std::uint64_t>());
            column.mixed.push_back(reader.next<std::uint64_t>());
            const auto num_mixed = static_cast<std::size_t>(std::popcount(column.mixed.back()));
            const auto counts = reader.next_all<std::uint8_t>(num_mixed * BlockSize);
            column.counts.insert(column.counts.end(), counts.begin(), counts.end());
        }
    });
}

std::vector<std::byte> work_state(const std::vector<Cell>& batch, const PendingCells& pending,
                                  const VisibilityPlanes& planes) {
    const std::vector<LatticePoint> points = planes.points();
    const std::size_t num_tiles = (planes.num_words() + TileWords - 1) / TileWords;
    return files::pack(1 + num_tiles, [&](std::size_t part) {
        files::ByteWriter writer;
        if (part == 0) {
            add_cells(writer, batch);
            add_cells(writer, pending.cells());
            writer.add<std::uint64_t>(planes.num_directions());
            writer.add_all(std::span(points));
            return writer.take();
        }
        // The rays of all tiles stand in the first one of each process.
        writer.add<std::uint64_t>(part == 1 ? planes.num_rays() : 0);
        const std::size_t begin = (part - 1) * TileWords;
        const std::size_t size = std::min(TileWords, planes.num_words() - begin);
        for (const LatticePoint point : points)
            writer.add_all(std::span(planes.plane(point) + begin, size));
        return writer.take();
    });
}

void read_work(std::span<const std::byte> state, std::vector<Cell>& batch, PendingCells& pending,
               VisibilityPlanes& planes) {
    std::vector<LatticePoint> points;
    std::vector<std::vector<std::uint64_t>> words;
    std::uint64_t num_directions = 0, num_rays = 0;
    std::size_t num_words = 0;
    bool is_first = true;
    files::unpack(state, [&](std::span<const std::byte> part) {
        files::ByteReader reader(part);
        if (std::exchange(is_first, false)) {
            batch = next_cells(reader);
            for (const Cell& cell : next_cells(reader))
                pending.push(cell);
            num_directions = reader.next<std::uint64_t>();
            while (!reader.at_end())
                points.push_back(reader.next<LatticePoint>());
            words.resize(points.size());
            return;
        }
        num_rays += reader.next<std::uint64_t>();
        const std::size_t size =
            std::min(TileWords, planes.num_words() - std::min(num_words, planes.num_words()));
        num_words += size;
        for (std::vector<std::uint64_t>& plane : words) {
            const auto of_tile = reader.next_all<std::uint64_t>(size);
            plane.insert(plane.end(), of_tile.begin(), of_tile.end());
        }
    });
    if (is_first || num_words != planes.num_words())
        throw std::runtime_error("expected cells and all tiles of their planes");
    planes.restore_counts(num_directions, num_rays);
    for (std::size_t i = 0; i < points.size(); ++i)
        planes.restore(points[i], std::move(words[i]));
}

} // namespace relumine::prt
