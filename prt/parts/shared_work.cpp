#include "prt/parts/shared_work.h"

#include <cstdint>

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

void add_lists(files::ByteWriter& writer, const PlaceLists& lists) {
    add_array(writer, lists.begin);
    add_array(writer, lists.places);
}

void take_lists(files::ByteReader& reader, PlaceLists& lists) {
    take_array(reader, lists.begin);
    take_array(reader, lists.places);
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

std::vector<std::byte> packed_light(const PartLight& light) {
    files::ByteWriter writer;
    writer.add<std::uint64_t>(light.counts.num_receivers);
    writer.add<std::uint64_t>(light.counts.num_leaves);
    add_array(writer, light.counts.visible);
    add_array(writer, light.counts.mixed);
    add_array(writer, light.counts.counts);
    writer.add<std::uint8_t>(light.glossy ? 1 : 0);
    if (light.glossy)
        for (const LobeCuts& lobe : light.glossy->lobes) {
            add_array(writer, lobe.begin);
            add_array(writer, lobe.cells);
            add_array(writer, lobe.scales);
            add_array(writer, lobe.values);
        }
    writer.add<std::uint8_t>(light.bounces ? 1 : 0);
    if (light.bounces) {
        const BounceSamples& samples = *light.bounces;
        add_array(writer, samples.open_parts);
        add_array(writer, samples.distances);
        add_array(writer, samples.num_hits);
        add_lists(writer, samples.emitters);
        writer.add<std::uint8_t>(samples.averaged ? 1 : 0);
        if (samples.averaged)
            add_lists(writer, *samples.averaged);
        writer.add(samples.num_rays);
        writer.add(samples.squared_errors);
    }
    return writer.take();
}

PartLight unpacked_light(std::span<const std::byte> bytes) {
    files::ByteReader reader(bytes);
    PartLight light;
    light.counts.num_receivers = static_cast<std::size_t>(reader.next<std::uint64_t>());
    light.counts.num_leaves = static_cast<std::size_t>(reader.next<std::uint64_t>());
    take_array(reader, light.counts.visible);
    take_array(reader, light.counts.mixed);
    take_array(reader, light.counts.counts);
    light.counts.index();
    if (reader.next<std::uint8_t>() != 0)
        for (LobeCuts& lobe : light.glossy.emplace().lobes) {
            take_array(reader, lobe.begin);
            take_array(reader, lobe.cells);
            take_array(reader, lobe.scales);
            take_array(reader, lobe.values);
        }
    if (reader.next<std::uint8_t>() != 0) {
        BounceSamples& samples = light.bounces.emplace();
        take_array(reader, samples.open_parts);
        take_array(reader, samples.distances);
        take_array(reader, samples.num_hits);
        take_lists(reader, samples.emitters);
        if (reader.next<std::uint8_t>() != 0)
            take_lists(reader, samples.averaged.emplace());
        samples.num_rays = reader.next<std::uint64_t>();
        samples.squared_errors = reader.next<double>();
    }
    return light;
}

} // namespace relumine::prt
