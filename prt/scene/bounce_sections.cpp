#include "prt/scene/bounce_sections.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "files/large_vector.h"
#include "files/parallel.h"
#include "prt/scene/small_numbers.h"

namespace relumine::prt {

namespace {

const std::string Radius = "bounce_radius", Weights = "bounce_weights",
                  EmitterSizes = "bounce_hits_size", Emitters = "bounce_hits",
                  AveragedSizes = "bounce_near_size", Averaged = "bounce_near",
                  OpenParts = "bounce_open", Distances = "bounce_distance",
                  HitCounts = "bounce_rays_hit", Looks = "bounce_looks", Rays = "bounce_rays",
                  Errors = "bounce_errors", PointRays = "point_rays", PointHits = "point_hits";

void add_lists(NewSections& sections, const std::string& size_name, const std::string& name,
               const PlaceLists& lists) {
    std::vector<std::uint32_t> sizes;
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = 0; i < lists.size(); ++i) {
        sizes.push_back(static_cast<std::uint32_t>(lists[i].size()));
        std::uint32_t before = 0;
        for (const std::uint32_t place : lists[i]) {
            append_small(bytes, place - before);
            before = place;
        }
    }
    sections[size_name] = bytes_of(sizes);
    sections[name] = bytes_of(bytes);
}

PlaceLists read_lists(const SectionReader& reader, const std::string& size_name,
                      const std::string& name, std::size_t num_lists, std::size_t num_receivers) {
    PlaceLists lists;
    const auto sizes = reader.elements<std::uint32_t>(size_name, num_lists);
    const std::vector<std::byte> bytes = reader.bytes(name);
    lists.begin.reserve(num_lists + 1);
    std::uint64_t num_places = 0;
    for (const std::uint32_t size : sizes)
        lists.begin.push_back(num_places += size);
    // Each place takes a byte at least, so a size that lies allocates nothing.
    if (num_places > bytes.size())
        reader.fail(size_name, "as many receivers as there are");
    const NumberPieces pieces(bytes);
    if (pieces.num_numbers() != num_places || !pieces.are_whole())
        reader.fail(name, "an end after the last list");
    lists.places = files::large_vector<std::uint32_t>(num_places);
    // Each piece has the lists that begin in it.
    const auto first_list = [&](std::uint64_t number) {
        return static_cast<std::size_t>(
            std::lower_bound(lists.begin.begin(), lists.begin.end() - 1, number) -
            lists.begin.begin());
    };
    files::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t piece) {
        NumberPieces::Place at = pieces.begin(piece);
        const std::size_t end = first_list(pieces.begin(piece + 1).number);
        std::size_t list = first_list(at.number);
        if (list < end)
            pieces.skip(lists.begin[list] - at.number, at);
        for (; list < end; ++list)
            for (std::uint32_t place = 0; at.number < lists.begin[list + 1];) {
                std::uint32_t& read = lists.places[at.number];
                const std::optional<std::uint64_t> step = pieces.next(at);
                if (!step || *step >= num_receivers - place)
                    reader.fail(name, "numbers of receivers");
                read = place += static_cast<std::uint32_t>(*step);
            }
    });
    return lists;
}

/// Reads lists of places that come piece by piece, as add_lists() writes them, and calls
/// on_place(list, place) for each.
template<typename OnPlace>
void stream_lists(const SectionReader& reader, std::span<const std::uint32_t> sizes,
                  std::size_t num_receivers, const OnPlace& on_place) {
    std::size_t list = 0;
    std::uint32_t num_left = sizes.empty() ? 0 : sizes[0];
    std::uint64_t place = 0, number = 0;
    std::uint32_t shift = 0;
    const auto skip_empty = [&] {
        while (list < sizes.size() && num_left == 0) {
            place = 0;
            if (++list < sizes.size())
                num_left = sizes[list];
        }
    };
    reader.stream(Emitters, std::nullopt, [&](std::span<const std::byte> piece) {
        for (const std::byte byte : piece) {
            const auto bits = std::to_integer<std::uint64_t>(byte);
            number |= (bits & 0x7fu) << shift;
            shift += 7;
            if (bits >= 0x80u && shift < 35)
                continue;
            skip_empty();
            place += number;
            if (bits >= 0x80u || list == sizes.size() || place >= num_receivers)
                reader.fail(Emitters, "lists of receivers");
            on_place(list, static_cast<std::uint32_t>(place));
            --num_left;
            number = 0;
            shift = 0;
        }
    });
    skip_empty();
    if (list != sizes.size() || shift != 0)
        reader.fail(Emitters, "an end after the last list");
}

