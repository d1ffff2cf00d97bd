// What `relumine precompute` computes the transfer of: vertices, pixels of a view or texels of a
// lightmap.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/session.h"
#include "prt/scene/scene_file.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::app {

/// --receivers and --view.
class ReceiverOptions {
public:
    void add_to(Command& command);

    /// Refuses wrong usage before any work is done.
    void check() const;

    /// Gives the scene its receivers and layout; says and reports what they are. `mesh_name` is for
    /// messages. Throws std::runtime_error for a view that sees nothing and a mesh without uvs.
    void apply(prt::Scene& scene, const prt::RayScene& rays, const std::string& mesh_name,
               Session& session, Report& report) const;

private:
    enum class Kind { Vertices, Pixels, Texels };
    struct Wanted {
        Kind kind = Kind::Vertices;
        std::uint32_t width = 0, height = 0, samples_per_axis = 1;
    };
    [[nodiscard]] Wanted wanted() const;
    /// None: automatic
    [[nodiscard]] std::optional<prt::Camera> camera() const;
    void apply_eye(prt::Scene& scene) const;
    void apply_pixels(const Wanted& wanted, prt::Scene& scene, const prt::RayScene& rays,
                      const Session& session, Report& report) const;
    static void apply_texels(const Wanted& wanted, prt::Scene& scene, Session& session,
                             Report& report);

    std::string receivers_ = "vertices";
    /// Empty: none
    std::string view_;
};

/// The layout for people and for --json: size, camera, coverage. Empty for vertices.
[[nodiscard]] Report layout_json(const prt::Scene& scene);

/// Throws std::runtime_error "path: expected a scene whose receivers are vertices, got ..." for
/// other layouts.
void require_vertices(const prt::Scene& scene, const std::string& path);

/// Throws std::runtime_error "path: expected a scene without materials ..." for receivers with
/// surfaces.
void require_diffuse(const prt::Scene& scene, const std::string& path);

} // namespace relumine::app
