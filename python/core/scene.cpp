// Meshes and precomputed scenes.
#include "scene.h"

#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "blockers.h"
#include "brdf.h"
#include "options.h"
#include "relumine/in/material_report.h"
#include "relumine/in/mesh_files.h"
#include "relumine/out/drawn_mesh.h"
#include "relumine/out/first_sight.h"
#include "run.h"

namespace relumine::python {

namespace {

using Path = std::filesystem::path;
using MeshPointer = std::shared_ptr<Mesh>;

/// The triangles of both meshes. Where the mesh has groups, the others are one of their own.
mesh::TriangleMesh together(mesh::TriangleMesh& mesh, const mesh::TriangleMesh& others) {
    mesh::TriangleMesh result;
    if (!mesh.groups.empty()) {
        result.triangle_groups = mesh.triangle_groups;
        result.triangle_groups.resize(mesh.num_triangles() + others.num_triangles(),
                                      static_cast<std::uint32_t>(mesh.groups.size()));
        mesh.groups.emplace_back("blockers");
        result.groups = mesh.groups;
    }
    result.positions = mesh.positions;
    result.positions.insert(result.positions.end(), others.positions.begin(),
                            others.positions.end());
    result.triangles = mesh.triangles;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const mesh::Triangle& triangle : others.triangles)
        result.triangles.push_back({triangle[0] + first, triangle[1] + first, triangle[2] + first});
    return result;
}

/// Other triangles that block the light: (vertices, triangles).
using OtherBlockers = std::optional<std::pair<py::buffer, py::buffer>>;
/// Names, and the index of each triangle's.
using Groups = std::optional<std::pair<std::vector<std::string>, py::buffer>>;

/// Optional arrays are None.
MeshPointer make_mesh(const py::buffer& vertices, const py::buffer& triangle_indices,
                      const py::object& normals, const py::object& colors, const py::object& uvs,
                      const OtherBlockers& blockers, const Groups& groups, const py::dict& given) {
    mesh::TriangleMesh geometry;
    geometry.positions = vec3s(vertices);
    geometry.triangles = triangles(triangle_indices);
    if (!normals.is_none())
        geometry.normals = vec3s(normals.cast<py::buffer>());
    if (!colors.is_none())
        geometry.colors = vec3s(colors.cast<py::buffer>());
    if (!uvs.is_none())
        geometry.uvs = vec2s(uvs.cast<py::buffer>());
    if (groups) {
        geometry.groups = groups->first;
        geometry.triangle_groups = uint32s(groups->second);
    }
    mesh::TriangleMesh others;
    if (blockers) {
        others.positions = vec3s(blockers->first);
        others.triangles = triangles(blockers->second);
    }
    const MeshOptions options = options_from<MeshOptions>(given);
    const Release release;
    if (geometry.normals.empty())
        geometry.normals = mesh::smooth_normals(geometry);
    mesh::turn_up(geometry, options.up.value_or(mesh::UpAxis::Y));
    auto result = std::make_shared<Mesh>(std::move(geometry));
    add_floor(*result, options);
    if (!others.triangles.empty()) {
        mesh::turn_up(others, options.up.value_or(mesh::UpAxis::Y));
        result->blockers = together(result->geometry, others);
    }
    return result;
}

MeshPointer loaded_mesh(const Path& path, const py::dict& given) {
    return in_background(py::none(),
                         [path, options = options_from<MeshOptions>(given)](const Reins&) {
                             return MeshPointer(std::make_shared<Mesh>(load_mesh(path, options)));
                         });
}

/// Returns the mesh and figures.
py::tuple refined_mesh(const MeshPointer& mesh, const py::dict& given, const py::object& progress) {
    using Result = std::pair<MeshPointer, RefineReport>;
    RefineOptions chosen;
    take(options_of(chosen), given);
    const Result result =
        in_background(progress, [mesh, options = std::move(chosen)](const Reins& reins) {
            Result found;
            found.first = std::make_shared<Mesh>(refined(*mesh, options, reins, &found.second));
            return found;
        });
    py::dict report;
    report["rounds"] = result.second.num_rounds;
    report["points"] = result.second.num_points;
    report["largest_error"] = result.second.largest_error;
    report["is_at_limit"] = result.second.is_at_limit;
    report["seconds"] = result.second.seconds;
    return py::make_tuple(result.first, std::move(report));
}

MeshPointer simplified_mesh(const MeshPointer& mesh, std::size_t num_vertices) {
    return in_background(py::none(), [mesh, num_vertices](const Reins&) {
        return MeshPointer(std::make_shared<Mesh>(simplified(*mesh, num_vertices)));
    });
}

py::dict report_of(const PrecomputeReport& report) {
    py::dict result;
    result["clusters"] = report.clusters.num_clusters;
    result["directions"] = report.clusters.num_directions;
    result["samples"] = report.clusters.num_samples;
    result["rays"] = report.clusters.num_rays;
    result["deepest_level"] = report.clusters.deepest_level;
    result["bias"] = report.bias;
    result["seconds_clustering"] = report.clusters.seconds;
    if (report.bounces) {
        py::dict bounces;
        bounces["rays"] = report.bounces->num_rays;
        bounces["emitters"] = report.bounces->num_emitters;
        bounces["closure"] = report.bounces->mean_closure;
        bounces["standard_error"] = report.bounces->rms_error;
        bounces["seconds"] = report.bounces->seconds;
        result["bounces"] = std::move(bounces);
    }
    result["highlights_left_out"] = report.num_highlights_left_out;
    result["file_bytes"] = report.file_bytes;
    return result;
}

/// Progress of all stages as one fraction.
std::function<void(Stage, double)> joined(const std::function<void(double)>& on_progress,
                                          const PrecomputeOptions& options) {
    const bool has_highlights = options.view.has_value();
    const int num_stages = 1 + static_cast<int>(has_highlights) +
                           static_cast<int>(options.bounce_tolerance.value_or(1.0f) > 0.0f);
    return [=](Stage stage, double fraction) {
        // Small parts of the whole.
        if (stage == Stage::Refinement || stage == Stage::Receivers)
            return;
        const int before = stage == Stage::Clusters     ? 0
                           : stage == Stage::Highlights ? 1
                                                        : num_stages - 1;
        on_progress(std::min(1.0, (before + fraction) / num_stages));
    };
}

/// Texts as --material has them, and tables with the names of their groups.
std::vector<SurfaceMaterial> materials_of(const py::object& given) {
    std::vector<SurfaceMaterial> result;
    for (const py::handle each : given) {
        std::vector<SurfaceMaterial> one;
        if (py::isinstance<py::tuple>(each)) {
            const auto [group, brdf] = each.cast<std::pair<std::string, std::shared_ptr<Brdf>>>();
            one.push_back({.group = group,
                           .highlight = prt::Highlight::Measured,
                           .table = brdf->table,
                           .file = {}});
        } else {
            py::dict text;
            text["material"] = each;
            take({material_row(one)}, text);
        }
        result.insert(result.end(), one.begin(), one.end());
    }
    return result;
}

/// The options of a precompute with the surfaces of a mesh. Receivers that are an array are points.
PrecomputeOptions work_options(const Mesh& mesh, const py::dict& all_given) {
    PrecomputeOptions options;
    const py::dict given(all_given.attr("copy")());
    if (const py::object receivers = given["receivers"]; py::isinstance<py::buffer>(receivers)) {
        options.receivers = Points{.positions = vec3s(receivers.cast<py::buffer>())};
        given.attr("pop")("receivers");
    }
    const std::vector<SurfaceMaterial> materials =
        materials_of(given.attr("pop")("material", py::list()));
    std::string output;
    OptionTable table = options_of(options);
    table.push_back(row("--output", output, "the .prt file to write"));
    take(table, given);
    check(options);
    options.output = output;
    set_materials(options, materials, mesh.geometry);
    return options;
}

struct Precomputed {
    /// Null: only planned
    std::shared_ptr<Scene> scene;
    PrecomputeReport report;
    std::vector<std::string> warnings;
};

/// Calls `compute(options, work, found)` in the background. Names the option that asks for too
/// much.
template<typename Compute>
Precomputed worked(const py::object& progress, PrecomputeOptions options, Compute compute) {
    return in_background(progress, [options = std::move(options), compute](const Reins& reins) {
        Precomputed found;
        const PrecomputeWork work{.stop = reins.stop,
                                  .on_progress = joined(reins.on_progress, options),
                                  .on_warning = [&](Warning, const std::string& text) {
                                      found.warnings.push_back(text);
                                  }};
        try {
            compute(options, work, found);
            if (reins.on_progress)
                reins.on_progress(1.0);
        } catch (const TooMuchWork& error) {
            throw std::invalid_argument(
                (error.cause == TooMuchWork::Cause::MinLevel ? "min_depth: " : "tolerance: ") +
                std::string(error.what()));
        }
        return found;
    });
}

/// Returns the scene, figures and warnings.
py::tuple precomputed(const MeshPointer& mesh, const py::dict& given, const py::object& blocked,
                      const py::object& progress) {
    PrecomputeOptions all = work_options(*mesh, given);
    const std::shared_ptr<const prt::Blockers> blockers = blockers_of(blocked);
    all.blockers = blockers.get();
    // The work owns the blockers.
    const Precomputed result =
        worked(progress, std::move(all),
               [mesh, blockers](const PrecomputeOptions& options, const PrecomputeWork& work,
                                Precomputed& found) {
                   found.scene =
                       std::make_shared<Scene>(precompute(*mesh, options, work, &found.report));
               });
    return py::make_tuple(result.scene, report_of(result.report), result.warnings);
}

/// Returns figures and warnings.
py::tuple planned(const MeshPointer& mesh, const py::dict& given, const py::object& progress) {
    const Precomputed result =
        worked(progress, work_options(*mesh, given),
               [mesh](const PrecomputeOptions& options, const PrecomputeWork& work,
                      Precomputed& found) { plan(*mesh, options, work, &found.report); });
    return py::make_tuple(report_of(result.report), result.warnings);
}

void do_part(const Path& plan_path, std::uint32_t index, std::uint32_t count, const Path& output,
             const py::object& progress) {
    const PartOptions options{
        .plan = plan_path, .part = {.index = index, .count = count}, .output = output};
    in_background(progress, [options](const Reins& reins) {
        precompute_part(options,
                        {.stop = reins.stop, .on_progress = [&reins](Stage stage, double fraction) {
                             if (stage == Stage::Clusters)
                                 reins.on_progress(fraction);
                         }});
        return true;
    });
}

std::shared_ptr<Scene> load_prt(const Path& path) {
    return in_background(py::none(), [path](const Reins&) {
        return std::shared_ptr<Scene>(std::make_shared<Scene>(load_scene(path)));
    });
}

/// Returns another scene, and figures.
py::tuple moved(const std::shared_ptr<Scene>& scene, const py::dict& moves,
                const py::object& progress) {
    using Result = std::pair<std::shared_ptr<Scene>, MoveReport>;
    const Result result =
        in_background(progress, [scene, to = group_moves(moves)](const Reins& reins) {
            Result found{std::make_shared<Scene>(*scene), {}};
            move(*found.first, to, move_work(reins), &found.second);
            return found;
        });
    return py::make_tuple(result.first, move_figures(result.second));
}

std::size_t fresh_clusters_of(const std::shared_ptr<Scene>& scene, const py::object& progress) {
    return in_background(progress,
                         [scene](const Reins& reins) { return fresh_clusters(*scene, reins); });
}

std::shared_ptr<Scene> recoloured(const std::shared_ptr<Scene>& scene, const py::dict& given) {
    const auto colors = options_from<SurfaceColors>(given);
    const Release release;
    auto result = std::make_shared<Scene>(*scene);
    set_colors(*result, colors);
    return result;
}

py::dict settings_of(const Scene& scene) {
    py::dict result;
    result["tolerance"] = rms_tolerance(scene);
    result["min_depth"] = scene.settings.min_level;
    result["face_resolution"] = scene.settings.face_resolution;
    result["bias"] = scene.settings.bias;
    result["floor"] = scene.settings.floor_vertices;
    result["source"] = scene.settings.source;
    result["receivers"] = prt::description(scene.layout);
    result["bounces"] = scene.bounces.has_value();
    return result;
}

/// Calls `bind(name, member)` for the arrays of a mesh.
template<typename Class, typename Geometry>
void bind_mesh_arrays(Class& type, Geometry geometry) {
    using Pointer = typename Class::holder_type;
    type.def_property_readonly("offset", [=](const Pointer& own) {
        const glm::dvec3& offset = geometry(*own).offset;
        return std::array<double, 3>{offset.x, offset.y, offset.z};
    });
    type.def_property_readonly(
        "vertices", [=](const Pointer& own) { return view(own, geometry(*own).positions); });
    type.def_property_readonly("triangles", [=](const Pointer& own) {
        return view(own, std::span<const mesh::Triangle>(geometry(*own).triangles));
    });
    type.def_property_readonly(
        "normals", [=](const Pointer& own) { return view(own, geometry(*own).normals); });
    type.def_property_readonly(
        "colors", [=](const Pointer& own) { return view(own, geometry(*own).colors); });
    type.def_property_readonly("uvs", [=](const Pointer& own) {
        return view(own, std::span<const glm::vec2>(geometry(*own).uvs));
    });
    type.def_property_readonly("materials", [=](const Pointer& own) {
        files::Json materials = files::Json::Array{};
        for (const mesh::Material& material : geometry(*own).materials)
            materials.push_back(relumine::report_of(geometry(*own), material));
        return materials.text();
    });
    type.def_property_readonly("groups", [=](const Pointer& own) { return geometry(*own).groups; });
}

} // namespace