void add_points(NewSections& sections, const PointRows& points) {
    if (points.num_directions == 0)
        return;
    sections[PointRays] = bytes_of(std::vector{points.num_directions});
    sections[PointHits] = SectionContent::view(points.emitters);
}

PointRows read_points(const SectionReader& reader, std::size_t num_points) {
    PointRows points;
    if (num_points == 0)
        return points;
    points.num_directions = reader.elements<std::uint32_t>(PointRays, 1).front();
    if (points.num_directions == 0)
        reader.fail(PointRays, "a number of rays above 0");
    points.emitters = reader.elements<std::uint32_t>(PointHits, num_points * points.num_directions);
    return points;
}

BounceRays read_bounce_rays(const SectionReader& reader, const BounceMatrix& matrix) {
    if (!reader.has(Looks))
        return {};
    const std::size_t n = matrix.num_rows();
    BounceRays rays{.num_directions = reader.elements<std::uint32_t>(Looks, n),
                    .num_hits = reader.elements<std::uint32_t>(HitCounts, n),
                    .distances = reader.elements<float>(Distances, n)};
    for (std::size_t i = 0; i < n; ++i)
        if (rays.num_directions[i] > MostBounceDirections ||
            rays.num_hits[i] > rays.num_directions[i] ||
            matrix.emitters[i].size() > rays.num_hits[i] || !(rays.distances[i] >= 0.0f))
            reader.fail(Looks, "rays that fit the rows");
    return rays;
}

} // namespace

void add_bounce_sections(NewSections& sections, const BounceMatrix& matrix) {
    sections[Radius] = bytes_of(std::vector{matrix.spectral_radius});
    sections[Weights] = SectionContent::view(matrix.weights);
    add_lists(sections, EmitterSizes, Emitters, matrix.emitters);
    add_lists(sections, AveragedSizes, Averaged, matrix.averaged);
    add_points(sections, matrix.points);
    if (matrix.rays.num_directions.empty())
        return;
    sections[Looks] = SectionContent::view(matrix.rays.num_directions);
    sections[HitCounts] = SectionContent::view(matrix.rays.num_hits);
    sections[Distances] = SectionContent::view(matrix.rays.distances);
}

bool has_bounces(const SectionReader& reader) {
    return reader.has(Weights);
}

std::optional<BounceMatrix> read_bounces(const SectionReader& reader, const Receivers& receivers) {
    if (!has_bounces(reader))
        return std::nullopt;
    const std::size_t num_receivers = receivers.size();
    BounceMatrix matrix;
    matrix.spectral_radius = reader.elements<float>(Radius, 1).front();
    matrix.weights = reader.elements<float>(Weights, num_receivers);
    matrix.emitters = read_lists(reader, EmitterSizes, Emitters, num_receivers, num_receivers);
    matrix.averaged = read_lists(reader, AveragedSizes, Averaged, num_receivers, num_receivers);
    matrix.points = read_points(reader, receivers.num_points());
    matrix.rays = read_bounce_rays(reader, matrix);
    return matrix;
}

