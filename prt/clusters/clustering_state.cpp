#include "prt/clusters/clustering_state.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include "files/packed_parts.h"
#include "prt/transfer/cell_index.h"

namespace relumine::prt {

namespace {

/// Columns and planes of some 100 kB to some MB go into one part: large enough for a thread, and
/// small beside the whole.
constexpr std::size_t ColumnsPerPart = 16;
constexpr std::size_t PlanesPerPart = 16;

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
    const std::size_t num_parts = (cells.size() - first + ColumnsPerPart - 1) / ColumnsPerPart;
    return files::pack(num_parts, [&](std::size_t part) {
        const std::size_t begin = first + part * ColumnsPerPart;
        files::ByteWriter writer;
        for (std::size_t i = begin; i < std::min(begin + ColumnsPerPart, cells.size()); ++i) {
            const LeafColumn column = columns.column(i);
            writer.add(cell_index(cells[i]));
            writer.add_all(std::span(column.visible));
            writer.add_all(std::span(column.mixed));
            writer.add_all(std::span(column.counts));
        }
        return writer.take();
    });
}

void read_clusters(std::span<const std::byte> record, std::size_t num_receivers,
                   std::vector<Cluster>& clusters) {
    const std::size_t num_blocks = (num_receivers + BlockSize - 1) / BlockSize;
    const std::size_t num_words = (num_blocks + 63) / 64;
    files::unpack(record, [&](std::span<const std::byte> part) {
        files::ByteReader reader(part);
        while (!reader.at_end()) {
            Cluster cluster{.cell = next_cell(reader), .column = {}};
            LeafColumn& column = cluster.column;
            column.visible = reader.next_all<std::uint64_t>(num_words);
            column.mixed = reader.next_all<std::uint64_t>(num_words);
            std::size_t num_mixed = 0;
            for (const std::uint64_t word : column.mixed)
                num_mixed += static_cast<std::size_t>(std::popcount(word));
            column.counts = reader.next_all<std::uint8_t>(num_mixed * BlockSize);
            clusters.push_back(std::move(cluster));
        }
    });
}

std::vector<std::byte> work_state(const std::vector<Cell>& batch, const PendingCells& pending,
                                  const VisibilityPlanes& planes) {
    const std::vector<LatticePoint> points = planes.points();
    const std::size_t num_parts = 1 + (points.size() + PlanesPerPart - 1) / PlanesPerPart;
    return files::pack(num_parts, [&](std::size_t part) {
        files::ByteWriter writer;
        if (part == 0) {
            add_cells(writer, batch);
            add_cells(writer, pending.cells());
            writer.add<std::uint64_t>(planes.num_directions());
            writer.add<std::uint64_t>(planes.num_rays());
            return writer.take();
        }
        const std::size_t begin = (part - 1) * PlanesPerPart;
        for (std::size_t i = begin; i < std::min(begin + PlanesPerPart, points.size()); ++i) {
            writer.add(points[i]);
            writer.add_all(std::span(planes.plane(points[i]), planes.num_words()));
        }
        return writer.take();
    });
}

void read_work(std::span<const std::byte> state, std::vector<Cell>& batch, PendingCells& pending,
               VisibilityPlanes& planes) {
    bool is_first = true;
    files::unpack(state, [&](std::span<const std::byte> part) {
        files::ByteReader reader(part);
        if (std::exchange(is_first, false)) {
            batch = next_cells(reader);
            for (const Cell& cell : next_cells(reader))
                pending.push(cell);
            const auto num_directions = reader.next<std::uint64_t>();
            planes.restore_counts(num_directions, reader.next<std::uint64_t>());
            return;
        }
        while (!reader.at_end()) {
            const auto point = reader.next<LatticePoint>();
            planes.restore(point, reader.next_all<std::uint64_t>(planes.num_words()));
        }
    });
    if (is_first)
        throw std::runtime_error("expected cells");
}

} // namespace relumine::prt