GroupMove group_move(const std::string& name, const py::object& to) {
    if (py::isinstance<py::str>(to))
        return {.name = name,
                .going = to.cast<std::string>() == "away" ? Going::Away : Going::Back};
    if (py::isinstance<Mesh>(to))
        return pose_of(name, to.cast<const Mesh&>().geometry);
    GroupMove result{.name = name};
    const std::vector<double> numbers = doubles(to.cast<py::buffer>());
    for (int i = 0; i < 16; ++i)
        result.matrix[i % 4][i / 4] = numbers.at(static_cast<std::size_t>(i));
    return result;
}

std::vector<GroupMove> group_moves(const py::dict& moves) {
    std::vector<GroupMove> result;
    for (const auto& [name, to] : moves)
        result.push_back(
            group_move(name.cast<std::string>(), py::reinterpret_borrow<py::object>(to)));
    return result;
}

py::dict move_figures(const MoveReport& report) {
    py::dict result;
    result["receivers"] = report.num_moved;
    result["pairs"] = report.counts.num_pairs;
    result["pairs_changed"] = report.counts.num_changed;
    result["pairs_all"] = report.num_all;
    result["rays"] = report.counts.num_rays;
    result["leaves_box"] = report.leaves_box;
    result["seconds_bounces"] = report.seconds_bounces;
    result["seconds"] = report.seconds;
    return result;
}