BounceRows read_bounce_rows(const SectionReader& reader, const Receivers& receivers,
                            const Part& part) {
    const std::size_t num_receivers = receivers.size();
    BounceRows rows;
    BounceMatrix& matrix = rows.matrix;
    matrix.spectral_radius = reader.elements<float>(Radius, 1).front();
    matrix.weights = reader.elements<float>(Weights, num_receivers);
    matrix.averaged = read_lists(reader, AveragedSizes, Averaged, num_receivers, num_receivers);
    rows.num_emitters = reader.elements<std::uint32_t>(EmitterSizes, num_receivers);
    matrix.points = read_points(reader, receivers.num_points());
    try {
        require_points(matrix.points, num_receivers);
        require_rows(matrix, rows.num_emitters);
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", reader.path().string(), error.what()));
    }
    // Which rows are the process's depends on the lowest place.
    std::size_t lowest = num_receivers;
    stream_lists(reader, rows.num_emitters, num_receivers, [&](std::size_t, std::uint32_t place) {
        lowest = std::min(lowest, std::size_t{place});
    });
    rows.first = lowest == num_receivers ? 0 : first_emitter(lowest, matrix.averaged);
    std::uint64_t num_places = 0;
    for (std::size_t row = 0; row < num_receivers; ++row) {
        num_places += has_row(part, row, rows.first) ? rows.num_emitters[row] : 0;
        matrix.emitters.begin.push_back(num_places);
    }
    matrix.emitters.places.reserve(static_cast<std::size_t>(num_places));
    stream_lists(reader, rows.num_emitters, num_receivers,
                 [&](std::size_t row, std::uint32_t place) {
                     if (has_row(part, row, rows.first))
                         matrix.emitters.places.push_back(place);
                 });
    return rows;
}

void add_bounce_samples(NewSections& sections, const BounceSamples& samples) {
    sections[OpenParts] = SectionContent::view(samples.open_parts);
    sections[Distances] = SectionContent::view(samples.distances);
    sections[HitCounts] = SectionContent::view(samples.num_hits);
    sections[Rays] = bytes_of(std::vector{samples.num_rays});
    sections[Errors] = bytes_of(std::vector{samples.squared_errors});
    add_lists(sections, EmitterSizes, Emitters, samples.emitters);
    if (samples.averaged)
        add_lists(sections, AveragedSizes, Averaged, *samples.averaged);
    add_points(sections, samples.points);
}

std::optional<BounceSamples> read_bounce_samples(const SectionReader& reader, std::size_t num_own,
                                                 std::size_t num_own_points,
                                                 std::size_t num_receivers) {
    if (!reader.has(OpenParts))
        return std::nullopt;
    BounceSamples samples;
    samples.open_parts = reader.elements<float>(OpenParts, num_own);
    samples.distances = reader.elements<float>(Distances, num_own);
    samples.num_hits = reader.elements<std::uint32_t>(HitCounts, num_own);
    samples.num_rays = reader.elements<std::uint64_t>(Rays, 1).front();
    samples.squared_errors = reader.elements<double>(Errors, 1).front();
    samples.emitters = read_lists(reader, EmitterSizes, Emitters, num_own, num_receivers);
    if (reader.has(Averaged))
        samples.averaged = read_lists(reader, AveragedSizes, Averaged, num_own, num_receivers);
    samples.points = read_points(reader, num_own_points);
    for (std::size_t i = 0; i < num_own; ++i)
        if (!(samples.distances[i] >= 0.0f && std::isfinite(samples.open_parts[i])) ||
            samples.emitters[i].size() > samples.num_hits[i])
            reader.fail(HitCounts, "samples that fit each other");
    return samples;
}

namespace {

void check_bounces(const SceneCheck& check, const Scene& scene) {
    const bool is_plan = scene.transfer.counts.num_receivers == 0;
    check.that(scene.bounces || scene.receivers.num_added == 0 || is_plan,
               "bounces that come from the added vertices", "none");
    if (!scene.bounces)
        return;
    try {
        require_bounces(*scene.bounces, scene.transfer.num_receivers());
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", check.path().string(), error.what()));
    }
    check_emitters(check, scene, *scene.bounces);
}

} // namespace

void check_emitters(const SceneCheck& check, const Scene& scene, const BounceMatrix& matrix) {
    if (on_vertices(scene.layout))
        return;
    for (const std::vector<std::uint32_t>* places :
         {&matrix.emitters.places, &matrix.points.emitters})
        for (const std::uint32_t place : *places)
            if (place != NoEmitter && scene.transfer.order[place] < scene.receivers.num_own())
                check.fail("light that comes from vertices",
                           fmt::format("some from {} {}", kind_of(scene.layout).one,
                                       scene.transfer.order[place]));
}

const SectionGroup BounceSections = {
    .add =
        [](NewSections& sections, const Scene& scene) {
            if (scene.bounces)
                add_bounce_sections(sections, *scene.bounces);
        },
    .read = [](const SectionReader& reader,
               Scene& scene) { scene.bounces = read_bounces(reader, scene.receivers); },
    .check = check_bounces};

} // namespace relumine::prt
