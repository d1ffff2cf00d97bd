#include "prt/parts/shared_work.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "files/packed_parts.h"

namespace relumine::prt {

namespace {

template<typename Element>
void add_array(files::ByteWriter& writer, const std::vector<Element>& elements) {
    writer.add<std::uint64_t>(elements.size());
    writer.add_all(std::span(elements));
}

template<typename Element>
void take_array(files::ByteReader& reader, std::vector<Element>& elements) {
    elements = reader.next_all<Element>(static_cast<std::size_t>(reader.next<std::uint64_t>()));
}

/// So many bytes of an array are sent at a time: a process has no more of it twice.
constexpr std::size_t PieceBytes = std::size_t{1} << 25;

/// Gives the first process, whose own light is lights[0], an array of each process. The others lose
/// theirs.
template<typename Access>
void gather_array(Team& team, std::vector<PartLight>& lights, const Access& array_of) {
    auto& own = array_of(lights[0]);
    using Element = typename std::remove_reference_t<decltype(own)>::value_type;
    const bool is_first = team.part().index == 0;
    const std::uint64_t size = own.size();
    const std::vector<std::vector<std::byte>> sizes = team.gather(to_send(std::span(&size, 1)));
    for (std::size_t i = 1; i < sizes.size(); ++i) {
        std::uint64_t of_other = 0;
        std::memcpy(&of_other, sizes[i].data(), sizeof of_other);
        array_of(lights[i]).clear();
        array_of(lights[i]).reserve(static_cast<std::size_t>(of_other));
    }
    constexpr std::size_t PieceSize = PieceBytes / sizeof(Element);
    std::array<std::int64_t, 1> num_pieces = {
        static_cast<std::int64_t>((own.size() + PieceSize - 1) / PieceSize)};
    team.max(num_pieces);
    for (std::size_t piece = 0; piece < static_cast<std::size_t>(num_pieces[0]); ++piece) {
        const std::size_t begin = std::min(piece * PieceSize, own.size());
        const std::span<const Element> rest = std::span(std::as_const(own)).subspan(begin);
        const std::vector<std::vector<std::byte>> of_all =
            team.gather(is_first ? std::vector<std::byte>()
                                 : to_send(rest.first(std::min(PieceSize, rest.size()))));
        for (std::size_t i = 1; i < of_all.size(); ++i) {
            auto& array = array_of(lights[i]);
            const std::size_t before = array.size();
            array.resize(before + of_all[i].size() / sizeof(Element));
            if (!of_all[i].empty())
                std::memcpy(array.data() + before, of_all[i].data(), of_all[i].size());
        }
    }
    if (!is_first)
        own = {};
}

template<typename Access>
void gather_lists(Team& team, std::vector<PartLight>& lights, const Access& lists_of) {
    gather_array(
        team, lights, [&](PartLight & light) -> auto& { return lists_of(light).begin; });
    gather_array(
        team, lights, [&](PartLight & light) -> auto& { return lists_of(light).places; });
}

/// Gives the first process what is no array. What it has, all have: a process without receivers has
/// empty arrays.
void gather_head(Team& team, std::vector<PartLight>& lights) {
    PartLight& own = lights[0];
    const std::array<std::byte, 3> has = {
        std::byte{own.glossy.has_value()}, std::byte{own.bounces.has_value()},
        std::byte{own.bounces && own.bounces->averaged.has_value()}};
    const std::vector<std::byte> first = team.broadcast({has.begin(), has.end()});
    if (first[0] != std::byte{0} && !own.glossy)
        own.glossy.emplace();
    if (first[1] != std::byte{0} && !own.bounces)
        own.bounces.emplace();
    if (first[2] != std::byte{0} && !own.bounces->averaged)
        own.bounces->averaged.emplace();
    files::ByteWriter writer;
    writer.add<std::uint64_t>(own.counts.num_receivers);
    writer.add<std::uint64_t>(own.counts.num_leaves);
    writer.add<std::uint64_t>(own.bounces ? own.bounces->num_rays : 0);
    writer.add(own.bounces ? own.bounces->squared_errors : 0.0);
    const std::vector<std::vector<std::byte>> heads = team.gather(writer.take());
    for (std::size_t i = 1; i < heads.size(); ++i) {
        files::ByteReader reader(heads[i]);
        PartLight& light = lights[i];
        light.counts.num_receivers = static_cast<std::size_t>(reader.next<std::uint64_t>());
        light.counts.num_leaves = static_cast<std::size_t>(reader.next<std::uint64_t>());
        if (own.glossy)
            light.glossy.emplace();
        if (!own.bounces)
            continue;
        BounceSamples& samples = light.bounces.emplace();
        samples.num_rays = reader.next<std::uint64_t>();
        samples.squared_errors = reader.next<double>();
        if (own.bounces->averaged)
            samples.averaged.emplace();
    }
}

} // namespace

std::vector<std::byte> packed_work(const SharedWork& work) {
    files::ByteWriter writer;
    add_array(writer, work.mesh.positions);
    add_array(writer, work.mesh.triangles);
    add_array(writer, work.mesh.normals);
    writer.add<std::uint8_t>(work.blockers ? 1 : 0);
    if (work.blockers) {
        add_array(writer, work.blockers->positions);
        add_array(writer, work.blockers->triangles);
    }
    add_array(writer, work.receivers.positions);
    add_array(writer, work.receivers.normals);
    add_array(writer, work.receivers.to_eye);
    add_array(writer, work.receivers.surfaces);
    add_array(writer, work.receivers.points);
    writer.add<std::uint64_t>(work.receivers.num_added);
    writer.add(work.clusters.tolerance);
    writer.add(work.clusters.epsilon.value_or(-1.0f));
    writer.add(work.clusters.min_level);
    writer.add(work.clusters.face_resolution);
    writer.add(work.clusters.bias);
    writer.add(work.clusters.plane_bytes);
    writer.add(work.highlights ? work.highlights->tolerance : 0.0f);
    writer.add(work.bounces ? work.bounces->tolerance : 0.0f);
    writer.add<std::uint8_t>(work.bounces && work.bounces->two_sided ? 1 : 0);
    writer.add<std::uint8_t>(work.has_beams ? 1 : 0);
    writer.add<std::uint8_t>(work.has_checkpoint ? 1 : 0);
    return writer.take();
}

SharedWork unpacked_work(std::span<const std::byte> bytes) {
    files::ByteReader reader(bytes);
    SharedWork work;
    take_array(reader, work.mesh.positions);
    take_array(reader, work.mesh.triangles);
    take_array(reader, work.mesh.normals);
    if (reader.next<std::uint8_t>() != 0) {
        mesh::TriangleMesh& blockers = work.blockers.emplace();
        take_array(reader, blockers.positions);
        take_array(reader, blockers.triangles);
    }
    take_array(reader, work.receivers.positions);
    take_array(reader, work.receivers.normals);
    take_array(reader, work.receivers.to_eye);
    take_array(reader, work.receivers.surfaces);
    take_array(reader, work.receivers.points);
    work.receivers.num_added = static_cast<std::size_t>(reader.next<std::uint64_t>());
    work.clusters.tolerance = reader.next<float>();
    if (const auto epsilon = reader.next<float>(); epsilon >= 0.0f)
        work.clusters.epsilon = epsilon;
    work.clusters.min_level = reader.next<std::uint32_t>();
    work.clusters.face_resolution = reader.next<std::uint32_t>();
    work.clusters.bias = reader.next<float>();
    work.clusters.plane_bytes = reader.next<std::uint64_t>();
    if (const auto tolerance = reader.next<float>(); tolerance != 0.0f)
        work.highlights = {.tolerance = tolerance,
                           .face_resolution = work.clusters.face_resolution,
                           .bias = work.clusters.bias};
    const auto bounce_tolerance = reader.next<float>();
    const bool is_two_sided = reader.next<std::uint8_t>() != 0;
    if (bounce_tolerance != 0.0f)
        work.bounces = {
            .tolerance = bounce_tolerance, .two_sided = is_two_sided, .bias = work.clusters.bias};
    work.has_beams = reader.next<std::uint8_t>() != 0;
    work.has_checkpoint = reader.next<std::uint8_t>() != 0;
    return work;
}

std::vector<PartLight> gather_light(Team& team, PartLight&& own) {
    const bool is_first = team.part().index == 0;
    std::vector<PartLight> lights(is_first ? team.part().count : 1);
    lights[0] = std::move(own);
    gather_head(team, lights);
    gather_array(
        team, lights, [](PartLight & light) -> auto& { return light.counts.visible; });
    gather_array(
        team, lights, [](PartLight & light) -> auto& { return light.counts.mixed; });
    gather_array(
        team, lights, [](PartLight & light) -> auto& { return light.counts.counts; });
    if (lights[0].glossy)
        for (std::size_t lobe = 0; lobe < NumGlossyLobes; ++lobe) {
            const auto gather = [&](const auto member) {
                gather_array(
                    team, lights, [&](PartLight & light) -> auto& {
                        return light.glossy->lobes[lobe].*member;
                    });
            };
            gather(&LobeCuts::begin);
            gather(&LobeCuts::cells);
            gather(&LobeCuts::scales);
            gather(&LobeCuts::values);
        }
    if (lights[0].bounces) {
        const auto gather = [&](const auto member) {
            gather_array(
                team, lights, [&](PartLight & light) -> auto& { return (*light.bounces).*member; });
        };
        gather(&BounceSamples::open_parts);
        gather(&BounceSamples::distances);
        gather(&BounceSamples::num_hits);
        gather_lists(
            team, lights, [](PartLight & light) -> auto& { return light.bounces->emitters; });
        if (lights[0].bounces->averaged)
            gather_lists(
                team, lights, [](PartLight & light) -> auto& { return *light.bounces->averaged; });
    }
    if (!is_first)
        return {};
    for (PartLight& light : std::span(lights).subspan(1))
        light.counts.index();
    return lights;
}

} // namespace relumine::prt