void bind_scenes(py::module_& module) {
    py::class_<Mesh, std::shared_ptr<Mesh>> mesh_type(module, "Mesh");
    bind_mesh_arrays(mesh_type, [](const Mesh& mesh) -> const auto& { return mesh.geometry; });
    mesh_type.def_readonly("source", &Mesh::source)
        .def_readonly("source_hash", &Mesh::source_hash)
        .def_readonly("floor", &Mesh::floor_vertices)
        .def_property_readonly("warnings",
                               [](const Mesh& mesh) { return mesh::left_out(mesh.geometry); })
        .def_property_readonly("notes", [](const Mesh& mesh) { return mesh.geometry.notes; });

    py::class_<Scene, std::shared_ptr<Scene>> scene_type(module, "Scene");
    bind_mesh_arrays(scene_type, [](const Scene& scene) -> const auto& { return scene.mesh; });
    scene_type
        .def_property_readonly("num_receivers",
                               [](const Scene& scene) { return scene.receivers.size(); })
        .def_property_readonly("num_clusters",
                               [](const Scene& scene) { return scene.transfer.num_clusters(); })
        .def_property_readonly("receiver_positions",
                               [](const std::shared_ptr<Scene>& scene) {
                                   return view(scene, scene->receivers.places());
                               })
        .def_property_readonly("receiver_origins",
                               [](const std::shared_ptr<Scene>& scene) {
                                   return view(scene, scene->receivers.positions);
                               })
        .def_property_readonly("receiver_normals",
                               [](const std::shared_ptr<Scene>& scene) {
                                   return view(scene, scene->receivers.normals);
                               })
        .def_property_readonly("places",
                               [](const std::shared_ptr<Scene>& scene) {
                                   const auto places = prt::places(scene->layout);
                                   return owned(std::vector(places.begin(), places.end()));
                               })
        .def_property_readonly("settings", &settings_of)
        .def("nearest_receiver", [](const Scene& scene, const std::array<double, 3>& p) {
            return nearest_receiver(scene, place_in(scene.mesh, {p[0], p[1], p[2]}));
        });

    module.def("make_mesh", &make_mesh);
    module.def("load_mesh", &loaded_mesh);
    module.def("refined", &refined_mesh);
    module.def("simplified", &simplified_mesh);
    module.def("precompute", &precomputed);
    module.def("plan", &planned);
    module.def("precompute_part", &do_part);
    module.def("join", [](const std::vector<Path>& parts, const Path& output) {
        return in_background(py::none(),
                             [parts, output](const Reins&) { return join(parts, output); });
    });
    module.def("load_scene", &load_prt);
    module.def("save_mesh", [](const Path& path, const std::shared_ptr<Mesh>& mesh) {
        const Release release;
        return mesh::save(path, mesh->geometry);
    });
    module.def("save_mesh", [](const Path& path, const std::shared_ptr<Scene>& scene) {
        const Release release;
        return mesh::save(path, drawn_mesh(*scene));
    });
    module.def("save_scene", [](const Path& path, const std::shared_ptr<Scene>& scene) {
        return in_background(py::none(),
                             [path, scene](const Reins&) { return save_scene(path, *scene); });
    });
    module.def("unclustered_scene", [](const MeshPointer& mesh) {
        const Release release;
        return std::make_shared<Scene>(unclustered_scene(*mesh));
    });
    module.def("quick_scene", [](const MeshPointer& mesh) {
        const Release release;
        return std::make_shared<Scene>(quick_scene(*mesh));
    });
    module.def("recoloured", &recoloured);
    module.def("moved", &moved);
    module.def("fresh_clusters", &fresh_clusters_of);
}

} // namespace relumine::python
