// `relumine mesh`: meshes as they are lit.
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/commands.h"
#include "app/options/output_options.h"
#include "app/options/refine_options.h"
#include "files/counted.h"
#include "relumine/in/mesh_files.h"

namespace relumine::app {

namespace {

/// What all of them read and write.
struct MeshFiles {
    std::string input;
    std::string output;
    std::optional<float> crease;

    void add_to(Command& command) {
        command.add(row("MESH", input, "mesh: " + mesh::mesh_extensions(),
                        {.file = true, .required = true}));
        command.add(row("-o,--output", output, "the mesh file to write, .ply, .glb or .obj",
                        {.file = true, .required = true}));
        command.add(crease_row(crease));
    }

    void check() const {
        require_extension("--output", output, {".ply", ".glb", ".obj"});
        check_output(output, {input});
    }

    [[nodiscard]] mesh::TriangleMesh load(const Session& session) const {
        mesh::TriangleMesh mesh = mesh::load(input);
        for (const std::string& warning : mesh.warnings)
            session.warn(fmt::format("{}: {}", input, warning));
        for (const std::string& note : mesh.notes)
            session.say(fmt::format("{}: {}", input, note));
        return mesh;
    }

    [[nodiscard]] mesh::TriangleMesh creased(mesh::TriangleMesh mesh) const {
        return crease ? mesh::with_creases(mesh, *crease) : std::move(mesh);
    }

    void save(const mesh::TriangleMesh& mesh, const Session& session) const {
        for (const std::string& what : mesh::save(output, mesh))
            session.warn(fmt::format("{}: left out: {}", output, what));
        session.say(fmt::format("{}: {} vertices, {}", output, mesh.num_vertices(),
                                files::counted(mesh.num_triangles(), "triangle")));
        session.add_to_report("vertices", mesh.num_vertices());
        session.add_to_report("triangles", mesh.num_triangles());
    }
};

struct RepairCommand {
    MeshFiles files;
    mesh::RepairOptions options;

    void run(const Session& session) const {
        files.check();
        const mesh::TriangleMesh mesh = files.load(session);
        mesh::RepairReport found;
        mesh::TriangleMesh result;
        try {
            result = mesh::repair(mesh, options, &found);
        } catch (const std::runtime_error& error) {
            throw std::runtime_error(fmt::format("{}: {}", files.input, error.what()));
        }
        const auto say = [&](std::size_t number, const char* what) {
            if (number != 0)
                session.say(fmt::format("{} {}", number, what));
        };
        say(found.num_welded, "vertices welded to others at their place");
        say(found.num_zero_area, "triangles without an area dropped");
        say(found.num_duplicates, "triangles dropped that were there twice");
        say(found.num_turned, "triangles turned");
        if (found.num_filled != 0)
            session.say(fmt::format("{} holes closed with {} triangles", found.num_filled,
                                    found.num_new_triangles));
        if (found.is_nothing())
            session.say("nothing to repair");
        files.save(files.creased(std::move(result)), session);
        session.report({{"welded", found.num_welded},
                        {"zero_area", found.num_zero_area},
                        {"duplicates", found.num_duplicates},
                        {"turned", found.num_turned},
                        {"filled", found.num_filled},
                        {"new_triangles", found.num_new_triangles}});
    }
};

void add_repair(Command& group, Session& session) {
    Command command =
        group.add_command("repair", "wind a mesh outwards, drop triangles that are void or double");
    auto work = std::make_shared<RepairCommand>();
    work->files.add_to(command);
    command.add(row("--weld", work->options.weld, "vertices at one place become one"));
    command.add(row("--fill-holes", work->options.fill_holes,
                    "close holes whose rims have at most so many edges",
                    {.min = 3, .max = mesh::LongestRim, .type = "N", .shows_default = false}));
    session.add_common_options(command);
    command.on_run([work, &session] { work->run(session); });
}

struct RefineCommand {
    MeshFiles files;
    RefineOptionGroup options;

    void run(Session& session) const {
        files.check();
        options.check();
        Mesh mesh(files.creased(files.load(session)));
        mesh.source = files.input;
        files.save(options.refined(std::move(mesh), {}, session).geometry, session);
        session.report({});
    }
};

void add_refine(Command& group, Session& session) {
    Command command =
        group.add_command("refine", "more vertices where the light changes between two of them");
    auto work = std::make_shared<RefineCommand>();
    work->files.add_to(command);
    work->options.add_to_refine(command);
    session.add_common_options(command);
    command.on_run([work, &session] { work->run(session); });
}

struct SimplifyCommand {
    MeshFiles files;
    std::uint32_t num_vertices = 0;

    void run(Session& session) const {
        files.check();
        Mesh mesh(files.creased(files.load(session)));
        mesh.source = files.input;
        files.save(simplified_to(std::move(mesh), num_vertices, session).geometry, session);
        session.report({});
    }
};

void add_simplify(Command& group, Session& session) {
    Command command = group.add_command("simplify", "fewer vertices: those that shape the mesh");
    auto work = std::make_shared<SimplifyCommand>();
    work->files.add_to(command);
    command.add(row("--vertices", work->num_vertices, "how many stay",
                    {.required = true, .min = 4, .max = 4294967294.0, .type = "N"}));
    session.add_common_options(command);
    command.on_run([work, &session] { work->run(session); });
}

} // namespace

Mesh simplified_to(Mesh mesh, std::uint32_t num_vertices, const Session& session) {
    const auto count = [](const Mesh& of) {
        return of.geometry.num_vertices() - std::size_t{of.floor_vertices} * of.floor_vertices;
    };
    const std::size_t num_before = count(mesh);
    Mesh result = simplified(std::move(mesh), num_vertices);
    const std::size_t num_after = count(result);
    session.say(fmt::format("simplified: {} vertices became {}", num_before, num_after));
    if (num_after > num_vertices && num_after > 4)
        session.warn(fmt::format("{}: {} vertices remain, not {}: the others lie on rims or seams, "
                                 "or would bend the surface",
                                 result.source, num_after, num_vertices));
    session.add_to_report("simplified",
                          Report({{"vertices_before", num_before}, {"vertices", num_after}}));
    return result;
}

void add_mesh(Command& program, Session& session) {
    Command group = program.add_command("mesh", "meshes: `mesh repair`, `refine`, `simplify`");
    add_repair(group, session);
    add_refine(group, session);
    add_simplify(group, session);
}

} // namespace relumine::app
